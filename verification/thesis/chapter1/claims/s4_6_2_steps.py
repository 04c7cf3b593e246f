"""Chapter 1, section 4.6.2: the proof of existence, the steps of the catch-up scheme, their bounds and their limit."""

from __future__ import annotations

from verification.claims.formal.reals import follows, reals
from verification.claims.formal.stated import argument

# Sizes: r = |x_k|, new = |x_(k+1)|, start = |x_0|, n = |x_(k+1) - x_k|/h, f = |F(x_k)|, d = dist(x_k + h F(x_k), S), g
# = h M_F (1 + |x_k|), G = (1 + 2 h M_F)^k; p, q are two nearest points, D = |p - q|^2, rho their distance.
r, new, h, M, G, n, f, C, m, d, g, D, rho, eta, steps, T = reals("r new h M G n f C m d g D rho eta steps T")


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
    rests_on=("c1.hypomonotone", "c1.speeds"),
)
