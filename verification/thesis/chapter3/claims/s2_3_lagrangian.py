"""Chapter 3, section 2.3: the constraints, the Lagrangian and the equilibria on which the minimisers rest."""

from __future__ import annotations

from verification.claims.formal.reals import follows, reals, solver_library
from verification.claims.formal.stated import argument, implication

z3 = solver_library()

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

# One component and one row: w of grad W, j of grad g; a minimum has w = l j, l >= 0, g >= 0, l g = 0.
w, j, l, g, a, b, c = reals("w j l g a b c")
STILL = [z3.Or(z3.And(l == 0, g >= 0), -b * g == 0), a * (w - l * j) + c * l * g * j == 0]

_rest = implication(
    "c3.rests",
    "(3.21) to (3.23)",
    "The dynamical system (3.21) and (3.22) has every solution of (3.18) as an equilibrium. … (3.23) … has also all "
    "solutions of (3.18) as equilibria.",
    "With ∇W = Σ λ∇g, λg = 0 the right sides of (3.21), λ ≤ 0, of (3.22) and of (3.23), λ ≥ 0, vanish.",
    given=[w == l * j, l >= 0, g >= 0, l * g == 0],
    then=[a * (w - l * j) == 0, *STILL],
    wrong=[a * (w + l * j) == 0, *STILL],
    chosen="multipliers ≤ 0 for (3.21), ≥ 0 for (3.23), as their signs ask for",
)
