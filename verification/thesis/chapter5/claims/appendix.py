"""Appendix, section 2: the constrained equations (A.4) and the reduced ones (A.5) of chapter 5."""

from __future__ import annotations

from verification.claims import Correction, Effect
from verification.claims.formal.algebra import matrices, vanishes
from verification.claims.formal.stated import argument
from verification.thesis.chapter5.lemmas import (
    BT,
    GT,
    REDUCED,
    B,
    G,
    a,
    acceleration,
    curved,
    f,
    m,
    multiplier,
    phi,
    phiT,
    v,
)

# A velocity, the force of a particle alone and that of the others, the sum of K(X_k, X_i), and Omega[y', y''].
U, own, pull, other = matrices("U F1 K W")


_constraint = argument(
    "c5.derivation-constraint",
    "appendix 2, (A.6), (A.7); (5.9)",
    "(A.4c) ⇔ dg(X_i, y)/dt = 0 ⇔ Ẋ_i = −(∂_X g)⁻¹∂_y g[ẏ] ⇔ (A.5b)",
    "The constraints hold if and only if the particles have the velocities Φ_i[ẏ].",
    vanishes(
        U - phi * v - G**-1 * (G * U + B * v),
        U + phi * v - G**-1 * (G * U + B * v),
        "U − Φ[ẏ] = (∂_X g)⁻¹ (∂_X g U + ∂_y g ẏ) for every U, so dg/dt = 0 if and only if U = Φ[ẏ], for any nx, ny",
        "−Φ for Φ",
    ),
    also=("c5.velocity",),
)

# The multipliers with K in the order of (5.6a), and with the printed one, its negative; (5.6a) and (5.6b) with them.
RIGHT, PRINTED = (GT**-1 * (own + each - m * acceleration) for each in (pull, -pull))
FIRST, SECOND = m * acceleration - own - pull, phiT * (own + pull - m * acceleration)

_multipliers = argument(
    "c5.derivation-multipliers",
    "appendix 2, (A.11), (A.12); appendix 2, (A.13); appendix 2, (A.14)",
    "λ_i = (∂_X g)⁻ᵀ(F₁(X_i) + 1/N Σ_k K(X_i, X_k) − mΦ_i[ÿ] − mΩ_i[ẏ, ẏ])",
    "(A.12) gives the multipliers as functions of positions, velocities and ÿ.",
    vanishes(
        FIRST + GT * RIGHT,
        FIRST + GT * PRINTED,
        "λ_i of (A.12) with K(X_k, X_i) solves (5.6a), any nx, ny, N",
        "with K(X_i, X_k)",
    ),
    vanishes(
        BT * RIGHT + SECOND,
        BT * PRINTED + SECOND,
        "inserted into (5.6b) it gives (A.13) with K(X_k, X_j)",
        "with K(X_j, X_k)",
    ),
    vanishes(
        m * acceleration - f + GT * multiplier,
        m * acceleration - f + f - m * (phi * a + other),
        "in (A.14) with Ω_i[ẏ, ẏ]",
        "with Ω_i[ẏ, ÿ]",
    ),
    also=("c5.derivation-insert", "c5.derivation-back"),
    correction=Correction(
        "λ_i = (∂_X g)⁻ᵀ(F₁(X_i) + 1/N Σ_k K(X_k, X_i) − mΦ_i[ÿ] − mΩ_i[ẏ, ẏ])",
        Effect.MODEL,
        "(A.14), and with it the multipliers of Proposition 5.1",
        why="it is (A.4a) solved for λ_i, with the order of K that c5.derivation-order corrects to that of (5.6a)",
        place=4162,
    ),
    rests_on=("c5.acceleration",),
)

_equivalent = argument(
    "c5.equivalence",
    "before Proposition 5.1",
    "with solutions of the ODE model we can recover the Lagrangian multipliers to construct a solution of the DAE",
    "Reduced and constrained equations have the same solutions.",
    REDUCED,
    vanishes(
        m * acceleration - f + GT * multiplier,
        m * (phi * a - curved) - f + GT * multiplier,
        "with λ_i of (A.12) m Ẍ_i = f_i − (∂_X g)ᵀλ_i for Ẍ_i = Φ_i[ÿ] + Ω_i[ẏ, ẏ]",
        "−Ω in Ẍ_i",
    ),
    also=("c5.same-motion",),
    rests_on=("c5.derivation-constraint", "c5.derivation-multipliers"),
    chosen="λ_i of (A.12) with K(X_k, X_i); those of (A.14), which Proposition 5.1 names, see c5.derivation-back",
)
