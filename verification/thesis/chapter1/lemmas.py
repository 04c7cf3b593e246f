"""Proofs that several claims of chapter 1 rest on."""

from __future__ import annotations

from typing import Any

from verification.claims import FormalProof
from verification.formal.algebra import identity, library
from verification.formal.reals import implication, solver_library


def nearest() -> FormalProof:
    """Prove that x stays nearest along v = y - x: p = v.(z - x), D = |z - x|^2 for a point z of S."""
    return implication(
        "if |y − z| ≥ |y − x| for all z ∈ S, x is nearest to x + α(y − x), 0 ≤ α ≤ 1: y − x ∈ N(S, x)",
        lambda s, p, D, a: ([D >= 0, D - 2 * p >= 0, a >= 0, a <= 1], D - s * 2 * a * p >= 0),
        "for −1 ≤ α ≤ 0",
    )


def cones() -> tuple[FormalProof, FormalProof, FormalProof]:
    """Prove N^g = N where the rows of G are independent; of a pair a = |d|, p = d.move, r = |move|^2, b is new.

    n = -G^T lambda is proximal, as g grows at most by its slope and r/(2a). A proximal n has n.w <= 0 for all w with
    G w > 0; W = G^T (G G^T)^-1 has G W = I, so lambda = -W^T n >= 0 and n = -G^T lambda but for what no row sees.
    """
    return (
        implication(
            "|d + move| ≤ |d| + d·move/|d| + |move|²/(2|d|), so Σλ_k∇g_k·(y − x) ≥ −K‖y − x‖² for all y ∈ S: N^g ⊆ N",
            lambda s, a, b, p, r: ([a > 0, b >= 0, b * b == a * a + 2 * p + r], 2 * a * b <= 2 * a * a + 2 * p + s * r),
            "−|move|²/(2|d|)",
        ),
        identity(
            "G Gᵀ(GGᵀ)⁻¹ = I: n·w ≤ 0 for the columns w gives λ ≥ 0",
            lambda s, GGT: GGT * GGT**-s - 1,
            "GGᵀ for its inverse",
            words=True,
        ),
        implication(
            "n·w ≤ 0 for w and −w that no row sees gives n·w = 0: N ⊆ N^g",
            lambda s, p: ([p <= 0, -s * p <= 0], p == 0),
            "for w alone",
        ),
    )


def growth_of_distance() -> tuple[FormalProof, FormalProof]:
    """Prove that E = |x - y|^2 with E' <= 2 k E, k(t) any function, has a falling E exp(-2 int k)."""
    sp = library()
    t = sp.Symbol("t")
    E, K = sp.Function("E")(t), sp.Function("K")(t)
    return (
        identity(
            "d/dt(E e^{−2K}) = (Ė − 2K̇E) e^{−2K}, K̇ the one-sided constant",
            lambda s: (E * sp.exp(-2 * K)).diff(t) - (E.diff(t) - s * 2 * K.diff(t) * E) * sp.exp(-2 * K),
            "+2K̇E",
        ),
        implication(
            "which is ≤ 0 if Ė ≤ 2K̇E, so ‖x − y‖ ≤ e^{K(t) − K(0)}‖x(0) − y(0)‖",
            lambda s, rate, k, E: ([E > 0, rate <= 2 * k * E], rate - s * 2 * k * E <= 0),
            "half of the constant",
            0.5,
        ),
    )


def sign_values(x: Any, h: Any) -> list[Any]:
    """State that h is a value of the set-valued sign function at x."""
    z3 = solver_library()
    return [h >= -1, h <= 1, z3.Implies(x > 0, h == 1), z3.Implies(x < 0, h == -1)]
