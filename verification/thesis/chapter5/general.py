"""One particle of a general system by symbols, for any nx and ny: matrices and vectors as words that do not commute.

All equations of chapter 5, section 2, are means over particles of terms of one particle: an identity for one particle
holds for any number of them.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from verification.claims import FormalProof
from verification.formal.algebra import identity, library, matrices


class Particle(NamedTuple):
    """The symbols of one particle; a name with T is a transpose.

    G and B are the derivatives of g in X and y, dG and dB their rates along the motion; Phi = -G^{-1} B, and ``curved``
    is Omega[v, v], the rate of Phi[v] with v held. a and v belong to y, f is the force without the constraint.
    """

    m: Any
    G: Any
    GT: Any
    B: Any
    BT: Any
    dG: Any
    dB: Any
    phi: Any
    phiT: Any
    curved: Any
    f: Any
    a: Any
    v: Any
    vT: Any


def particle() -> Particle:
    """Return the symbols."""
    G, GT, B, BT, dG, dB, f, a, v, vT = matrices("G GT B BT dG dB f a v vT")
    phi, phiT = -(G**-1) * B, -BT * GT**-1
    curved = (G**-1 * dG * G**-1 * B - G**-1 * dB) * v
    return Particle(library().Symbol("m", positive=True), G, GT, B, BT, dG, dB, phi, phiT, curved, f, a, v, vT)


def multiplier(p: Particle) -> Any:
    """Return lambda of (5.6a), G^T lambda = f - m (Phi a + Omega): (A.12)."""
    return p.GT**-1 * (p.f - p.m * (p.phi * p.a + p.curved))


def eliminated(omega: Any) -> Any:
    """Return what (5.6b) and (5.11a) differ by for one particle: B^T lambda + Phi^T (f - m Omega) - m Phi^T Phi a.

    Its mean over the particles is (F0 - a) - (m_eff a - F_eff) read with (5.6b): both have the same solutions if it
    vanishes. ``omega`` multiplies Omega in (5.14).
    """
    p = particle()
    return p.BT * multiplier(p) + p.phiT * (p.f - omega * p.m * p.curved) - p.m * p.phiT * p.phi * p.a


def even(name: str) -> Any:
    """Return an even function of any number of coordinates, as (A2a) has it: w(r) + w(-r) for any w."""
    w = library().Function(name)
    return lambda *r: w(*r) + w(*(-each for each in r))


def pair_force(statement: str, wrong: str) -> FormalProof:
    """Prove the force of a pair for one coordinate, the others being p; K(X_k, X_i) of (5.4) is written out."""
    sp = library()
    x, z, p, n = sp.symbols("x z p N")
    V = even("w")
    both = (V(z - x, p) + V(x - z, -p)) / (2 * n**2)
    return identity(statement, lambda s: -n * both.diff(x) + s * V(z - x, p).diff(x) / n, wrong)
