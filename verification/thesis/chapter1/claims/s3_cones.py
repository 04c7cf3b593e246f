"""Chapter 1, section 3: normal cones of convex sets, and convex sets that move."""

from __future__ import annotations

import numpy as np

from verification.claims import Correction, Effect, Evidence, Verdict, at_most, claim, proved, put_right
from verification.formal.reals import implication, solver_library
from verification.thesis.chapter1.sets import ROUNDING


@claim(
    "c1.outside",
    "Outside a convex set its normal cone is empty.",
    source="after Definition 1.16",
    quote="If x ∉ C then N_C(x) = ∅.",
    correction=Correction(
        "it is empty if Definition 1.16 asks for x ∈ C besides; as printed N_C(x) contains at least 0",
        Effect.MODEL,
        "(1.15) and (1.16): as printed they do not keep a point in C, and 0 is a solution from every start",
        why=("v = 0 fulfils v·(y − x) ≤ 0 for every x, also outside of C, and the definition does not ask for x ∈ C"),
        place=536,
    ),
)
def _outside() -> Evidence:
    """C = [0, 1] and x > 1: v.(y - x) <= 0 for all y of C if it is so at both ends."""
    return put_right(
        implication(
            "no v has v(y − x) ≤ 0 for all y ∈ [0, 1] and x ∈ [0, 1], where x > 1",
            lambda s, v, x: (
                [x > 1],
                solver_library().Not(solver_library().And(s * x <= 1, v * (0 - x) <= 0, v * (1 - x) <= 0)),
            ),
            "N_C(x) = ∅ without x ∈ C in Definition 1.16, which v = 0 fulfils everywhere",
            0,
        )
    )


@claim(
    "c1.monotone",
    "Normals v at x, w at y of a convex set have (v - w)·(x - y) ≤ 0.",
    source="after (1.15)",
    quote="(v - w)·(x - y) ≤ 0 for all v ∈ N_C(x), w ∈ N_C(y)",
    correction=Correction(
        "(v - w)·(x - y) ≥ 0",
        Effect.PROOF,
        "the uniqueness of solutions of (1.15), which stands: the right-hand side has -N_C",
        why="v·(y − x) ≤ 0 and w·(x − y) ≤ 0 by Definition 1.16; their sum is −(v − w)·(x − y) ≤ 0",
        place=559,
    ),
)
def _monotone() -> Evidence:
    """p = v.(y - x) <= 0 and q = w.(x - y) <= 0 for v in N_C(x), w in N_C(y)."""
    return put_right(
        implication(
            "(v − w)·(x − y) = −v·(y − x) − w·(x − y) ≥ 0",
            lambda s, p, q: ([p <= 0, q <= 0], s * (-p - q) >= 0),
            "(v − w)·(x − y) ≤ 0",
        )
    )


@claim(
    "c1.convex-unique",
    "Without a force the solution of the inclusion with the normal cone of a convex set is unique.",
    source="after (1.15)",
    quote="in the case F = 0, Theorem 1.13 implies uniqueness of solutions of (1.15).",
    recorded=Verdict.PROVED,
    rests_on=("c1.dependence", "c1.monotone"),
    chosen="a set that moves, as in (1.16): in one that stands still nothing moves without F",
)
def _convex_unique() -> Evidence:
    """v in N_C(x), w in N_C(y), x' = -v, y' = -w: p = v.(y - x), q = w.(x - y); C may move."""
    return proved(
        implication(
            "½ d/dt ‖x − y‖² = −(v − w)·(x − y) = v·(y − x) + w·(x − y) ≤ 0 for ẋ = −v, ẏ = −w and any convex C(t)",
            lambda s, p, q: ([p <= 0, q <= 0], s * (p + q) <= 0),
            "ẋ = v, ẏ = w",
        )
    )


@claim(
    "c1.sweeping",
    "The speed of the sweeping process is at most the Lipschitz constant L of the moving set.",
    source="Theorem 1.18",
    quote="For almost every t ∈ [0, T] we have ‖ẋ(t)‖ ≤ L.",
    recorded=Verdict.PROVED,
    rests_on=("c1.sweeping-unique",),
    chosen="a given start, see c1.sweeping-unique",
)
def _sweeping() -> Evidence:
    """n = -x'/|x'| is normal to C(t). A point of C(t) is within L h of x(t - h) = x - h x' + o(h): n.(z - x) <= 0.

    So h |x'| - L h b <= o(h), b <= 1 being n times the direction to z; v = |x'| in the limit h -> 0.
    """
    return proved(
        implication(
            "‖ẋ‖ ≤ L n·b and ‖b‖ ≤ 1 give ‖ẋ‖ ≤ L, for any convex sets that move with the constant L",
            lambda s, v, b, L: ([L > 0, b <= 1, b >= -1, v <= L * b], v <= s * L),
            "‖ẋ‖ ≤ L/2",
            0.5,
        )
    )


def swept_from(start: float, h: float, end: float) -> float:
    """Sweep a point from ``start`` by catch-up with exact projections; C(t) = [sin t, sin t + 1/2]."""
    x = start
    for t in h * np.arange(1, round(end / h) + 1):
        x = min(max(x, np.sin(t)), np.sin(t) + 0.5)
    return float(x)


@claim(
    "c1.sweeping-unique",
    "The sweeping process with x(0) ∈ C(0) has a unique solution.",
    source="Theorem 1.18, (1.16), (1.17)",
    quote="(1.17) x(0) ∈ C(0) … Then there is an unique solution x ∈ AC([0, T], ℝ^d) solving (1.16) and (1.17).",
    correction=Correction(
        "for each xⁱⁿⁱᵗ ∈ C(0) there is a unique solution with x(0) = xⁱⁿⁱᵗ",
        Effect.MODEL,
        "(1.17), which should fix the start; Theorem 1.31 has x(0) = xⁱⁿⁱᵗ",
        why="(1.17) only asks for a start in C(0), and different starts in it have different solutions",
        place=573,
    ),
    tried_on="C(t) = [sin t, sin t + 1/2]",
)
def _sweeping_unique() -> Evidence:
    """Two starts in C(0), and one start with two steps."""
    low, high = (swept_from(start, 1e-3, 0.2) for start in (0.0, 0.5))
    same = abs(swept_from(0.0, 5e-4, 0.2) - low)
    return Evidence(
        printed=(
            at_most("distance at t = 0.2 of the solutions from 0 and 1/2, both in C(0)", high - low, 0.0, ROUNDING),
        ),
        corrected=(at_most("change of the solution from 0 when the step is halved, t = 0.2,", same, 0.0, ROUNDING),),
    )
