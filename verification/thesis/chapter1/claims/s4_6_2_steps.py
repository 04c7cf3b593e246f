"""Chapter 1, section 4.6.2: the proof of existence, the steps of the catch-up scheme, their bounds and their limit."""

from __future__ import annotations

import math

import numpy as np

from verification.claims import Correction, Effect, Evidence, Verdict, at_least, at_most, claim, proved
from verification.formal.algebra import identity
from verification.formal.reals import implication
from verification.thesis.chapter1.lemmas import nearest
from verification.thesis.chapter1.sets import ROUNDING, Floats, catch_up

T, STEPS = 1.0, 200
H = T / STEPS
# A force that pushes towards one axis and away from the other, and its constant of linear growth.
MATRIX, SHIFT = np.array([[0.9, 0.2], [0.1, -1.1]]), np.array([0.1, -0.2])
M_F = max(float(np.linalg.norm(MATRIX, 2)), float(np.linalg.norm(SHIFT)))
STARTS = np.array([[1.2, 0.1], [0.05, 1.3], [-0.1, 1.01], [40.0, 30.0]])


def pushing(x: Floats) -> Floats:
    """Return a force with ‖F(x)‖ <= M_F (1 + ‖x‖)."""
    return np.asarray(x @ MATRIX.T + SHIFT)


@claim(
    "c1.step-bounds",
    "A step of catch-up moves by at most 2hM_F(1 + ‖x_k‖).",
    source="(1.50), (1.51)",
    quote="… ≤ hM_F(1 + ‖x_k‖), ‖x_{k+1} - x_k‖ ≤ 2hM_F(‖x_k‖ + 1)",
    recorded=Verdict.PROVED,
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
    """Return C_1 of (1.52) by Theorem 1.36 with A = B = 2 M_F, for first distances from 0."""
    grown = math.exp(2 * growth * T)
    return start * grown + grown - 1


@claim(
    "c1.constant",
    "The discrete solutions are bounded by a constant C₁ that depends only on T and M_F.",
    source="(1.52)",
    quote="‖x_k‖ ≤ C₁ < ∞ for a constant C₁ which only depends on T and M_F.",
    correction=Correction(
        "C₁ = exp(2M_F T)(‖xⁱⁿⁱᵗ‖ + 1) - 1 depends on ‖xⁱⁿⁱᵗ‖ as well",
        Effect.PROOF,
        "C₂ and C₃; the solution of one start exists all the same",
        why=(
            "Theorem 1.36 with A = B = 2M_F bounds ‖x_k‖ by exp(2M_F T)‖x₀‖ + exp(2M_F T) − 1, and k = 0 alone "
            "needs C₁ ≥ ‖xⁱⁿⁱᵗ‖"
        ),
        place=995,
    ),
    rests_on=("c1.gronwall-discrete", "c1.gronwall-range", "c1.step-bounds"),
    tried_on="a linear force outside of a disc, four starts",
)
def _constant() -> Evidence:
    sizes = np.linalg.norm(catch_up(STARTS, pushing, H, STEPS), axis=-1)
    printed = float(sizes.max() / first_constant(np.ones(1))[0])
    right = float((sizes / first_constant(sizes[0])).max())
    name = f"largest ‖x_k‖ over C₁ by (1.45), T = 1, M_F = {M_F:.2f}, {{}} the start"
    return Evidence(
        printed=(at_most(name.format("without"), printed, 1.0),),
        corrected=(at_most(name.format("with"), right, 1.0, ROUNDING),),
    )


@claim(
    "c1.speeds",
    "The interpolated solutions are bounded by C₁, their speeds by C₂ and the constraint forces by C₃.",
    source="(1.53), (1.54), before (1.67)",
    quote="2M_F(1 + C₁) =: C₂, ‖x⁽ⁿ⁾‖_∞ ≤ C₁, ‖ẋ⁽ⁿ⁾‖_∞ ≤ C₂, C₃ := C₂ + M_F(1 + C₁)",
    recorded=Verdict.PROVED,
    rests_on=("c1.step-bounds", "c1.constant"),
    chosen="C₁ with the start in it",
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
    "With short steps the projections of the catch-up scheme are unique.",
    source="(1.55)",
    quote="dist(x_k + hF(x_k), S) ≤ … < η … the projections in (1.39) are unique for sufficiently large n.",
    recorded=Verdict.PROVED,
    rests_on=("c1.hypomonotone", "c1.step-bounds", "c1.constant"),
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


def settled(first: int, last: int) -> float:
    """Return the part of the times at which 1 on [0, 2^-k) is 0 for all k from first to last."""
    t = (np.arange(2**14) + 0.5) / 2**14
    return float(np.all([t >= 2.0**-k for k in range(first, last + 1)], axis=0).mean())


@claim(
    "c1.dense",
    "Velocities that converge at a dense set of times give the inclusion at almost all times.",
    source="step 4, (1.62), and (1.74)",
    quote="we obtain for a dense set 𝒯 ⊆ [0, T] the pointwise convergence … for a.e. t ∈ [0, T].",
    correction=Correction(
        "𝒯 has full measure: convergence in L¹ gives a subsequence that converges almost everywhere",
        Effect.PROOF,
        "(1.68) to (1.74), which hold for t ∈ 𝒯",
        why=(
            "a sequence that converges in L¹ has a subsequence that converges almost everywhere; a dense set may "
            "have measure 0, and (1.74) is for almost every t"
        ),
        place=1039,
    ),
    tried_on="one sequence of running steps",
)
def _dense() -> Evidence:
    """Intervals of length 0.01/2^j around the dyadic numbers; 1 on intervals of length 2^-k that run through [0, 1]."""
    length = sum(0.01 * 0.5**j for j in range(1, 2**10 + 2))
    late, early = (1 - settled(first, 14) for first in (12, 8))
    return Evidence(
        printed=(at_least("length of intervals around the dyadic numbers, a dense set, over T", length, 1.0),),
        corrected=(at_most("part of t where running steps have not settled, k = 12 over k = 8:", late / early, 0.5),),
    )


@claim(
    "c1.step-inclusion",
    ("Between two steps the interpolated solution satisfies the inclusion with a normal at the later state."),
    source="(1.66)",
    quote="ẋ⁽ⁿ⁾(t) - F⁽ⁿ⁾(t) ∈ -N(S, x_{k+1}) for t ∈ (t_k, t_{k+1})",
    recorded=Verdict.PROVED,
    rests_on=("c1.catch-up-normal",),
)
def _step_inclusion() -> Evidence:
    """Between t_k and t_(k+1) the velocity is (x_(k+1) - x_k)/h and the force F(x_k); N is a cone."""
    return proved(
        identity(
            "h(ẋ⁽ⁿ⁾ − F⁽ⁿ⁾) = −(y − P_S(y)) with y = x_k + hF(x_k), x_{k+1} = P_S(y)",
            lambda s, x, new, h, F: h * ((new - x) / h - F) + (x + s * h * F - new),
            "y = x_k − hF(x_k)",
        ),
        nearest(),
    )
