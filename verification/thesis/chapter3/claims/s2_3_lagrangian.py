"""Chapter 3, section 2.3: the constraints, the Lagrangian and the equilibria on which the minimisers rest."""

from __future__ import annotations

from verification.claims import Evidence, Verdict, claim, proved
from verification.formal.reals import implication, solver_library


@claim(
    "c3.saddle",
    "inf sup of ℒ = W + Σ λ_ℓ min(0, g_ℓ) over all λ gives the minima of W over S.",
    source="(3.20)",
    quote="Solutions of (3.20) will also be solutions of the original problem (3.18).",
    recorded=Verdict.PROVED,
)
def _saddle() -> Evidence:
    """Take m = min(0, g(z)) of one row; sup over lambda of W + lambda m is W for m = 0 and infinite for m < 0."""
    return proved(
        implication(
            "ℒ = W for every λ where g ≥ 0", lambda s, W, level, m, L: ([m == 0, W + level * m == L], s * W == L), "−W"
        ),
        implication(
            "where g < 0 ℒ is above any K for λ = (K − W + 1)/g: inf sup ℒ is taken in S, at the least W",
            lambda s, W, K, m, level, L: ([m < 0, level * m == s * (K - W + 1), W + level * m == L], L > K),
            "λ = −(K − W + 1)/g",
        ),
    )


@claim(
    "c3.rests",
    "A constrained minimum, with its multipliers, is an equilibrium of both systems.",
    source="(3.21) to (3.23)",
    quote=(
        "The dynamical system (3.21) and (3.22) has every solution of (3.18) as an equilibrium. … (3.23) … "
        "has also all solutions of (3.18) as equilibria."
    ),
    recorded=Verdict.PROVED,
    chosen="multipliers ≤ 0 for (3.21), ≥ 0 for (3.23), as their signs ask for",
)
def _rest() -> Evidence:
    """Take one component and one row: w of grad W, j of grad g; a minimum has w = l j, l >= 0, g >= 0, l g = 0."""
    z3 = solver_library()
    return proved(
        implication(
            "with ∇W = Σ λ∇g, λg = 0 the right sides of (3.21), λ ≤ 0, of (3.22) and of (3.23), λ ≥ 0, vanish",
            lambda s, w, j, level, g, a, b, c: (
                [w == level * j, level >= 0, g >= 0, level * g == 0],
                [
                    a * (w + s * (-level) * j) == 0,
                    z3.Or(z3.And(level == 0, g >= 0), -b * g == 0),
                    a * (w - level * j) + c * level * g * j == 0,
                ],
            ),
            "λ ≥ 0 in (3.21)",
        )
    )
