"""Appendix, section 2: the constrained equations (A.4) and the reduced ones (A.5) of chapter 5."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import numpy as np

from verification.claim import Claim, Tables, Verdict, corrected_if, holds_if
from verification.claims.instant import (
    Floats,
    Instant,
    effective_force,
    effective_mass,
    force0,
    force1,
    general_instant,
    jacobians,
    omega,
    phi,
    potential,
    pulls,
    pushed,
    slope,
)

# What central differences of numbers that are right to rounding leave.
TOL = 1e-8


def multipliers(at: Instant, a: Floats, curved: Floats) -> Floats:
    """(A.12) with K(X_k, X_i), for an acceleration of y and a value of Omega."""
    gX, _ = jacobians(at.system, at.X, at.y)
    inertia = at.system.m * (phi(at.system, at.X, at.y) @ a + curved)
    right = force1(at.system, at.X) + pulls(at.system, at.X).mean(axis=0) - inertia
    return np.asarray(np.linalg.solve(gX.transpose(0, 2, 1), right[..., None])[..., 0])


def _order(_: Tables) -> Verdict:
    """The rate of the total energy if the force on X_i is the mean of K(X_i, X_k) over k, or of K(X_k, X_i)."""
    at = general_instant()
    moved, curved = phi(at.system, at.X, at.y), omega(at.system, at.X, at.y, at.v, at.v)
    drift = slope(lambda s: potential(at.system, at.X + s * at.U, at.y + s * at.v), np.zeros(()), np.ones(()))

    def rate(pull: Floats) -> float:
        force = force0(at.system, at.y) + pushed(moved, force1(at.system, at.X) + pull - at.system.m * curved).mean(0)
        a = np.linalg.solve(effective_mass(at.system, at.X, at.y), force)
        A = moved @ a + curved
        return float(abs(at.v @ a + at.system.m * (at.U * A).sum(axis=1).mean() + drift))

    found = pulls(at.system, at.X)
    printed, right = rate(found.mean(axis=1)), rate(found.mean(axis=0))
    return corrected_if(
        printed < TOL,
        right < TOL,
        f"K is antisymmetric, so this is the opposite of (5.6a): the energy (5.37) then changes at a rate of "
        f"{printed:.2f}, with K(X_k, X_i) at {right:.0e}. The same holds for (A.11) to (A.14)",
    )


def _rate(_: Tables) -> Verdict:
    at = general_instant()
    right = phi(at.system, at.X, at.y) @ at.a + omega(at.system, at.X, at.y, at.v, at.v)
    off = np.abs(at.A - right).max()
    return holds_if(off < TOL, f"d²g/dt² = 0, differentiated without Φ, gives the same Ẍ_i to {off:.0e}")


def _multipliers(_: Tables) -> Verdict:
    at = general_instant()
    off = np.abs(multipliers(at, at.a, omega(at.system, at.X, at.y, at.v, at.v)) - at.multipliers).max()
    return holds_if(
        off < TOL, f"with K(X_k, X_i) it differs from the multipliers of the equations of motion by {off:.0e}"
    )


def _insert(_: Tables) -> Verdict:
    at = general_instant()
    inertia = at.system.m * (phi(at.system, at.X, at.y) @ at.a + omega(at.system, at.X, at.y, at.v, at.v))
    each = force1(at.system, at.X) + pulls(at.system, at.X).mean(axis=0) - inertia
    right = force0(at.system, at.y) + pushed(phi(at.system, at.X, at.y), each).mean(axis=0)
    off = np.abs(right - at.a).max()
    return holds_if(off < TOL, f"with K(X_k, X_j) the right side is ÿ to {off:.0e}; −(∂_y g)ᵀ(∂_X g)⁻ᵀ = Φᵀ")


def _back(_: Tables) -> Verdict:
    at = general_instant()
    printed, right = (
        float(np.abs(multipliers(at, at.a, omega(at.system, at.X, at.y, at.v, w)) - at.multipliers).max())
        for w in (at.a, at.v)
    )
    return corrected_if(
        printed < TOL,
        right < TOL,
        f"λ_i is off by up to {printed:.2f}; with Ω_i[ẏ, ẏ], as “exactly (A.12)” asks for, by {right:.0e}",
    )


def _equivalent(_: Tables) -> Verdict:
    """A solution of (A.5) and the multipliers of (A.12), inserted into (A.4a), (A.4b)."""
    at = general_instant()
    a = np.linalg.solve(effective_mass(at.system, at.X, at.y), effective_force(at.system, at.X, at.y, at.v))
    curved = omega(at.system, at.X, at.y, at.v, at.v)
    lam = multipliers(at, a, curved)
    gX, gy = jacobians(at.system, at.X, at.y)
    A = phi(at.system, at.X, at.y) @ a + curved
    first = force1(at.system, at.X) + pulls(at.system, at.X).mean(axis=0) - pushed(gX, lam) - at.system.m * A
    second = force0(at.system, at.y) - pushed(gy, lam).mean(axis=0) - a
    off, apart = max(np.abs(first).max(), np.abs(second).max()), np.abs(a - at.a).max()
    return holds_if(
        max(off, apart) < TOL,
        f"ÿ of (A.5a) with these λ_i fulfils (A.4a), (A.4b) to {off:.0e}, and is that of the constrained system to "
        f"{apart:.0e}",
    )


CLAIMS = (
    Claim("c5.derivation-order", "(A.4a)", "mẌ_i = F₁(X_i) + 1/N Σ_k K(X_i, X_k) − (∂_X g(X_i, y))ᵀλ_i", _order),
    Claim("c5.derivation-rate", "(A.8) to (A.10)", "Ẍ_i = Φ_i[ÿ] + Ω_i[ẏ, ẏ]", _rate),
    Claim(
        "c5.derivation-multipliers",
        "(A.12)",
        "λ_i = (∂_X g)⁻ᵀ(F₁(X_i) + … − mΦ_i[ÿ] − mΩ_i[ẏ, ẏ])",
        _multipliers,
    ),
    Claim("c5.derivation-insert", "(A.13)", "ÿ = F₀ + 1/N Σ_j Φ_jᵀ(F₁(X_j) + … − m(Φ_j[ÿ] + Ω_j[ẏ, ẏ]))", _insert),
    Claim("c5.derivation-back", "(A.14)", "λ_i := (∂_X g)⁻ᵀ(F₁(X_i) + … − mΦ_i[ÿ] − mΩ_i[ẏ, ÿ])", _back),
    Claim(
        "c5.equivalence",
        "Proposition 5.1",
        "with solutions of the ODE model we can recover the Lagrangian multipliers to construct a solution of the DAE",
        _equivalent,
    ),
)
