"""What a certificate proves, in words. Bounds are rounded up, so that what is printed was proved, too."""

from __future__ import annotations

import math
from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from verification.proofs.certificate import Certificate, Dyadic
    from verification.proofs.checker import Proven


def value(number: Dyadic) -> float:
    """Return the double nearest to m 2^e; infinite beyond all doubles."""
    mantissa, exponent = number
    try:
        return float(mantissa * 2**exponent) if exponent >= 0 else mantissa / 2**-exponent
    except OverflowError:
        return math.inf if mantissa > 0 else -math.inf


def above(bound: float, digits: int = 3) -> str:
    """Write a number >= 0 with so many digits, rounded up."""
    return _rounded(bound, digits, ROUND_CEILING)


def _rounded(number: float, digits: int, way: str) -> str:
    decimal = Context(prec=digits, rounding=way).create_decimal(Decimal(number)).normalize()
    return f"{decimal:f}" if decimal == 0 or 1e-4 <= decimal < 1e6 else f"{decimal:e}"


def assumptions(certificate: Certificate) -> list[str]:
    """List what the theorem presupposes, a sentence each."""
    drift, paths = certificate.drift, sorted({row.path for row in certificate.rows if row.path})
    said = ["A solution exists on the whole time; the bound holds for each solution."]
    does = "which does to balls what it does to numbers, and rounds what it computes from numbers alone"
    if drift.function:
        said.append(f"The drift is the function {drift.function}, {does}.")
    else:
        said.append("The drift is affine with the numbers of the certificate.")
    said += [f"Sets move along the function {path}, {does}." for path in paths]
    if certificate.start_error[0]:
        off = above(value(certificate.start_error), 2)
        said.append(f"The start is feasible up to rounding: the solution starts at most {off} from it.")
    return said


def theorem(certificate: Certificate, verdict: Proven) -> str:
    """Say what was proved, and what was assumed."""
    d, count = certificate.dimension, len(certificate.start) // certificate.dimension
    end = _rounded(_down(verdict.end), 6, ROUND_FLOOR)
    lines = [
        f"Proved: each solution of x' in F - N(S, x), {count} particles in {d} dimensions, "
        f"{len(certificate.rows)} rows, is within {above(value(certificate.bound))} of the {len(certificate.pieces)} "
        f"polynomials for all t in [0, {end}].",
        f"The bound that follows is {above(_up(verdict.bound), 6)}.",
    ]
    lines += [
        f"At t = {value(ball.t)!r} within {above(value(ball.radius))} of the stated state."
        for ball in certificate.balls
    ]
    return "\n".join([*lines, "Assumed:", *(f"- {one}" for one in assumptions(certificate))])


def _up(ball: Any) -> float:
    """Return a double above a ball."""
    return math.nextafter(float(ball.upper()), math.inf)


def _down(ball: Any) -> float:
    """Return a double at the lower end of a ball or below; the ball itself where it is a double."""
    lower = float(ball.lower())
    return lower if ball.is_exact() and ball == lower else math.nextafter(lower, -math.inf)
