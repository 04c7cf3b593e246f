"""Chapter 1, section 4.5: existence of solutions, their dependence on the start, and the catch-up scheme."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import math

import numpy as np

import dincl
from verification.claims import Correction, Effect, claim
from verification.evidence import Evidence, Kind, at_least, at_most, equal
from verification.thesis.chapter1.cells import GROWN, HARD, TOL, away, in_mitosis, resting
from verification.thesis.chapter1.sets import Floats, apart, catch_up, falling, outside

SAMPLES, SEED = 300, 12
ROUNDING = 1e-12
# Half the step of a central difference of numbers that are right to rounding.
HALF = 1e-5
MATRIX, SHIFT = np.array([[0.5, -1.0], [0.7, 0.2]]), np.array([0.3, -0.4])
OVERLAPPING, APART = np.array([[0.0, 0.0], [0.8, 0.0]]), np.array([[0.0, 0.0], [1.3, 0.0]])


def affine(x: Floats) -> Floats:
    """A force with the Lipschitz constant ‖MATRIX‖ + 1; x of shape (..., 2)."""
    return np.asarray(x @ MATRIX.T + np.sin(x) + SHIFT)


@claim(
    "c1.linear-growth",
    "A Lipschitz continuous force grows at most linearly.",
    source="section 4.5, (A1), (A2)",
    quote="We note that Lipschitz continuity implies that the function grows at most linearly.",
    recorded=Kind.NOT_REFUTED,
    tried_on="one force in the plane",
)
def _linear_growth() -> Evidence:
    x = np.random.default_rng(SEED).normal(size=(SAMPLES, 2)) * np.logspace(-2, 4, SAMPLES)[:, None]
    constant = max(float(np.linalg.norm(MATRIX, 2)) + 1, float(np.linalg.norm(affine(np.zeros(2)))))
    worst = float((np.linalg.norm(affine(x), axis=1) / (constant * (1 + np.linalg.norm(x, axis=1)))).max())
    return Evidence(
        f"F(x) = Mx + sin(x) + b, M_F = max(L_F, ‖F(0)‖): ‖F(x)‖ is at most {worst:.3f} M_F(1 + ‖x‖) at {SAMPLES} "
        "points up to 10⁴ away.",
        printed=(at_most("‖F‖ over M_F(1 + ‖x‖)", worst, 1.0),),
        seed=SEED,
    )


@claim(
    "c1.catch-up-normal",
    "A step of the catch-up scheme fulfils a discrete inclusion.",
    source="after (1.39)",
    quote="x_k - x_{k+1} + hF(x_k) ∈ N(S, x_{k+1})",
    recorded=Kind.NOT_REFUTED,
    tried_on="a point that slides over a disc",
)
def _catch_up_normal() -> Evidence:
    """x_k - x_{k+1} + h F(x_k) is tried as a proximal normal at x_{k+1}, and so is its negative."""
    h, start = 0.02, np.array([[0.3, 1.2]])
    path = catch_up(start, falling, h, 60)[:, 0]
    n = (path[:-1] - path[1:] + h * falling(path[:-1])) / h
    pushed = np.linalg.norm(n, axis=1) > ROUNDING
    missed, turned = (np.abs(outside(path[1:] + sign * 0.1 * n) - path[1:]).max(axis=1)[pushed] for sign in (1, -1))
    return Evidence(
        f"A point that falls onto the unit disc and slides, {int(pushed.sum())} steps with contact: with "
        f"n = (x_k - x_(k+1))/h + F(x_k), P_S(x_(k+1) + n/10) misses x_(k+1) by {missed.max():.0e}; with -n by up to "
        f"{turned.max():.2f}.",
        printed=(
            at_most("|P_S(x + n/10) - x|", float(missed.max()), 1e-9),
            at_least("steps with contact", int(pushed.sum()), 10),
        ),
    )


def slide(t: Floats) -> Floats:
    """The exact solution of a disc that falls onto a fixed one of radius 1 in all and slides, (K, 2)."""
    exact = dincl.scenes.sliding_disc().exact
    return np.zeros((len(t), 2)) if exact is None else exact(t)[:, 0]


@claim(
    "c1.existence",
    "There is a solution, to which the catch-up scheme converges.",
    source="Theorem 1.31",
    quote="the system has an absolutely continuous solution x : [0, T] → ℝ^d.",
    chosen="a disc that slides over a fixed one, whose solution is known",
    recorded=Kind.NOT_REFUTED,
    tried_on="a point that slides over a disc",
)
def _existence() -> Evidence:
    """dist(x' - F, -N(S, x)) of the exact solution, and the error of catch-up at t = 2."""
    times = np.array([0.3, 0.8, 1.3, 2.0, 2.8])
    x, velocity = slide(times), (slide(times + HALF) - slide(times - HALF)) / (2 * HALF)
    pull, unit = velocity - falling(x), x / np.linalg.norm(x, axis=1, keepdims=True)
    touching = np.linalg.norm(x, axis=1) < 1 + 1e-9
    along = np.where(touching, np.maximum((pull * unit).sum(axis=1), 0.0), 0.0)
    left = float(np.linalg.norm(pull - along[:, None] * unit, axis=1).max())
    start = slide(np.zeros(1))
    errors = [float(np.linalg.norm(catch_up(start, falling, 2.0 / n, n)[-1, 0] - x[3])) for n in (200, 400, 800)]
    return Evidence(
        f"A point that falls onto a disc, slides and leaves it: ẋ - F is in -N(S, x) to {left:.0e} at five times, and "
        f"catch-up comes to the solution, errors {errors[0]:.1e}, {errors[1]:.1e}, {errors[2]:.1e} at t = 2.",
        printed=(
            at_most("distance of ẋ - F from -N", left, 0.0, 1e-6),
            at_most("error, h/4 over h", errors[2] / errors[0], 0.5),
        ),
    )


@claim(
    "c1.dependence",
    "The distance of two solutions stays within a factor.",
    source="Lemma 1.32, (1.41)",
    quote="there exists a constant a > 0 such that for all t ∈ [0, T] ‖x(t) - y(t)‖ ≤ a ‖xⁱⁿⁱᵗ - yⁱⁿⁱᵗ‖",
    chosen="points that slide over a fixed disc",
    recorded=Kind.NOT_REFUTED,
    tried_on="points that slide over a disc",
)
def _dependence() -> Evidence:
    """Starts near the top of the disc, from where paths part fastest: L_F = 0, |v| <= 1, eta = 1."""
    angles = 0.01 + np.array([0.0, 1e-2, 1e-4, 1e-6])
    path = catch_up(np.stack([np.sin(angles), np.cos(angles)], axis=1), falling, 1e-3, 1000)
    grown = np.linalg.norm(path[-1, 1:] - path[-1, 0], axis=1) / np.linalg.norm(path[0, 1:] - path[0, 0], axis=1)
    return Evidence(
        f"Points beside the top of the unit disc, 10⁻², 10⁻⁴, 10⁻⁶ apart: after a time of 1 the distance is "
        f"{grown[0]:.4f}, {grown[1]:.4f}, {grown[2]:.4f} times as large; a = exp((L_F + 1/η) T) = {math.e:.4f} serves.",
        printed=(at_most("growth of the distance over a", float(grown.max()) / math.e, 1.0, 0.01),),
    )


@claim(
    "c1.start",
    "The model of discs has a solution from every start.",
    source="Corollary 1.33",
    quote="Then for all xⁱⁿⁱᵗ ∈ ℝ^2N and any T > 0, the system has a unique solution.",
    recorded=Kind.CORRECTED,
    correction=Correction(
        "for all xⁱⁿⁱᵗ ∈ S, as in Theorem 1.31",
        Effect.CONCLUSION,
        "the models of chapters 3 and 4: their start must not overlap, nor their state after a cell event, as it "
        "does (section 5)",
        why=(
            "N(S, x) = ∅ for x ∉ S by Definition 1.23, so a solution lies in S at almost all times and, being "
            "continuous, at t = 0; Theorem 1.31 has xⁱⁿⁱᵗ ∈ S"
        ),
        place=876,
    ),
)
def _start() -> Evidence:
    """A solution is in S at almost all times, so at the start, too, as it is continuous."""
    off = {name: float(np.abs(apart(x) - x).max()) for name, x in (("in", APART), ("out", OVERLAPPING))}
    y = apart(np.random.default_rng(SEED).normal(size=(SAMPLES, 2, 2)))
    gap = float(np.linalg.norm(y[:, 1] - y[:, 0], axis=1).min()) - 1.0
    return Evidence(
        f"No point of P_S overlaps (smallest gap of {SAMPLES} projections {gap:.0e}), so N(S, x) = ∅ for x ∉ S, and a "
        f"solution is in S at all times. Discs that overlap by 0.2 are {off['out']:.1f} from S: nothing starts there.",
        printed=(equal("distance of an overlapping xⁱⁿⁱᵗ from S", off["out"], 0.0, ROUNDING),),
        corrected=(
            equal("distance of xⁱⁿⁱᵗ ∈ S from S", off["in"], 0.0, ROUNDING),
            at_least("smallest gap of points with normals", gap, 0.0, ROUNDING),
        ),
        seed=SEED,
    )


@claim(
    "c1.time-independent",
    "The feasible sets of the models that the theorem is for do not depend on time.",
    source="section 4.6",
    quote="since we only need the result for time-independent sets, the following proof is simpler.",
    recorded=Kind.CORRECTED,
    correction=Correction(
        "S is constant between cell events, where the proof applies; by (3.4) and (3.8) of chapter 3 it jumps at them",
        Effect.PROOF,
        "the use of Theorem 1.31 in chapters 3 and 4, one interval between events after another",
        why=(
            "in chapter 3 the hard radius of a cell jumps when its mitosis begins (3.4), and a division adds a "
            "cell (3.7), (3.8), so S changes in time"
        ),
        place=884,
    ),
    chosen="a nucleus that two others touch when its mitosis begins",
)
def _time_independent() -> Evidence:
    """A state of S(t-) when a nucleus among its neighbours begins mitosis."""
    between, jump = away(resting()), away(in_mitosis())
    return Evidence(
        f"By (3.4) a radius jumps from {HARD:g} to {GROWN:g} μm: a state in which neighbours touch that nucleus is "
        f"{between:g} μm from S(t⁻) and {jump:.2f} μm from S(t⁺), so S is neither constant nor Lipschitz in t as in "
        "(1.18).",
        printed=(at_most("distance of a state of S(t⁻) from S(t⁺) [μm]", jump, 0.0, TOL),),
        corrected=(
            at_most("distance from S between events [μm]", between, 0.0, TOL),
            at_least("jump of S, over the jump of the radius", jump / (GROWN - HARD), 0.5),
        ),
    )
