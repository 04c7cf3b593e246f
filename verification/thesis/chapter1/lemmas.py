"""Steps of proofs that several claims of chapter 1 rest on."""

from __future__ import annotations

from typing import Any

from verification.claims.formal.algebra import library, matrices, vanishes
from verification.claims.formal.reals import follows, reals, solver_library

z3, sp = solver_library(), library()

# x stays nearest along v = y - x: p = v.(z - x), D = |z - x|^2 for a point z of S.
p, D, a, b, r, E, rate, k = reals("p D a b r E rate k")
NEAREST = follows(
    [D >= 0, D - 2 * p >= 0, a >= 0, a <= 1],
    D - 2 * a * p >= 0,
    D + 2 * a * p >= 0,
    "if |y − z| ≥ |y − x| for all z ∈ S, x is nearest to x + α(y − x), 0 ≤ α ≤ 1: y − x ∈ N(S, x)",
    "for −1 ≤ α ≤ 0",
)

# E = |x - y|^2 with E' <= 2 k E, k = K' any function, has a falling E exp(-2 K).
t = sp.Symbol("t")
square, K = sp.Function("E")(t), sp.Function("K")(t)
SCALED, FALL = (square * sp.exp(-2 * K)).diff(t), 2 * K.diff(t) * square
GROWTH_OF_DISTANCE = (
    vanishes(
        SCALED - (square.diff(t) - FALL) * sp.exp(-2 * K),
        SCALED - (square.diff(t) + FALL) * sp.exp(-2 * K),
        "d/dt(E e^{−2K}) = (Ė − 2K̇E) e^{−2K}, K̇ the one-sided constant",
        "+2K̇E",
    ),
    follows(
        [E > 0, rate <= 2 * k * E],
        rate - 2 * k * E <= 0,
        rate - k * E <= 0,
        "which is ≤ 0 if Ė ≤ 2K̇E, so ‖x − y‖ ≤ e^{K(t) − K(0)}‖x(0) − y(0)‖",
        "half of the constant",
    ),
)

# N^g = N where the rows of G are independent; of a pair a = |d|, p = d.move, r = |move|^2, b is new. n = -G^T lambda is
# proximal, as g grows at most by its slope and r/(2a). A proximal n has n.w <= 0 for all w with G w > 0; W = G^T (G
# G^T)^-1 has G W = I, so lambda = -W^T n >= 0 and n = -G^T lambda but for what no row sees.
GGT = matrices("GGT,")[0]
CONES = (
    follows(
        [a > 0, b >= 0, b * b == a * a + 2 * p + r],
        2 * a * b <= 2 * a * a + 2 * p + r,
        2 * a * b <= 2 * a * a + 2 * p - r,
        "|d + move| ≤ |d| + d·move/|d| + |move|²/(2|d|), so Σλ_k∇g_k·(y − x) ≥ −K‖y − x‖² for all y ∈ S: N^g ⊆ N",
        "−|move|²/(2|d|)",
    ),
    vanishes(
        GGT * GGT**-1 - 1,
        GGT * GGT - 1,
        "G Gᵀ(GGᵀ)⁻¹ = I: n·w ≤ 0 for the columns w gives λ ≥ 0",
        "GGᵀ for its inverse",
    ),
    follows(
        [p <= 0, -p <= 0],
        p == 0,
        ([p <= 0], p == 0),
        "n·w ≤ 0 for w and −w that no row sees gives n·w = 0: N ⊆ N^g",
        "for w alone",
    ),
)


def sign_values(x: Any, h: Any) -> list[Any]:
    """State that h is a value of the set-valued sign function at x."""
    return [h >= -1, h <= 1, z3.Implies(x > 0, h == 1), z3.Implies(x < 0, h == -1)]
