"""Chapter 1, section 2.1: one-sided Lipschitz continuity, and when solutions are unique."""

from __future__ import annotations

import numpy as np

from verification.claims import Correction, Effect, Evidence, at_least, claim, equal
from verification.claims.formal.algebra import library, vanishes
from verification.claims.formal.reals import follows, reals
from verification.claims.formal.stated import argument
from verification.thesis.chapter1.lemmas import sign_values

# h and k are values of sign at x and y, any of [-1, 1] at 0; (1.13) has the right side -h.
x, y, h, k = reals("x y h k")
VALUES = [*sign_values(x, h), *sign_values(y, k)]


def step_values(x: float) -> tuple[float, float]:
    """Return the least and the largest value of the right-hand side of (1.13)."""
    return (-1.0, 1.0) if x == 0 else (-np.sign(x), -np.sign(x))


_remark = argument(
    "c1.step-continuity",
    "Remark 1.14",
    "(v - w)(x - y) = (v + 1)(0 - y) ≤ 0 ≤ 2(x - y)²",
    "(1.13) is upper semicontinuous and one-sided Lipschitz.",
    follows(
        VALUES,
        (k - h) * (x - y) <= 0,
        (h - k) * (x - y) <= 0,
        "(v − w)(x − y) ≤ 0 ≤ 2(x − y)² for all values v, w of (1.13) at any x, y",
        "with +sign",
    ),
    follows(
        sign_values(x, h),
        [-h <= 1, -h >= -1],
        [-h <= 0.5, -h >= -0.5],
        "all values near 0 lie in [−1, 1], the value at 0",
        "in [−½, ½]",
    ),
    follows(
        [*VALUES, (y - x) * (y - x) < x * x],
        h == k,
        ([*VALUES, (y - x) * (y - x) < 4 * x * x], h == k),
        "and those at y with |y − x| < |x| are the value at x",
        "with |y − x| < 2|x|",
    ),
)


# Discs at -u, u and -w, w with unit vectors u, w at any angle: a normal of length s at the first pair, m at the other.
sp = library()
a, b, size, other = sp.symbols("a b s m", real=True)
u, w = (sp.Matrix([sp.cos(at), sp.sin(at)]) for at in (a, b))
first, second, normal = sp.Matrix([-u, u]), sp.Matrix([-w, w]), size * sp.Matrix([u, -u])
gap = normal - other * sp.Matrix([w, -w])
SLOPE, SQUARE = -normal.dot(first - second), size / 2 * (first - second).dot(first - second)
ALONG, ACROSS = 2 * (other - size * sp.cos(a - b)) ** 2, 2 * (size * sp.sin(a - b)) ** 2

_neither = argument(
    "c1.neither",
    "after Remark 1.15",
    "the multi-functions F considered will neither be upper semicontinuous nor one-sided Lipschitz continuous.",
    "The right-hand side of the model of discs is neither upper semicontinuous nor one-sided Lipschitz continuous.",
    vanishes(
        SLOPE - SQUARE,
        SLOPE + SQUARE,
        "two touching discs turned by any angle have the one-sided slope s/2, −n·(x − y) = (s/2)‖x − y‖², with a "
        "normal n ~ s, for every s: no constant bounds it",
        "slope −s/2",
    ),
    vanishes(
        gap.dot(gap) - ALONG - ACROSS,
        gap.dot(gap) - ALONG + ACROSS,
        "n is √2 s sin θ or more away from the other cone, |n − m|² = 2s² sin²θ + 2(m − s cos θ)²: unbounded",
        "−2s² sin²θ",
    ),
    rests_on=("c1.equivalent",),
    chosen="F = 0 and two discs",
)


def cones_from(least: float, most: float) -> int:
    """Count the forces f, eighths from -2 to 2, for which the values least ... most less f form a cone, as -N(S, x)."""
    forces = np.arange(-16, 17) / 8
    ends = np.stack([least - forces, most - forces])
    return int((((ends == 0) | np.isinf(ends)).all(axis=0)).sum())


@claim(
    "c1.generalise",
    "Theorem 1.31 and Lemma 1.32 generalise Theorems 1.11 and 1.13.",
    source="after Remark 1.15",
    quote="The main theorems of this chapter (Theorem 1.31 and Lemma 1.32) generalise Theorem 1.11 and Theorem 1.13.",
    correction=Correction(
        (
            "they carry existence and uniqueness over to F - N(S, ·) with a single-valued, Lipschitz continuous F; "
            "neither pair contains the other"
        ),
        Effect.PROOF,
        "a force with several values, as dry friction has, beside constraints: Theorem 1.31 does not cover it",
        why=(
            "Theorems 1.11 and 1.13 cover (1.13), whose value at 0 is [-1, 1]; F(x) - N(S, x) is a point plus a cone, "
            "in ℝ one point, a half-line or all of ℝ, so that Theorem 1.31 does not cover it"
        ),
        place=502,
    ),
    rests_on=("c1.step-continuity",),
)
def _generalise() -> Evidence:
    """In R, a value of F - N is a force plus {0}, a half-line or the line; that of (1.13) at 0, and at 0 of [0, oo)."""
    step, wall = cones_from(*step_values(0.0)), cones_from(0.0, np.inf)
    return Evidence(
        printed=(at_least("forces f for which the value [-1, 1] of (1.13) at 0 is f plus a cone", step, 1),),
        corrected=(equal("forces f for which the value [0, ∞) of -N([0, ∞), 0) is f plus a cone", wall, 1),),
    )
