"""Chapter 1, section 4.6.2: the proof of existence, the steps of the catch-up scheme, their bounds and their limit."""

from __future__ import annotations

import numpy as np

from verification.claims import Correction, Effect, Evidence, at_least, at_most, claim
from verification.claims.formal.reals import follows, reals
from verification.claims.formal.stated import argument, implication

# Sizes: r = |x_k|, new = |x_(k+1)|, start = |x_0|, n = |x_(k+1) - x_k|/h, f = |F(x_k)|, d = dist(x_k + h F(x_k), S), g
# = h M_F (1 + |x_k|), G = (1 + 2 h M_F)^k; p, q are two nearest points, D = |p - q|^2, rho their distance.
r, new, start, h, M, G, n, f, C, m, d, g, D, rho, eta, steps, T = reals(
    "r new start h M G n f C m d g D rho eta steps T"
)

# A force that pushes towards one axis and away from the other, and its constant of linear growth.
MATRIX, SHIFT = np.array([[0.9, 0.2], [0.1, -1.1]]), np.array([0.1, -0.2])
M_F = max(float(np.linalg.norm(MATRIX, 2)), float(np.linalg.norm(SHIFT)))

GROWING = [h > 0, M > 0, r >= 0, start >= 0, G >= 1, new <= r + 2 * h * M * (1 + r), 1 + r <= G * (1 + start)]

_constant = implication(
    "c1.constant",
    "(1.52)",
    "‖x_k‖ ≤ C₁ < ∞ for a constant C₁ which only depends on T and M_F.",
    "The discrete solutions are bounded by a constant C₁ that depends only on T and M_F.",
    given=GROWING,
    then=1 + new <= (1 + 2 * h * M) * G * (1 + start),
    wrong=1 + new <= (1 + 2 * h * M) * G * 2,
    correction=Correction(
        "C₁ = exp(2M_F T)(‖xⁱⁿⁱᵗ‖ + 1) - 1 depends on ‖xⁱⁿⁱᵗ‖ as well",
        Effect.PROOF,
        "C₂ and C₃; the solution of one start exists all the same",
        why=(
            "Theorem 1.36 with A = B = 2M_F bounds ‖x_k‖ by exp(2M_F T)‖x₀‖ + exp(2M_F T) − 1, and k = 0 alone needs "
            "C₁ ≥ ‖xⁱⁿⁱᵗ‖"
        ),
        place=995,
    ),
    rests_on=("c1.gronwall-discrete",),
)

STEP, RATES = (
    [h > 0, M > 0, r >= 0, new <= r + 2 * h * M * (1 + r), 1 + r <= G],
    [M > 0, r >= 0, r <= C, n <= 2 * M * (1 + r)],
)

_speeds = argument(
    "c1.speeds",
    "(1.53), (1.54), before (1.67); (1.50), (1.51)",
    "2M_F(1 + C₁) =: C₂, ‖x⁽ⁿ⁾‖_∞ ≤ C₁, ‖ẋ⁽ⁿ⁾‖_∞ ≤ C₂, C₃ := C₂ + M_F(1 + C₁)",
    "The interpolated solutions are bounded by C₁, their speeds by C₂ and the constraint forces by C₃.",
    follows(
        [d >= 0, d <= f, f <= g, n <= d + f],
        [d <= g, n <= 2 * g],
        n <= g,
        "dist(x_k + hF, S) ≤ ‖hF‖ ≤ hM_F(1 + ‖x_k‖) and ‖x_{k+1} − x_k‖ ≤ ‖x_{k+1} − x_k − hF‖ + ‖hF‖ ≤ 2hM_F(1 + "
        "‖x_k‖)",
        "‖x_{k+1} − x_k‖ ≤ hM_F(1 + ‖x_k‖)",
    ),
    follows(
        STEP,
        1 + new <= (1 + 2 * h * M) * G,
        1 + new <= (1 - 2 * h * M) * G,
        "1 + ‖x_{k+1}‖ ≤ (1 + 2hM_F)(1 + ‖x_k‖), so 1 + ‖x_k‖ ≤ (1 + 2hM_F)^k (1 + ‖x₀‖) ≤ e^{2M_F T}(1 + ‖x₀‖) = 1 + "
        "C₁",
        "(1 − 2hM_F)",
    ),
    follows(
        [*RATES, f <= M * (1 + r), m <= n + f],
        [n <= 2 * M * (1 + C), m <= 3 * M * (1 + C)],
        [n <= M * (1 + C), m <= 3 * M * (1 + C)],
        "‖ẋ⁽ⁿ⁾‖ ≤ 2M_F(1 + C₁) = C₂ and ‖ẋ⁽ⁿ⁾ − F⁽ⁿ⁾‖ ≤ C₂ + M_F(1 + C₁) = C₃",
        "half of C₂",
    ),
    also=("c1.step-bounds",),
    rests_on=("c1.constant",),
    chosen="C₁ with the start in it",
)

# (1.28) for z - p and z - q says D <= (rho/eta) D for two nearest points p, q of z.
TWO = [eta > 0, rho >= 0, D >= 0, rho < eta]
MANY = [steps > 0, T > 0, g > 0, eta > 0, h * steps == T]

_unique = argument(
    "c1.unique-projections",
    "(1.55)",
    "dist(x_k + hF(x_k), S) ≤ … < η … the projections in (1.39) are unique for sufficiently large n.",
    "With short steps the projections of the catch-up scheme are unique.",
    follows(
        [*TWO, eta * D <= rho * D],
        D == 0,
        ([*TWO, eta * D <= 2 * rho * D], D == 0),
        "‖p − q‖² ≤ (r/η)‖p − q‖² with r < η gives p = q",
        "with r < 2η",
    ),
    follows(
        [*MANY, steps * eta > T * g],
        h * g < eta,
        ([*MANY, 2 * steps * eta > T * g], h * g < eta),
        "hM_F(1 + C₁) < η for h = T/n, n > TM_F(1 + C₁)/η",
        "n > TM_F(1 + C₁)/(2η)",
    ),
    rests_on=("c1.hypomonotone", "c1.speeds", "c1.constant"),
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
            "a sequence that converges in L¹ has a subsequence that converges almost everywhere; a dense set may have "
            "measure 0, and (1.74) is for almost every t"
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
