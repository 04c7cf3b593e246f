"""Chapter 1, sections 4.6 and 5: the proofs of existence and uniqueness, and whether they cover the later models."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

import dincl
from verification.claims import Correction, Effect, Evidence, at_most, claim
from verification.claims.formal.reals import follows, reals
from verification.claims.formal.stated import argument
from verification.thesis.chapter1.sets import (
    ROUNDING,
    SAMPLES,
    SEED,
    TOL,
    Floats,
    State,
    divided,
    in_mitosis,
    nearest,
    overlap,
    problem,
)

T, A, B, N = 1.0, 0.01, 0.01, 50


def sequences(size: float) -> Floats:
    """Return sequences a_0, ..., a_n of (1.43) in the plane, (n + 1, K, 2), |a_0| = size; the first grows fastest."""
    rng, a = np.random.default_rng(SEED), np.zeros((SAMPLES, 2))
    a[:, 0] = size
    path = [a]
    for _ in range(N):
        direction = a + rng.normal(size=a.shape) * np.where(np.arange(SAMPLES) == 0, 0.0, 5.0)[:, None]
        direction /= np.linalg.norm(direction, axis=1, keepdims=True)
        a = a + T / N * (A + B * np.linalg.norm(a, axis=1, keepdims=True)) * direction
        path.append(a)
    return np.array(path)


def discrete_bound(first: float) -> float:
    """Return the middle of (1.44) with a factor in its first term."""
    grown = (1 + B * T / N) ** N
    return first * grown + A / B * (grown - 1)


@claim(
    "c1.gronwall-discrete",
    "Sequences with (1.43) are bounded by (1 + BT/n)^n + A/B ((1 + BT/n)^n - 1), whatever their first element.",
    source="Theorem 1.36, (1.43)",
    also=("c1.gronwall-range",),
    quote="a_k ≤ (1 + BT/n)^n + 1/B ((1 + BT/n)^n - 1) A ≤ exp(BT) + A (exp(BT) - 1)/B",
    correction=Correction(
        "‖a_k‖ ≤ (1 + BT/n)^n ‖a₀‖ + 1/B ((1 + BT/n)^n - 1) A ≤ exp(BT) ‖a₀‖ + A (exp(BT) - 1)/B",
        Effect.CONCLUSION,
        "(1.52) and the constants C₁, C₂, C₃; the proof of existence stands with the factor",
        why="‖a_{k+1}‖ ≤ (1 + BT/n)‖a_k‖ + AT/n, so (1 + BT/n)^k multiplies ‖a₀‖; a_k is a vector, its norm is bounded",
        place=942,
    ),
    tried_on="300 sequences in the plane, n = 50",
)
def _gronwall_discrete() -> Evidence:
    start = 10.0
    largest = float(np.linalg.norm(sequences(start), axis=2).max())
    top = start * math.exp(B * T) + A * (math.exp(B * T) - 1) / B
    return Evidence(
        printed=(at_most(f"‖a₀‖ = {start:g}: largest ‖a_k‖ over (1.44)", largest / discrete_bound(1.0), 1.0),),
        corrected=(
            at_most("largest ‖a_k‖ over (1.44) with ‖a₀‖", largest / discrete_bound(start), 1.0, ROUNDING),
            at_most("largest ‖a_k‖ over (1.45) with ‖a₀‖", largest / top, 1.0, ROUNDING),
        ),
        seed=SEED,
    )


# Sizes: r = |x_k|, new = |x_(k+1)|, start = |x_0|, n = |x_(k+1) - x_k|/h, f = |F(x_k)|, d = dist(x_k + h F(x_k), S), g
# = h M_F (1 + |x_k|), G = (1 + 2 h M_F)^k; p, q are two nearest points, D = |p - q|^2, rho their distance.
r, new, h, M, G, n, f, C, m, d, g, D, rho, eta, steps, span = reals("r new h M G n f C m d g D rho eta steps T")


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
MANY = [steps > 0, span > 0, g > 0, eta > 0, h * steps == span]

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
        [*MANY, steps * eta > span * g],
        h * g < eta,
        ([*MANY, 2 * steps * eta > span * g], h * g < eta),
        "hM_F(1 + C₁) < η for h = T/n, n > TM_F(1 + C₁)/η",
        "n > TM_F(1 + C₁)/(2η)",
    ),
    rests_on=("c1.hypomonotone", "c1.speeds"),
)


# Of catch-up from a feasible state, in units of the time in which the pull to the middle acts.
DT, END = 0.1, 1.0


def refined(start: State) -> tuple[float, float]:
    """Return the largest overlap of catch-up, and how much less the end moves when the step is halved a second time."""
    paths = [
        dincl.solve(problem(*start), dincl.CatchUp(dt, dincl.Daqp(tol=TOL)), t=np.arange(1, round(END / dt) + 1) * dt)
        for dt in (DT, DT / 2, DT / 4)
    ]
    first, second = (float(np.linalg.norm(b.final - a.final)) for a, b in pairwise(paths))
    return max(float(path.violation().max()) for path in paths), second / first


@claim(
    "c1.applications",
    "The theorems also cover the tissue models of chapters 3 and 4.",
    source="section 5, and introduction, Part I",
    quote="the presented theorems also cover our applications in Chapters 3 and 4.",
    correction=Correction(
        (
            "they cover the motion from one cell event to the next, if it starts in S; after a division, and when "
            "mitosis begins, the state is not in S, and has to be projected or set anew, e.g. with daughters 2R^hard "
            "apart"
        ),
        Effect.CONCLUSION,
        (
            "“which fulfil the assumptions needed for well-posedness” in the introduction; section 3.2 of chapter 3, "
            "which takes Theorem 1.31 for its model"
        ),
        why=(
            "Theorem 1.31 needs xⁱⁿⁱᵗ ∈ S; by (3.7) daughters are set nearer to each other than twice the hard radius,"
            " and by (3.4) that radius jumps"
        ),
        place=1129,
    ),
    rests_on=("c1.existence", "c1.dependence", "c1.time-independent"),
    chosen="nuclei in a row that touch, pulled to the middle, without noise",
)
def _applications() -> Evidence:
    events = (divided(), in_mitosis())
    starts = [nearest(event) for event in events]
    left = max(overlap(start) for start in starts)
    later, moves = (max(values) for values in zip(*(refined(start) for start in starts), strict=True))
    return Evidence(
        printed=(
            at_most("overlap of daughters after a division (3.7) [μm]", overlap(events[0]), 0.0, TOL),
            at_most("overlap of neighbours when mitosis begins (3.4) [μm]", overlap(events[1]), 0.0, TOL),
        ),
        corrected=(
            at_most("overlap of the states projected onto S [μm]", left, 0.0, 10 * TOL),
            at_most("overlap of catch-up from there [μm]", later, 0.0, 10 * TOL),
            at_most("change of its end when the step is halved again, over that before", moves, 1.0),
        ),
    )
