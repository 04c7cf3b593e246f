"""Chapter 1, section 2: absolutely continuous functions, and the step inclusion of Example 1.9."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

import dincl
from verification.claims import Correction, Effect, Evidence, Verdict, claim, equal, proved
from verification.formal.reals import implication, solver_library
from verification.thesis.chapter1.lemmas import sign_values
from verification.thesis.chapter1.sets import ROUNDING

# The start c of Example 1.9 where quotients are formed, and their step; both exact in binary.
C, STEP = 0.75, 2.0**-10
# Ternary digits of Cantor's function, and a distance from the ends of the intervals where it is constant.
LEVELS, EDGE = 20, 1e-7
# Cells of [0, 1]; Cantor's function is constant on all but a part of length (2/3)^8 < SHORT of them.
CELLS, SHORT = 3**8, 0.04


def cantor(x: float) -> float:
    """Return Cantor's function, to LEVELS ternary digits."""
    value, weight = 0.0, 0.5
    for _ in range(LEVELS):
        x *= 3
        if 1 <= x <= 2:
            return value + weight
        if x > 2:
            value, x = value + weight, x - 2
        weight /= 2
    return value


def lost_rise(f: Callable[[float], float]) -> float:
    """Return f(1) - f(0) less the integral of the derivative, as in Lemma 1.7, by the midpoint rule."""
    middles = (np.arange(CELLS) + 0.5) / CELLS
    slopes = [(f(x + EDGE) - f(x - EDGE)) / (2 * EDGE) for x in middles]
    return float(f(1.0) - f(0.0) - np.mean(slopes))


def speed(t: float, h: float) -> float:
    """Return (x(t + h) - x(t))/h for a numerical solution of (1.13) from c."""
    problem = dincl.Problem([[C]], lambda _t, x: 0 * x - 1.0, [dincl.HalfSpace(normal=(1,))])
    first, last = sorted((t, t + h))
    path = dincl.solve(problem, dincl.PBD(dt=STEP), t=[first, last])
    return float((path.x[1, 0, 0] - path.x[0, 0, 0]) / (last - first))


def unsolved(c: float, end: float) -> float:
    """Return the largest |x' + sign(x)| of x = max(c - t, 0) at times of [0, end), by quotients."""
    times = np.arange(0.0, end, STEP)
    x, later = np.maximum(c - times, 0.0), np.maximum(c - times - STEP, 0.0)
    return float(np.abs((later - x) / STEP + np.sign(x)).max())


@claim(
    "c1.no-classical",
    "ẋ = -sign(x) with sign(0) = 0 has no classical solution.",
    source="Example 1.9",
    quote="ẋ = -sign(x) with the convention sign(0) = 0. This equation has no classical solutions.",
    correction=Correction(
        "from x(0) = c ≠ 0 it has no classical solution on [0, T] with T ≥ |c|",
        Effect.PROOF,
        "nothing else: the example goes on with c > 0 and times beyond c",
        why="x = 0 for all times fulfils ẋ = -sign(x) with sign(0) = 0, and so does c - t for t < c",
        place=429,
    ),
)
def _no_classical() -> Evidence:
    """Two classical solutions by their residuals, and the velocity of the third, that comes to 0."""
    left = [unsolved(0.0, 1.0), unsolved(C, C / 2)]
    off = speed(C, -STEP) - (0.0 - float(np.sign(0.0)))
    found = sum(one <= ROUNDING for one in left)
    return Evidence(
        printed=(equal(f"c = {C}: classical solutions among x = 0 and x = c - t, t < c/2,", found, 0),),
        corrected=(equal("velocity on arrival at 0 less -sign(0), at t = c", off, -1.0, ROUNDING),),
    )


@claim(
    "c1.step",
    "The unique solution of the step inclusion from c > 0 is max(c - t, 0).",
    source="Example 1.9",
    quote="It turns out that the unique solution is x(t) = max(c - t, 0).",
    recorded=Verdict.PROVED,
    rests_on=("c1.step-continuity", "c1.dependence"),
)
def _step() -> Evidence:
    """x' in -H(x), H = sign(x), and [-1, 1] at 0; h and k are values of H at x and y."""
    z3 = solver_library()
    return proved(
        implication(
            "x = max(c − t, 0) has ẋ = −1 where x > 0 and ẋ = 0 ∈ [−1, 1] where x = 0",
            lambda s, x, rate, t, c: (
                [t >= 0, c >= 0, z3.If(t < c, x == c - t, x == 0), z3.If(t < c, rate == -s, rate == 0)],
                z3.If(x > 0, rate == -1, z3.And(x == 0, rate <= 1, rate >= -1)),
            ),
            "max(c + t, 0)",
        ),
        implication(
            "(x − y)(ẋ − ẏ) ≤ 0 for any two solutions, so there is one only",
            lambda s, x, y, h, k: ([*sign_values(x, h), *sign_values(y, k)], (x - y) * (-s * h + s * k) <= 0),
            "ẋ ∈ +H(x)",
        ),
    )


@claim(
    "c1.kink",
    "The solution of the step inclusion has the derivative -1 before t = c, 0 after it and none at t = c.",
    source="Example 1.9",
    quote="the derivative does not exist at t = c … for t ≠ c is equal to -1_{t < c}(t)",
    recorded=Verdict.PROVED,
    rests_on=("c1.step",),
)
def _kink() -> Evidence:
    """The quotient q of max(c - t, 0) over a step h from t = c + d, both ends on one side of c or one of them at c."""
    z3 = solver_library()
    return proved(
        implication(
            "the quotient is −1 for steps that end at c or before it, 0 for steps that begin at c or after it",
            lambda s, d, h, q, x, y: (
                [h > 0, x == z3.If(d < 0, -d, 0), y == z3.If(d + h < 0, -d - h, 0), q * h == y - x],
                [z3.If(d + h <= 0, q == -s, q * q >= 0), z3.If(d >= 0, q == 0, q * q >= 0)],
            ),
            "1 before c",
        )
    )


@claim(
    "c1.almost-everywhere",
    "A function with a derivative almost everywhere is absolutely continuous.",
    source="Example 1.9",
    quote=(
        "The existence of an almost everywhere defined derivative proves that x is absolutely continuous by Lemma 1.7."
    ),
    correction=Correction(
        "x is absolutely continuous by Lemma 1.7, as it is the integral of its derivative",
        Effect.PROOF,
        "nothing else: max(c - t, 0) is absolutely continuous",
        why=(
            "Cantor's function has the derivative 0 almost everywhere and is not constant; Lemma 1.7 asks that "
            "the function is the integral of its derivative"
        ),
        place=441,
    ),
    rests_on=("c1.step",),
)
def _almost_everywhere() -> Evidence:
    lost, ours = lost_rise(cantor), lost_rise(lambda t: max(C - t, 0.0))
    return Evidence(
        printed=(equal("rise less integral of the derivative, Cantor's function", lost, 0.0, 0.05),),
        corrected=(equal(f"c = {C}: rise less integral of the derivative, max(c - t, 0)", ours, 0.0, 1e-3),),
    )
