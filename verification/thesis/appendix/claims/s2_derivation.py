"""Appendix, section 2: the constrained equations (A.4) and the reduced ones (A.5) of chapter 5."""

from __future__ import annotations

from typing import Any

from verification.claims import Correction, Effect, Evidence, FormalProof, Verdict, claim, proved, put_right
from verification.formal.algebra import identity, matrices
from verification.thesis.chapter5.general import eliminated, multiplier, pair_force, particle


@claim(
    "c5.derivation-order",
    "The others act on particle i with the force 1/N Σ_k K(X_i, X_k).",
    source="appendix 2, (A.4a)",
    quote="mẌ_i = F₁(X_i) + 1/N Σ_k K(X_i, X_k) − (∂_X g(X_i, y))ᵀλ_i",
    correction=Correction(
        "mẌ_i = F₁(X_i) + 1/N Σ_k K(X_k, X_i) − (∂_X g(X_i, y))ᵀλ_i, as in (5.6a)",
        Effect.MODEL,
        (
            "(A.11) to (A.14), which have the same order; with it “which is equivalent to (A.5a)”, after (A.13), "
            "is false"
        ),
        why=("(5.6a), which (A.4a) recalls, has K(X_k, X_i), and K is antisymmetric, so the sign of the force changes"),
        place=4111,
    ),
)
def _order() -> Evidence:
    """Take one pair and one coordinate."""
    return put_right(pair_force("the force on X_i by X_k is K(X_k, X_i)/N", "it is K(X_i, X_k)/N"))


@claim(
    "c5.derivation-constraint",
    "The constraints hold if and only if the particles have the velocities Φ_i[ẏ].",
    source="appendix 2, (A.6), (A.7)",
    quote="(A.4c) ⇔ dg(X_i, y)/dt = 0 ⇔ Ẋ_i = −(∂_X g)⁻¹∂_y g[ẏ] ⇔ (A.5b)",
    recorded=Verdict.PROVED,
)
def _constraint() -> Evidence:
    """Prove (A.7) in both directions: U - Phi[v] is G^-1 times the rate of g."""
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
    "The acceleration of a particle follows from ÿ: Ẍ_i = Φ_i[ÿ] + Ω_i[ẏ, ẏ] for each i.",
    source="appendix 2, (A.8) to (A.10)",
    quote="Ẍ_i = Φ_i[ÿ] + Ω_i[ẏ, ẏ]",
    recorded=Verdict.PROVED,
    rests_on=("c5.derivation-constraint",),
)
def _rate() -> Evidence:
    """Derive d^2 g/dt^2 for U = Phi[v], Omega being the rate of Phi[v] with v held."""
    p = particle()
    return proved(
        identity(
            "d²g/dt² = ∂_X g Ẍ_i + ∂_y g ÿ + (d/dt ∂_X g) Φ[ẏ] + (d/dt ∂_y g) ẏ = 0 for Ẍ_i = Φ[ÿ] + Ω[ẏ, ẏ], any "
            "nx, ny",
            lambda s: p.G * (p.phi * p.a + s * p.curved) + p.B * p.a + (p.dG * p.phi + p.dB) * p.v,
            "−Ω for Ω",
        )
    )


def others(statement: str, printed: str, inserted: bool) -> FormalProof:
    """Prove (A.12), or (A.13), which follows from it: K is the sum of K(X_k, X_i), the printed order its negative."""
    p, (own, pull) = particle(), matrices("F1 K")

    def residual(s: Any) -> Any:
        level = p.GT**-1 * (own + s * pull - p.m * (p.phi * p.a + p.curved))
        if inserted:
            return p.BT * level + p.phiT * (own + pull - p.m * (p.phi * p.a + p.curved))
        return p.m * (p.phi * p.a + p.curved) - own - pull + p.GT * level

    return identity(statement, residual, printed)


@claim(
    "c5.derivation-multipliers",
    "(A.12) gives the multipliers as functions of positions, velocities and ÿ.",
    source="appendix 2, (A.11), (A.12)",
    quote="λ_i = (∂_X g)⁻ᵀ(F₁(X_i) + 1/N Σ_k K(X_i, X_k) − mΦ_i[ÿ] − mΩ_i[ẏ, ẏ])",
    correction=Correction(
        "λ_i = (∂_X g)⁻ᵀ(F₁(X_i) + 1/N Σ_k K(X_k, X_i) − mΦ_i[ÿ] − mΩ_i[ẏ, ẏ])",
        Effect.MODEL,
        "(A.14), and with it the multipliers of Proposition 5.1",
        why="it is (A.4a) solved for λ_i, with the order of K that c5.derivation-order corrects to that of (5.6a)",
        place=4162,
    ),
    rests_on=("c5.derivation-order", "c5.derivation-rate"),
)
def _multipliers() -> Evidence:
    return put_right(others("λ_i of (A.12) with K(X_k, X_i) solves (5.6a), any nx, ny, N", "with K(X_i, X_k)", False))


@claim(
    "c5.derivation-insert",
    "Inserting the multipliers gives the equation (A.13) for ÿ.",
    source="appendix 2, (A.13)",
    quote="ÿ = F₀ + 1/N Σ_j Φ_jᵀ(F₁(X_j) + 1/N Σ_k K(X_j, X_k) − m(Φ_j[ÿ] + Ω_j[ẏ, ẏ]))",
    correction=Correction(
        "ÿ = F₀ + 1/N Σ_j Φ_jᵀ(F₁(X_j) + 1/N Σ_k K(X_k, X_j) − m(Φ_j[ÿ] + Ω_j[ẏ, ẏ]))",
        Effect.MODEL,
        "“which is equivalent to (A.5a)”, after it, which is true with this order only",
        why="(5.14), to which it leads, has K(X_k, X_j); the printed order is that of (A.4a)",
        place=4166,
    ),
    rests_on=("c5.derivation-multipliers",),
)
def _insert() -> Evidence:
    return put_right(others("inserted into (5.6b) it gives (A.13) with K(X_k, X_j)", "with K(X_j, X_k)", True))


@claim(
    "c5.derivation-back",
    ("The multipliers (A.14) turn a solution of the reduced equations into one of the constrained equations."),
    source="appendix 2, (A.14)",
    quote="λ_i := (∂_X g)⁻ᵀ(F₁(X_i) + 1/N Σ_k K(X_i, X_k) − mΦ_i[ÿ] − mΩ_i[ẏ, ÿ])",
    correction=Correction(
        "λ_i := (∂_X g)⁻ᵀ(F₁(X_i) + 1/N Σ_k K(X_k, X_i) − mΦ_i[ÿ] − mΩ_i[ẏ, ẏ]), as in (A.12)",
        Effect.MODEL,
        "Proposition 5.1, which defines λ_i by (A.14); it holds with (A.12)",
        why="(A.12), which it is said to be, has Ω_i[ẏ, ẏ], from (A.10); the order of K is that of (5.6a)",
        place=4181,
    ),
    rests_on=("c5.derivation-multipliers",),
)
def _back() -> Evidence:
    """Treat Omega[y', y''], as printed, as another word than Omega[y', y']."""
    p, (other,) = particle(), matrices("W,")
    return put_right(
        others("λ_i with K(X_k, X_i) solves (5.6a)", "with K(X_i, X_k)", False),
        identity(
            "and with Ω_i[ẏ, ẏ]",
            lambda s: (
                p.m * (p.phi * p.a + p.curved)
                - p.f
                + p.GT * p.GT**-1 * (p.f - p.m * (p.phi * p.a + (p.curved if s == 1 else other)))
            ),
            "with Ω_i[ẏ, ÿ]",
        ),
    )


@claim(
    "c5.equivalence",
    "Reduced and constrained equations have the same solutions.",
    source="before Proposition 5.1",
    quote=(
        "with solutions of the ODE model we can recover the Lagrangian multipliers to construct a solution of the DAE"
    ),
    recorded=Verdict.PROVED,
    rests_on=("c5.derivation-constraint", "c5.derivation-multipliers"),
    chosen="λ_i of (A.12) with K(X_k, X_i); those of (A.14), which Proposition 5.1 names, see c5.derivation-back",
)
def _equivalent() -> Evidence:
    """Insert the multipliers of (A.12) into (5.6a) and (5.6b)."""
    p = particle()
    return proved(
        identity(
            "with λ_i of (A.12) m Ẍ_i = f_i − (∂_X g)ᵀλ_i for Ẍ_i = Φ_i[ÿ] + Ω_i[ẏ, ẏ]",
            lambda s: p.m * (p.phi * p.a + s * p.curved) - p.f + p.GT * multiplier(p),
            "−Ω in Ẍ_i",
        ),
        identity("for these λ_i (5.6b) is (5.11a), any nx, ny, N", eliminated, "−Ω in F_eff"),
    )
