"""Chapter 1, section 2: absolutely continuous functions, and the step inclusion of Example 1.9."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from verification.claims import Correction, Effect, Evidence, claim, equal
from verification.claims.formal.reals import follows, reals, solver_library
from verification.claims.formal.stated import argument, implication
from verification.thesis.chapter1.lemmas import sign_values

z3 = solver_library()
x, y, rate, t, c, h, k, d, q, value = reals("x y rate t c h k d q value")

# The start c of Example 1.9.
C = 0.75
# Ternary digits of Cantor's function, and a distance from the ends of the intervals where it is constant.
LEVELS, EDGE = 20, 1e-7
# Cells of [0, 1]; Cantor's function is constant on all but a part of length (2/3)^8 < 0.04 of them.
CELLS = 3**8


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


# On arrival at 0 the velocity is -1; the rest at 0 has the velocity 0.
_no_classical = implication(
    "c1.no-classical",
    "Example 1.9",
    "ẋ = -sign(x) with the convention sign(0) = 0. This equation has no classical solutions.",
    "ẋ = -sign(x) with sign(0) = 0 has no classical solution.",
    given=[rate == -1, value == 0],
    then=rate + value != 0,
    wrong=([rate == 0, value == 0], rate + value != 0),
    correction=Correction(
        "from x(0) = c ≠ 0 it has no classical solution on [0, T] with T ≥ |c|",
        Effect.PROOF,
        "nothing else: the example goes on with c > 0 and times beyond c",
        why="x = 0 for all times fulfils ẋ = -sign(x) with sign(0) = 0, and so does c - t for t < c",
        place=429,
    ),
)

# x' in -H(x), H = sign(x), and [-1, 1] at 0; h and k are values of H at x and y. Then the quotient q of max(c - t, 0)
# over a step h from t = c + d, both ends on one side of c or one of them at c.
PATH = [t >= 0, c >= 0, z3.If(t < c, x == c - t, x == 0)]
SOLVES = z3.If(x > 0, rate == -1, z3.And(x == 0, rate <= 1, rate >= -1))
VALUES = [*sign_values(x, h), *sign_values(y, k)]
QUOTIENT = [h > 0, x == z3.If(d < 0, -d, 0), y == z3.If(d + h < 0, -d - h, 0), q * h == y - x]
AFTER = z3.If(d >= 0, q == 0, q * q >= 0)

_step = argument(
    "c1.step",
    "Example 1.9",
    "It turns out that the unique solution is x(t) = max(c - t, 0).",
    "The unique solution of the step inclusion from c > 0 is max(c - t, 0).",
    follows(
        [*PATH, z3.If(t < c, rate == -1, rate == 0)],
        SOLVES,
        ([*PATH, z3.If(t < c, rate == 1, rate == 0)], SOLVES),
        "x = max(c − t, 0) has ẋ = −1 where x > 0 and ẋ = 0 ∈ [−1, 1] where x = 0",
        "max(c + t, 0)",
    ),
    follows(
        VALUES,
        (x - y) * (k - h) <= 0,
        (x - y) * (h - k) <= 0,
        "(x − y)(ẋ − ẏ) ≤ 0 for any two solutions, so there is one only",
        "ẋ ∈ +H(x)",
    ),
    follows(
        QUOTIENT,
        [z3.If(d + h <= 0, q == -1, q * q >= 0), AFTER],
        [z3.If(d + h <= 0, q == 1, q * q >= 0), AFTER],
        "the quotient is −1 for steps that end at c or before it, 0 for steps that begin at c or after it",
        "1 before c",
    ),
    also=("c1.kink",),
    rests_on=("c1.step-continuity", "c1.dependence"),
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
            "Cantor's function has the derivative 0 almost everywhere and is not constant; Lemma 1.7 asks that the "
            "function is the integral of its derivative"
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
