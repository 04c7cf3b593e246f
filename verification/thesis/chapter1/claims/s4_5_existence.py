"""Chapter 1, section 4.5: existence of solutions, their dependence on the start, and the catch-up scheme."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import numpy as np

import dincl
from verification.claims import Evidence, Verdict, at_least, at_most, equal, proved
from verification.formal.algebra import identity
from verification.formal.reals import implication
from verification.thesis.chapter1.cells import GROWN, HARD, TOL, away, in_mitosis, resting
from verification.thesis.chapter1.claims.s2_1_inclusions import growth_of_distance
from verification.thesis.chapter1.claims.s4_1_prox import nearest
from verification.thesis.chapter1.sets import Floats, apart, catch_up, falling
from verification.thesis.text.quoted import claim

SAMPLES, SEED = 300, 12
ROUNDING = 1e-12
# Half the step of a central difference of numbers that are right to rounding.
HALF = 1e-5
OVERLAPPING, APART = np.array([[0.0, 0.0], [0.8, 0.0]]), np.array([[0.0, 0.0], [1.3, 0.0]])


@claim(
    "c1.linear-growth",
    "A Lipschitz continuous force grows at most linearly.",
    "section 4.5, (A1), (A2)",
    Verdict.PROVED,
)
def _linear_growth() -> Evidence:
    """n = |F(x)|, n0 = |F(0)|, r = |x|."""
    return proved(
        implication(
            "‖F(x)‖ ≤ ‖F(0)‖ + L_F‖x‖ ≤ M_F(1 + ‖x‖) with M_F = max(L_F, ‖F(0)‖)",
            lambda s, n, n0, L, r, M: ([r >= 0, L >= 0, n <= n0 + L * r, M >= L, n0 <= M], n <= M * (1 + s * r)),
            "M_F(1 − ‖x‖)",
        )
    )


@claim(
    "c1.catch-up-normal",
    "A step of the catch-up scheme fulfils a discrete inclusion.",
    "after (1.39)",
    Verdict.PROVED,
)
def _catch_up_normal() -> Evidence:
    """x_(k+1) = P_S(y) with y = x_k + h F(x_k); the vector is y - x_(k+1)."""
    return proved(
        identity(
            "x_k − x_{k+1} + hF(x_k) = y − P_S(y) for y = x_k + hF(x_k)",
            lambda s, x, new, h, F: x - new + h * F - (x + s * h * F - new),
            "y = x_k − hF(x_k)",
        ),
        nearest(),
    )


def slide(t: Floats) -> Floats:
    """The exact solution of a disc that falls onto a fixed one of radius 1 in all and slides, (K, 2)."""
    exact = dincl.scenes.sliding_disc().exact
    return np.zeros((len(t), 2)) if exact is None else exact(t)[:, 0]


@claim(
    "c1.existence",
    "There is a solution, to which the catch-up scheme converges.",
    "Theorem 1.31",
    Verdict.NOT_REFUTED,
    chosen="a disc that slides over a fixed one, whose solution is known",
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
    "Lemma 1.32, (1.41)",
    Verdict.PROVED,
)
def _dependence() -> Evidence:
    """E = |x - y|^2, F has the constant L, and -N is hypomonotone by (1.28): p = -(v - w).(x - y), v, w forces <= M."""
    return proved(
        implication(
            "½Ė ≤ L_F E + (‖v‖ + ‖w‖)E/(2η) ≤ (L_F + M/η)E, v and w being constraint forces of at most M",
            lambda s, f, p, L, E, v, w, M, k: (
                [E > 0, L >= 0, k > 0, v >= 0, w >= 0, v <= M, w <= M, f <= L * E, p <= (v + w) * k * E],
                f + p <= (L + s * 2 * M * k) * E,
            ),
            "(L_F − M/η)E",
        ),
        *growth_of_distance(),
    )


@claim(
    "c1.start",
    "The model of discs has a solution from every start.",
    "Corollary 1.33",
    Verdict.CORRECTED,
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
    "section 4.6",
    Verdict.CORRECTED,
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
