"""Chapter 1, section 4.5: existence of solutions, their dependence on the start, and the catch-up scheme."""

from __future__ import annotations

import numpy as np

import dincl
from verification.claims import Correction, Effect, Evidence, at_least, at_most, claim, equal
from verification.claims.formal.reals import follows, reals
from verification.claims.formal.stated import argument
from verification.thesis.chapter1.lemmas import GROWTH_OF_DISTANCE
from verification.thesis.chapter1.sets import (
    GROWN,
    HARD,
    ROUNDING,
    SAMPLES,
    SEED,
    TOL,
    Floats,
    apart,
    away,
    catch_up,
    falling,
    in_mitosis,
    resting,
)

# Half the step of a central difference of numbers that are right to rounding.
HALF = 1e-5
OVERLAPPING, APART = np.array([[0.0, 0.0], [0.8, 0.0]]), np.array([[0.0, 0.0], [1.3, 0.0]])


def slide(t: Floats) -> Floats:
    """Return the exact solution of a disc that falls onto a fixed one of radius 1 in all and slides, (K, 2)."""
    exact = dincl.scenes.sliding_disc().exact
    return np.zeros((len(t), 2)) if exact is None else exact(t)[:, 0]


@claim(
    "c1.existence",
    "The inclusion has a solution, to which the catch-up scheme converges.",
    source="Theorem 1.31",
    quote="the system has an absolutely continuous solution x : [0, T] → ℝ^d.",
    rests_on=("c1.speeds", "c1.unique-projections", "c1.projection-normal"),
    tried_on="a point that slides over a disc",
)
def _existence() -> Evidence:
    """A point that falls onto a disc, slides and leaves it: dist(x' - F, -N(S, x)), and the error of catch-up."""
    times = np.array([0.3, 0.8, 1.3, 2.0, 2.8])
    x, velocity = slide(times), (slide(times + HALF) - slide(times - HALF)) / (2 * HALF)
    pull, unit = velocity - falling(x), x / np.linalg.norm(x, axis=1, keepdims=True)
    touching = np.linalg.norm(x, axis=1) < 1 + 1e-9
    along = np.where(touching, np.maximum((pull * unit).sum(axis=1), 0.0), 0.0)
    left = float(np.linalg.norm(pull - along[:, None] * unit, axis=1).max())
    start = slide(np.zeros(1))
    coarse, fine = (float(np.linalg.norm(catch_up(start, falling, 2.0 / n, n)[-1, 0] - x[3])) for n in (200, 800))
    return Evidence(
        printed=(
            at_most("largest distance of ẋ - F from -N(S, x) at five times, exact solution", left, 0.0, 1e-6),
            at_most("t = 2, step 1/400: error of catch-up over that at four times the step", fine / coarse, 0.5),
        )
    )


# E = |x - y|^2, F has the constant L, and -N is hypomonotone by (1.28): p = -(v - w).(x - y), v, w forces <= M.
f, p, L, E, v, w, M, k = reals("f p L E v w M k")

_dependence = argument(
    "c1.dependence",
    "Lemma 1.32, (1.41); Theorem 1.13",
    "there exists a constant a > 0 such that for all t ∈ [0, T] ‖x(t) - y(t)‖ ≤ a ‖xⁱⁿⁱᵗ - yⁱⁿⁱᵗ‖",
    "Two solutions stay within a constant times their first distance.",
    follows(
        [E > 0, L >= 0, k > 0, v >= 0, w >= 0, v <= M, w <= M, f <= L * E, p <= (v + w) * k * E],
        f + p <= (L + 2 * M * k) * E,
        f + p <= (L - 2 * M * k) * E,
        "½Ė ≤ L_F E + (‖v‖ + ‖w‖)E/(2η) ≤ (L_F + M/η)E, v and w being constraint forces of at most M",
        "(L_F − M/η)E",
    ),
    *GROWTH_OF_DISTANCE,
    also=("c1.one-sided",),
    rests_on=("c1.hypomonotone",),
)


@claim(
    "c1.start",
    "The model of discs has a unique solution from every start in ℝ^2N.",
    source="Corollary 1.33",
    quote="Then for all xⁱⁿⁱᵗ ∈ ℝ^2N and any T > 0, the system has a unique solution.",
    correction=Correction(
        "for all xⁱⁿⁱᵗ ∈ S, as in Theorem 1.31",
        Effect.CONCLUSION,
        (
            "the models of chapters 3 and 4: their start must not overlap, nor their state after a cell event, as it "
            "does (section 5)"
        ),
        why=(
            "N(S, x) = ∅ for x ∉ S by Definition 1.23, so a solution lies in S at almost all times and, being "
            "continuous, at t = 0; Theorem 1.31 has xⁱⁿⁱᵗ ∈ S"
        ),
        place=876,
    ),
    rests_on=("c1.prox-constant", "c1.existence", "c1.dependence"),
)
def _start() -> Evidence:
    """A solution is in S at almost all times, so at the start, too, as it is continuous."""
    out, within = (float(np.abs(apart(x) - x).max()) for x in (OVERLAPPING, APART))
    y = apart(np.random.default_rng(SEED).normal(size=(SAMPLES, 2, 2)))
    gap = float(np.linalg.norm(y[:, 1] - y[:, 0], axis=1).min()) - 1.0
    return Evidence(
        printed=(equal("discs that overlap by 0.2: distance from S, where solutions are,", out, 0.0, ROUNDING),),
        corrected=(
            equal("distance from S of discs that do not overlap", within, 0.0, ROUNDING),
            at_least(f"smallest gap of discs at {SAMPLES} projections, where normals exist", gap, 0.0, ROUNDING),
        ),
        seed=SEED,
    )


@claim(
    "c1.time-independent",
    "The feasible sets of the models do not depend on time.",
    source="section 4.6",
    quote="since we only need the result for time-independent sets, the following proof is simpler.",
    correction=Correction(
        (
            "S is constant between cell events, where the proof applies; by (3.4) and (3.8) of chapter 3 it jumps at "
            "them"
        ),
        Effect.PROOF,
        "the use of Theorem 1.31 in chapters 3 and 4, one interval between events after another",
        why=(
            "in chapter 3 the hard radius of a cell jumps when its mitosis begins (3.4), and a division adds a cell "
            "(3.7), (3.8), so S changes in time"
        ),
        place=884,
    ),
    chosen="a nucleus that two others touch when its mitosis begins",
)
def _time_independent() -> Evidence:
    between, jump = away(resting()), away(in_mitosis())
    return Evidence(
        printed=(at_most("distance from S(t⁺) of a state of S(t⁻) when a mitosis begins [μm]", jump, 0.0, TOL),),
        corrected=(
            at_most("distance of that state from S between events [μm]", between, 0.0, TOL),
            at_least("jump of S over that of the radius, 1.66 to 3.5 μm", jump / (GROWN - HARD), 0.5),
        ),
    )
