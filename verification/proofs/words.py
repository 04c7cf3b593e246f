"""What a certificate proves, in words."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from verification.proofs.certificate import Certificate, Dyadic
    from verification.proofs.checker import Proven


def value(number: Dyadic) -> float:
    """Return the double nearest to m 2^e."""
    mantissa, exponent = number
    return float(mantissa * 2**exponent) if exponent >= 0 else mantissa / 2**-exponent


def assumptions(certificate: Certificate) -> list[str]:
    """List what the theorem presupposes, a sentence each."""
    drift, paths = certificate.drift, sorted({row.path for row in certificate.rows if row.path})
    said = ["A solution exists on the whole time; the bound holds for each solution."]
    if "function" in drift:
        said.append(f"The drift is the function {drift['function']}, which does to balls what it does to numbers.")
    else:
        said.append("The drift is affine with the numbers of the certificate.")
    said += [f"Sets move along the function {path}, which does to balls what it does to numbers." for path in paths]
    if certificate.start_error[0]:
        off = value(certificate.start_error)
        said.append(f"The start is feasible up to rounding: the solution starts at most {off:.2g} from it.")
    return said


def theorem(certificate: Certificate, verdict: Proven) -> str:
    """Say what was proved, and what was assumed."""
    d, count = certificate.dimension, len(certificate.start) // certificate.dimension
    lines = [
        f"Proved: each solution of x' in F - N(S, x), {count} particles in {d} dimensions, "
        f"{len(certificate.rows)} rows, is within {value(certificate.bound):.3g} of the {len(certificate.pieces)} "
        f"polynomials for all t in [0, {float(verdict.end):.6g}].",
        f"The bound that follows is {float(verdict.bound):.6g}.",
    ]
    lines += [
        f"At t = {value(ball.t):.6g} within {value(ball.radius):.3g} of the stated state." for ball in certificate.balls
    ]
    return "\n".join([*lines, "Assumed:", *(f"- {one}" for one in assumptions(certificate))])
