"""Chapter 1, section 3: normal cones of convex sets, and convex sets that move."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import numpy as np

from verification.claims import Evidence, Verdict, at_most, equal, proved, put_right
from verification.formal.reals import implication
from verification.thesis.chapter1.claims.s1_2_constraints import indicator
from verification.thesis.chapter1.sets import PLACES, SLOPES, subgradients
from verification.thesis.text.quoted import claim

SEED = 11
ROUNDING = 1e-12


@claim(
    "c1.convex-cone",
    "Normal cones are convex cones, and at inner points they contain 0 alone.",
    "after Definition 1.16",
    Verdict.PROVED,
)
def _convex_cone() -> Evidence:
    """p = v.(y - x) and q = w.(y - x) for a point y of C; at an inner point y = x + t v is in C for a t > 0."""
    return proved(
        implication(
            "v·(y − x) ≤ 0 and w·(y − x) ≤ 0 give (αv + w)·(y − x) ≤ 0 for α > 0",
            lambda s, a, p, q: ([a > 0, p <= 0, q <= 0], s * a * p + q <= 0),
            "−αv + w",
        ),
        implication(
            "v·(tv) ≤ 0 with t > 0 gives v = 0",
            lambda s, t, square: ([t * s > 0, square >= 0, t * square <= 0], square == 0),
            "with t < 0",
        ),
    )


@claim(
    "c1.outside",
    "Outside of a convex set its normal cone is empty.",
    "after Definition 1.16",
    Verdict.CORRECTED,
)
def _outside() -> Evidence:
    """C = [0, 1], x = 3/2: Definition 1.16 as printed, and with x in C, which is (1.9) for the indicator function."""
    y = PLACES[np.isfinite(indicator(PLACES))]
    inside = SLOPES[(SLOPES[:, None] * (y - 1.5) <= 0).all(axis=1)]
    right = subgradients(indicator, 1.5)
    return Evidence(
        f"C = [0, 1] and x = 3/2: all slopes v ≥ {inside.min():g} fulfil Definition 1.16 as printed, so N_C(x) ≠ ∅ and "
        "(1.15) lets a point rest outside of C. With x ∈ C in the definition, as in (1.9) for I_C, there is none.",
        printed=(equal("slopes in N_C(3/2) as defined", inside.size, 0),),
        corrected=(equal("slopes in N_C(3/2) with x ∈ C", right.size, 0),),
    )


@claim(
    "c1.monotone",
    "The sign of the product of differences of normals and of points of a convex set.",
    "after (1.15)",
    Verdict.CORRECTED,
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
    "Solutions that only the normals of a convex set move do not come apart.",
    "after (1.15)",
    Verdict.PROVED,
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
    "A swept point is not faster than the set that sweeps it.",
    "Theorem 1.18",
    Verdict.PROVED,
    chosen="C(t) = [sin t, sin t + 1/2]; a given start, see c1.sweeping-unique",
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
    """Where C(t) has a point from ``start``, by catch-up with exact projections; C(t) = [sin t, sin t + 1/2]."""
    x = start
    for t in h * np.arange(1, round(end / h) + 1):
        x = min(max(x, np.sin(t)), np.sin(t) + 0.5)
    return float(x)


@claim(
    "c1.sweeping-unique",
    "The sweeping process has one solution.",
    "Theorem 1.18, (1.16), (1.17)",
    Verdict.CORRECTED,
    tried_on="C(t) = [sin t, sin t + 1/2]",
)
def _sweeping_unique() -> Evidence:
    """Two starts in C(0), and one start with two steps."""
    at, (low, high) = 0.2, (swept_from(start, 1e-3, 0.2) for start in (0.0, 0.5))
    same = abs(swept_from(0.0, 5e-4, at) - low)
    return Evidence(
        f"C(t) = [sin t, sin t + 1/2], starts 0 and 1/2, both in C(0): at t = {at:g} their solutions are "
        f"{high - low:.3f} apart; from one start steps of 10⁻³ and half of it lead to the same place to {same:.0e}.",
        printed=(at_most("distance of two solutions of (1.16), (1.17)", high - low, 0.0, ROUNDING),),
        corrected=(at_most("distance of the solutions from one start", same, 0.0, ROUNDING),),
    )
