"""Appendix, section 2: the constrained equations (A.4) and the reduced ones (A.5) of chapter 5."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

from typing import Any

from verification.claims import Evidence, FormalProof, Verdict, proved, put_right
from verification.formal.algebra import identity, matrices
from verification.thesis.chapter5.general import eliminated, multiplier, pair_force, particle
from verification.thesis.text.quoted import claim


@claim(
    "c5.derivation-order",
    "The others act on particle i with the force 1/N Σ_k K(X_i, X_k).",
    "appendix 2, (A.4a)",
    Verdict.CORRECTED,
    rests_on=("c5.pair-force",),
)
def _order() -> Evidence:
    """Take one pair and one coordinate, as for c5.pair-force."""
    return put_right(pair_force("the force on X_i by X_k is K(X_k, X_i)/N", "it is K(X_i, X_k)/N"))


@claim(
    "c5.derivation-constraint",
    "The constraints hold if and only if the particles have the velocities Φ_i[ẏ].",
    "appendix 2, (A.6), (A.7)",
    Verdict.PROVED,
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
    "appendix 2, (A.8) to (A.10)",
    Verdict.PROVED,
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
    "appendix 2, (A.11), (A.12)",
    Verdict.CORRECTED,
    rests_on=("c5.derivation-order", "c5.derivation-rate"),
)
def _multipliers() -> Evidence:
    return put_right(others("λ_i of (A.12) with K(X_k, X_i) solves (5.6a), any nx, ny, N", "with K(X_i, X_k)", False))


@claim(
    "c5.derivation-insert",
    "Inserting the multipliers gives the equation (A.13) for ÿ.",
    "appendix 2, (A.13)",
    Verdict.CORRECTED,
    rests_on=("c5.derivation-multipliers",),
)
def _insert() -> Evidence:
    return put_right(others("inserted into (5.6b) it gives (A.13) with K(X_k, X_j)", "with K(X_j, X_k)", True))


@claim(
    "c5.derivation-back",
    "The multipliers (A.14) turn a solution of the reduced equations into one of the constrained equations.",
    "appendix 2, (A.14)",
    Verdict.CORRECTED,
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
    "before Proposition 5.1",
    Verdict.PROVED,
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
