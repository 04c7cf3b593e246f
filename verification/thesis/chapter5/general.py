"""One particle of a general system by symbols, for any nx and ny: matrices and vectors as words that do not commute.

All equations of chapter 5, section 2, are means over particles of terms of one particle: an identity for one particle
holds for any number of them.
"""

from __future__ import annotations

from typing import Any

from verification.claims.formal.algebra import library, matrices

# A name with T is a transpose. G and B are the derivatives of g in X and y, dG and dB their rates along the motion.
# a and
# v belong to y, f is the force on the particle without the constraint.
G, GT, B, BT, dG, dB, f, a, v, vT = matrices("G GT B BT dG dB f a v vT")
m = library().Symbol("m", positive=True)
phi, phiT = -(G**-1) * B, -BT * GT**-1
# Omega[v, v], the rate of Phi[v] with v held.
curved = (G**-1 * dG * G**-1 * B - G**-1 * dB) * v
acceleration = phi * a + curved
# lambda of (5.6a), G^T lambda = f - m (Phi a + Omega): (A.12).
multiplier = GT**-1 * (f - m * acceleration)


def eliminated(inertia: Any = curved) -> Any:
    """Return what (5.6b) and (5.11a) differ by for one particle: B^T lambda + Phi^T (f - m Omega) - m Phi^T Phi a.

    Its mean over the particles is (F0 - a) - (m_eff a - F_eff) read with (5.6b): both have the same solutions if it
    vanishes. ``inertia`` stands for Omega in (5.14).
    """
    return BT * multiplier + phiT * (f - m * inertia) - m * phiT * phi * a


def even(name: str) -> Any:
    """Return an even function of any number of coordinates, as (A2a) has it: w(r) + w(-r) for any w."""
    w = library().Function(name)
    return lambda *r: w(*r) + w(*(-each for each in r))
