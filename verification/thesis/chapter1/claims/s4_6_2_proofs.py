"""Chapter 1, section 4.6.2: the proof of existence, the steps of the catch-up scheme and their bounds."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import math

import numpy as np

from verification.claims import Evidence, Verdict, at_most, proved
from verification.formal.reals import implication
from verification.thesis.chapter1.sets import Floats, catch_up, outside
from verification.thesis.text.quoted import claim

ROUNDING = 1e-12
T, STEPS = 1.0, 200
H = T / STEPS
# A force that pushes towards one axis and away from the other, and its constant of linear growth.
MATRIX, SHIFT = np.array([[0.9, 0.2], [0.1, -1.1]]), np.array([0.1, -0.2])
M_F = max(float(np.linalg.norm(MATRIX, 2)), float(np.linalg.norm(SHIFT)))
STARTS = np.array([[1.2, 0.1], [0.05, 1.3], [-0.1, 1.01], [40.0, 30.0]])


def pushing(x: Floats) -> Floats:
    """A force with ‖F(x)‖ <= M_F (1 + ‖x‖)."""
    return np.asarray(x @ MATRIX.T + SHIFT)


def reach(y: Floats) -> Floats:
    """dist(y, S) for the outside of the unit disc."""
    return np.asarray(np.maximum(1 - np.linalg.norm(y, axis=-1), 0.0))


@claim(
    "c1.projection-step",
    "The distance of a step of catch-up from the free step.",
    "before (1.50)",
    Verdict.CORRECTED,
    chosen="the outside of the unit disc and a linear force",
    tried_on="a linear force outside of a disc, four starts",
)
def _projection_step() -> Evidence:
    """The first line of (1.50) at points of S, with the next point as printed and as in (1.46)."""
    x = catch_up(STARTS, pushing, H, STEPS)[:-1]
    target = x + H * pushing(x)
    printed, right = (
        float(np.abs(np.linalg.norm(outside(y) - target, axis=-1) - reach(target)).max() / H) for y in (x, target)
    )
    return Evidence(
        f"P_S(x_k) = x_k for x_k ∈ S, so as printed nothing moves, and the first equality of (1.50) is off by up to "
        f"{printed:.2f} h. With P_S(x_k + hF(x_k)), as in (1.46), by {right:.0e} h.",
        printed=(at_most("error of the equality in (1.50), over h", printed, 0.0, 1e-9),),
        corrected=(at_most("error with P_S(x_k + hF(x_k)), over h", right, 0.0, 1e-9),),
    )


@claim(
    "c1.step-bounds",
    "How far a step of catch-up goes.",
    "(1.50), (1.51)",
    Verdict.PROVED,
)
def _step_bounds() -> Evidence:
    """d = dist(x_k + hF, S) <= |hF| as x_k is in S; g = h M_F (1 + |x_k|); n = |x_(k+1) - x_k|."""
    return proved(
        implication(
            "dist(x_k + hF, S) ≤ ‖hF‖ ≤ hM_F(1 + ‖x_k‖) and ‖x_{k+1} − x_k‖ ≤ ‖x_{k+1} − x_k − hF‖ + ‖hF‖ ≤ "
            "2hM_F(1 + ‖x_k‖)",
            lambda s, d, f, g, n: ([d >= 0, d <= f, f <= g, n <= d + f], [d <= g, n <= 2 * s * g]),
            "‖x_{k+1} − x_k‖ ≤ hM_F(1 + ‖x_k‖)",
            0.5,
        )
    )


def first_constant(start: Floats, growth: float = M_F) -> Floats:
    """C_1 of (1.52) by Theorem 1.36 with A = B = 2 M_F, for first distances from 0."""
    grown = math.exp(2 * growth * T)
    return start * grown + grown - 1


@claim(
    "c1.constant",
    "What the bound of the discrete solutions depends on.",
    "(1.52)",
    Verdict.CORRECTED,
    chosen="the outside of the unit disc and a linear force",
    tried_on="a linear force outside of a disc, four starts",
)
def _constant() -> Evidence:
    sizes = np.linalg.norm(catch_up(STARTS, pushing, H, STEPS), axis=-1)
    printed = float(sizes.max() / first_constant(np.ones(1))[0])
    right = float((sizes / first_constant(sizes[0])).max())
    return Evidence(
        f"‖x_k‖ ≤ C₁ for k = 0 says that C₁ ≥ ‖xⁱⁿⁱᵗ‖. With T = 1, M_F = {M_F:.2f} the ‖x_k‖ from ‖x₀‖ = 50 are up to "
        f"{printed:.1f} times the C₁ that (1.45) gives without the start, and {right:.2f} times that of "
        "exp(2M_F T)(‖xⁱⁿⁱᵗ‖ + 1) - 1.",
        printed=(at_most("‖x_k‖ over C₁(T, M_F)", printed, 1.0),),
        corrected=(at_most("‖x_k‖ over C₁(T, M_F, ‖xⁱⁿⁱᵗ‖)", right, 1.0, ROUNDING),),
    )


@claim(
    "c1.speeds",
    "Bounds of the interpolated solutions, their speeds and the constraint forces.",
    "(1.53), (1.54), before (1.67)",
    Verdict.PROVED,
    chosen="C₁ with the start in it; the outside of the unit disc and a linear force",
)
def _speeds() -> Evidence:
    """r = |x_k| <= C1 at all steps, n = |x_(k+1) - x_k|/h, f = |F(x_k)|; G = (1 + 2 h M_F)^k (1 + |x_0|)."""
    return proved(
        implication(
            "1 + ‖x_{k+1}‖ ≤ (1 + 2hM_F)(1 + ‖x_k‖), so 1 + ‖x_k‖ ≤ (1 + 2hM_F)^k (1 + ‖x₀‖) ≤ e^{2M_F T}(1 + "
            "‖x₀‖) = 1 + C₁",
            lambda s, r, new, h, M, G: (
                [h > 0, M > 0, r >= 0, new <= r + 2 * h * M * (1 + r), 1 + r <= G],
                1 + new <= (1 + s * 2 * h * M) * G,
            ),
            "(1 − 2hM_F)",
        ),
        implication(
            "‖ẋ⁽ⁿ⁾‖ ≤ 2M_F(1 + C₁) = C₂ and ‖ẋ⁽ⁿ⁾ − F⁽ⁿ⁾‖ ≤ C₂ + M_F(1 + C₁) = C₃",
            lambda s, n, f, r, M, C, m: (
                [M > 0, r >= 0, r <= C, n <= 2 * M * (1 + r), f <= M * (1 + r), m <= n + f],
                [n <= s * 2 * M * (1 + C), m <= s * 3 * M * (1 + C)],
            ),
            "half of C₂",
            0.5,
        ),
    )


@claim(
    "c1.unique-projections",
    "With short steps the catch-up scheme has one place to go to.",
    "(1.55)",
    Verdict.PROVED,
)
def _unique() -> Evidence:
    """Two nearest points p, q of z at the distance r: (1.28) for z - p and z - q says D <= (r/eta) D, D = |p - q|^2."""
    return proved(
        implication(
            "‖p − q‖² ≤ (r/η)‖p − q‖² with r < η gives p = q",
            lambda s, D, r, eta: ([eta > 0, r >= 0, D >= 0, eta * D <= s * r * D, r < eta], D == 0),
            "with r < 2η",
            2,
        ),
        implication(
            "hM_F(1 + C₁) < η for h = T/n, n > TM_F(1 + C₁)/η",
            lambda s, h, n, T, g, eta: ([n > 0, T > 0, g > 0, eta > 0, h * n == T, s * n * eta > T * g], h * g < eta),
            "n > TM_F(1 + C₁)/(2η)",
            2,
        ),
    )
