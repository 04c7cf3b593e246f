"""Conclusions of the thesis: what a proof of convergence of PBD would rest on."""

from __future__ import annotations

import math

import numpy as np

import dincl
from verification.claims import Evidence, at_least, at_most, claim
from verification.thesis.chapter1.sets import RADIUS, Floats, points_of_step

SEED, SAMPLES = 61, 30
TOL = 1e-10
# States of touching discs, in units of the radius: a row, a triangle, a rhombus.
TOUCHING = (
    np.array([[0.0, 0.0], [2.0, 0.0], [4.0, 0.0], [6.0, 0.0]]),
    np.array([[0.0, 0.0], [2.0, 0.0], [1.0, math.sqrt(3)]]),
    np.array([[0.0, 0.0], [2.0, 0.0], [1.0, math.sqrt(3)], [3.0, math.sqrt(3)]]),
)


def swept(x: Floats) -> Floats:
    """Return P_{S_M} ... P_{S_1}(x)."""
    return points_of_step(x, 0 * x, 0.0)[-1]


def ratios(problem: dincl.Problem, x: Floats) -> tuple[float, float, int]:
    """Return max_j dist(x, S_j)/dist(x, S), what one sweep leaves of the way to P_S(x), and M."""
    nearest = dincl.project(problem, x, dincl.Daqp(tol=TOL)).point
    far = float(np.linalg.norm(nearest - x))
    worst = problem.violation(0.0, x) / math.sqrt(2)
    return worst / far, float(np.linalg.norm(nearest - swept(x))) / far, math.comb(len(x), 2)


@claim(
    "c6.contraction",
    "Near S a sweep of projections reduces the distance to the projection onto S by a factor below 1.",
    source="Ideas for proving convergence of PBD",
    quote="max_j dist(x, S_j) ≥ α dist(x, S) … c ∈ (0, 1): ‖P_S(x) − P_{S_M} ∘ … ∘ P_{S_1}(x)‖ ≤ c ‖P_S(x) − x‖",
    tried_on="3 or 4 discs in rows, triangles and rhombi, disturbed by a hundredth",
    chosen="rows, triangles and rhombi of discs, disturbed by a hundredth",
)
def _contraction() -> Evidence:
    rng = np.random.default_rng(SEED)
    found = []
    for state in TOUCHING:
        problem = dincl.Problem(RADIUS * state, lambda _t, x: 0 * x, [dincl.NonOverlap(RADIUS)])
        disturbed = RADIUS * state + 0.01 * rng.normal(size=(SAMPLES, *state.shape))
        found += [ratios(problem, x) for x in disturbed if problem.violation(0.0, x) > 0]
    alpha, left = (float(value) for value in (min(a for a, _, _ in found), max(c for _, c, _ in found)))
    excess = max(c - math.sqrt(1 - a**2 / count) for a, c, count in found)
    return Evidence(
        printed=(
            at_least(f"least α = max_j dist(x, S_j)/dist(x, S) of {len(found)} states", alpha, 0.1),
            at_most("largest c, what a sweep leaves of the way to P_S(x)", left, 0.99),
            at_most("c − √(1 − α²/M), 0 at most for convex sets", excess, 0.0, 0.02),
        ),
        seed=SEED,
    )
