"""Chapter 3, section 2.3: the constraints, the Lagrangian and the equilibria on which the minimisers rest."""

from __future__ import annotations

from verification.claims.formal.reals import follows, reals
from verification.claims.formal.stated import argument

# m = min(0, g(z)) of one row; sup over lambda of W + lambda m is W for m = 0 and infinite for m < 0.
W, level, m, L, K = reals("W level m L K")
OUTSIDE = [m < 0, W + level * m == L]

_saddle = argument(
    "c3.saddle",
    "(3.20)",
    "Solutions of (3.20) will also be solutions of the original problem (3.18).",
    "inf sup of ℒ = W + Σ λ_ℓ min(0, g_ℓ) over all λ gives the minima of W over S.",
    follows([m == 0, W + level * m == L], W == L, -W == L, "ℒ = W for every λ where g ≥ 0", "−W"),
    follows(
        [*OUTSIDE, level * m == K - W + 1],
        L > K,
        ([*OUTSIDE, level * m == -(K - W + 1)], L > K),
        "where g < 0 ℒ is above any K for λ = (K − W + 1)/g: inf sup ℒ is taken in S, at the least W",
        "λ = −(K − W + 1)/g",
    ),
)
