"""Appendix, section 2: the constrained equations (A.4) and the reduced ones (A.5) of chapter 5."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import numpy as np

from verification.claims import Correction, Effect, claim
from verification.evidence import Evidence, Kind, at_most, proved
from verification.formal.algebra import identity, matrices
from verification.thesis.chapter5.general import eliminated, multiplier, particle
from verification.thesis.chapter5.instant import (
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
# The axis of ``pulls`` over which the mean is taken for the force on a particle: K(X_i, X_k), or K(X_k, X_i).
PRINTED_ORDER, RIGHT_ORDER = 1, 0


def multipliers(at: Instant, a: Floats, curved: Floats, order: int = RIGHT_ORDER) -> Floats:
    """(A.12) for an acceleration of y, a value of Omega and an order of the arguments of K."""
    gX, _ = jacobians(at.system, at.X, at.y)
    inertia = at.system.m * (phi(at.system, at.X, at.y) @ a + curved)
    right = force1(at.system, at.X) + pulls(at.system, at.X).mean(axis=order) - inertia
    return np.asarray(np.linalg.solve(gX.transpose(0, 2, 1), right[..., None])[..., 0])


@claim(
    "c5.derivation-order",
    "The force on a particle by the others.",
    source="appendix 2, (A.4a)",
    quote="mẌ_i = F₁(X_i) + 1/N Σ_k K(X_i, X_k) − (∂_X g(X_i, y))ᵀλ_i",
    recorded=Kind.CORRECTED,
    correction=Correction(
        "mẌ_i = F₁(X_i) + 1/N Σ_k K(X_k, X_i) − (∂_X g(X_i, y))ᵀλ_i, as in (5.6a)",
        Effect.MODEL,
        "(A.11) to (A.14), which have the same order; with it “which is equivalent to (A.5a)”, after (A.13), is false",
        why=("(5.6a), which (A.4a) recalls, has K(X_k, X_i), and K is antisymmetric, so the sign of the force changes"),
        place=4111,
    ),
    tried_on="one state of four particles, nx = 2, ny = 3",
)
def _order() -> Evidence:
    """Energy and ÿ if the force on X_i is the mean of K(X_i, X_k) over k, or of K(X_k, X_i)."""
    at = general_instant()
    moved, curved = phi(at.system, at.X, at.y), omega(at.system, at.X, at.y, at.v, at.v)
    stated = effective_force(at.system, at.X, at.y, at.v)
    drift = slope(lambda s: potential(at.system, at.X + s * at.U, at.y + s * at.v), np.zeros(()), np.ones(()))

    def off(pull: Floats) -> tuple[float, float]:
        force = force0(at.system, at.y) + pushed(moved, force1(at.system, at.X) + pull - at.system.m * curved).mean(0)
        a = np.linalg.solve(effective_mass(at.system, at.X, at.y), force)
        gained = at.v @ a + at.system.m * (at.U * (moved @ a + curved)).sum(axis=1).mean()
        return float(abs(gained + drift)), float(np.abs(force - stated).max())

    printed, right = (off(pulls(at.system, at.X).mean(axis=k)) for k in (PRINTED_ORDER, RIGHT_ORDER))
    return Evidence(
        f"K is antisymmetric, so this is the opposite of (5.6a): the energy (5.37) then changes at a rate of "
        f"{printed[0]:.2f}, with K(X_k, X_i) at {right[0]:.0e}; what (A.13) leads to is off F_eff of (5.14) by "
        f"{printed[1]:.2f}, or {right[1]:.0e}.",
        printed=(
            at_most("rate of the energy with K(X_i, X_k)", printed[0], 0.0, TOL),
            at_most("right side after (A.13) against F_eff, K(X_j, X_k)", printed[1], 0.0, TOL),
        ),
        corrected=(
            at_most("rate of the energy with K(X_k, X_i)", right[0], 0.0, TOL),
            at_most("right side after (A.13) against F_eff, K(X_k, X_j)", right[1], 0.0, TOL),
        ),
    )


@claim(
    "c5.derivation-constraint",
    "The constraints hold if and only if the particles have the velocities Φ_i[ẏ].",
    source="appendix 2, (A.6), (A.7)",
    quote="(A.4c) ⇔ dg(X_i, y)/dt = 0 ⇔ Ẋ_i = −(∂_X g)⁻¹∂_y g[ẏ] ⇔ (A.5b)",
    recorded=Kind.PROVED,
)
def _constraint() -> Evidence:
    """(A.7) in both directions: what is left of U - Phi[v] is G^-1 times the rate of g."""
    p, (U,) = particle(), matrices("U,")
    return proved(
        identity(
            "U − Φ[ẏ] = (∂_X g)⁻¹ (∂_X g U + ∂_y g ẏ) for every U, so dg/dt = 0 if and only if U = Φ[ẏ], for any "
            "nx, ny",
            lambda s: U - s * p.phi * p.v - p.G**-1 * (p.G * U + p.B * p.v),
            "−Φ for Φ",
        )
    )


@claim(
    "c5.derivation-rate",
    "The acceleration of a particle by that of the macroscopic component.",
    source="appendix 2, (A.8) to (A.10)",
    quote="Ẍ_i = Φ_i[ÿ] + Ω_i[ẏ, ẏ]",
    recorded=Kind.PROVED,
)
def _rate() -> Evidence:
    """d^2 g/dt^2 for U = Phi[v], Omega being the rate of Phi[v] with v held."""
    p = particle()
    return proved(
        identity(
            "d²g/dt² = ∂_X g Ẍ_i + ∂_y g ÿ + (d/dt ∂_X g) Φ[ẏ] + (d/dt ∂_y g) ẏ = 0 for Ẍ_i = Φ[ÿ] + Ω[ẏ, ẏ], any "
            "nx, ny",
            lambda s: p.G * (p.phi * p.a + s * p.curved) + p.B * p.a + (p.dG * p.phi + p.dB) * p.v,
            "−Ω for Ω",
        )
    )


@claim(
    "c5.derivation-multipliers",
    "The multipliers as functions of positions, velocities and ÿ.",
    source="appendix 2, (A.11), (A.12)",
    quote="λ_i = (∂_X g)⁻ᵀ(F₁(X_i) + 1/N Σ_k K(X_i, X_k) − mΦ_i[ÿ] − mΩ_i[ẏ, ẏ])",
    recorded=Kind.CORRECTED,
    correction=Correction(
        "λ_i = (∂_X g)⁻ᵀ(F₁(X_i) + 1/N Σ_k K(X_k, X_i) − mΦ_i[ÿ] − mΩ_i[ẏ, ẏ])",
        Effect.MODEL,
        "(A.14), and with it the multipliers of Proposition 5.1",
        why="it is (A.4a) solved for λ_i, with the order of K that c5.derivation-order corrects to that of (5.6a)",
        place=4162,
    ),
    tried_on="one state of four particles, nx = 2, ny = 3",
)
def _multipliers() -> Evidence:
    at = general_instant()
    curved = omega(at.system, at.X, at.y, at.v, at.v)
    printed, right = (
        float(np.abs(multipliers(at, at.a, curved, order) - at.multipliers).max())
        for order in (PRINTED_ORDER, RIGHT_ORDER)
    )
    return Evidence(
        f"It is off the multipliers of the motion by up to {printed:.2f}, with K(X_k, X_i) by {right:.0e}.",
        printed=(at_most("(A.12) with K(X_i, X_k) against the multipliers of the motion", printed, 0.0, TOL),),
        corrected=(at_most("(A.12) with K(X_k, X_i) against the multipliers of the motion", right, 0.0, TOL),),
    )


@claim(
    "c5.derivation-insert",
    "The equation for ÿ once the multipliers are inserted.",
    source="appendix 2, (A.13)",
    quote="ÿ = F₀ + 1/N Σ_j Φ_jᵀ(F₁(X_j) + 1/N Σ_k K(X_j, X_k) − m(Φ_j[ÿ] + Ω_j[ẏ, ẏ]))",
    recorded=Kind.CORRECTED,
    correction=Correction(
        "ÿ = F₀ + 1/N Σ_j Φ_jᵀ(F₁(X_j) + 1/N Σ_k K(X_k, X_j) − m(Φ_j[ÿ] + Ω_j[ẏ, ẏ]))",
        Effect.MODEL,
        "“which is equivalent to (A.5a)”, after it, which is true with this order only",
        why="(5.14), to which it leads, has K(X_k, X_j); the printed order is that of (A.4a)",
        place=4166,
    ),
    tried_on="one state of four particles, nx = 2, ny = 3",
)
def _insert() -> Evidence:
    at = general_instant()
    moved = phi(at.system, at.X, at.y)
    inertia = at.system.m * (moved @ at.a + omega(at.system, at.X, at.y, at.v, at.v))

    def off(order: int) -> float:
        each = force1(at.system, at.X) + pulls(at.system, at.X).mean(axis=order) - inertia
        return float(np.abs(force0(at.system, at.y) + pushed(moved, each).mean(axis=0) - at.a).max())

    printed, right = off(PRINTED_ORDER), off(RIGHT_ORDER)
    return Evidence(
        f"The right side is off ÿ of the constrained system by {printed:.2f}, with K(X_k, X_j) by {right:.0e}; "
        "−(∂_y g)ᵀ(∂_X g)⁻ᵀ = Φᵀ.",
        printed=(at_most("right side of (A.13) with K(X_j, X_k) against ÿ", printed, 0.0, TOL),),
        corrected=(at_most("right side of (A.13) with K(X_k, X_j) against ÿ", right, 0.0, TOL),),
    )


@claim(
    "c5.derivation-back",
    "The multipliers that turn a solution of the reduced equations into one of the constrained ones.",
    source="appendix 2, (A.14)",
    quote="λ_i := (∂_X g)⁻ᵀ(F₁(X_i) + 1/N Σ_k K(X_i, X_k) − mΦ_i[ÿ] − mΩ_i[ẏ, ÿ])",
    recorded=Kind.CORRECTED,
    correction=Correction(
        "λ_i := (∂_X g)⁻ᵀ(F₁(X_i) + 1/N Σ_k K(X_k, X_i) − mΦ_i[ÿ] − mΩ_i[ẏ, ẏ]), as in (A.12)",
        Effect.MODEL,
        "Proposition 5.1, which defines λ_i by (A.14); it holds with (A.12)",
        why=("(A.12), which it is said to be, has Ω_i[ẏ, ẏ], from (A.10); the order of K is that of (5.6a)"),
        place=4181,
    ),
    tried_on="one state of four particles, nx = 2, ny = 3",
)
def _back() -> Evidence:
    at = general_instant()
    printed, ordered, right = (
        float(np.abs(multipliers(at, at.a, omega(at.system, at.X, at.y, at.v, w), order) - at.multipliers).max())
        for w, order in ((at.a, PRINTED_ORDER), (at.a, RIGHT_ORDER), (at.v, RIGHT_ORDER))
    )
    return Evidence(
        f"λ_i is off by up to {printed:.2f} as printed, {ordered:.2f} with K(X_k, X_i); with Ω_i[ẏ, ẏ] too, as "
        f"“exactly (A.12)” asks for, by {right:.0e}.",
        printed=(at_most("(A.14) as printed against the multipliers", printed, 0.0, TOL),),
        corrected=(at_most("(A.14) with K(X_k, X_i) and Ω_i[ẏ, ẏ] against the multipliers", right, 0.0, TOL),),
    )


@claim(
    "c5.equivalence",
    "Reduced and constrained equations have the same solutions.",
    source="before Proposition 5.1",
    quote=(
        "with solutions of the ODE model we can recover the Lagrangian multipliers to construct a solution of the DAE"
    ),
    chosen="λ_i of (A.12) with K(X_k, X_i); those of (A.14), which Proposition 5.1 names, see c5.derivation-back",
    recorded=Kind.PROVED,
)
def _equivalent() -> Evidence:
    """With the multipliers of (A.12) equation (5.6a) holds, and (5.6b) is (5.11a)."""
    p = particle()
    return proved(
        identity(
            "with λ_i of (A.12) m Ẍ_i = f_i − (∂_X g)ᵀλ_i for Ẍ_i = Φ_i[ÿ] + Ω_i[ẏ, ẏ]",
            lambda s: p.m * (p.phi * p.a + s * p.curved) - p.f + p.GT * multiplier(p),
            "−Ω in Ẍ_i",
        ),
        identity("for these λ_i (5.6b) is (5.11a), any nx, ny, N", eliminated, "−Ω in F_eff"),
    )
