"""Chapter 1, section 2.1: one-sided Lipschitz continuity, and when solutions are unique."""

from __future__ import annotations

import numpy as np

from verification.claims import Correction, Effect, Evidence, Verdict, at_least, claim, equal, proved, put_right
from verification.formal.algebra import identity, library
from verification.formal.reals import implication
from verification.thesis.chapter1.lemmas import sign_values


def step_values(x: float) -> tuple[float, float]:
    """Return the least and the largest value of the right-hand side of (1.13)."""
    return (-1.0, 1.0) if x == 0 else (-np.sign(x), -np.sign(x))


@claim(
    "c1.step-continuity",
    "(1.13) is upper semicontinuous and one-sided Lipschitz.",
    source="Remark 1.14",
    quote="(v - w)(x - y) = (v + 1)(0 - y) ≤ 0 ≤ 2(x - y)²",
    recorded=Verdict.PROVED,
)
def _remark() -> Evidence:
    """h and k are values of sign at x and y, any of [-1, 1] at 0; (1.13) has the right side -h."""
    return proved(
        implication(
            "(v − w)(x − y) ≤ 0 ≤ 2(x − y)² for all values v, w of (1.13) at any x, y",
            lambda s, x, y, h, k: ([*sign_values(x, h), *sign_values(y, k)], s * (k - h) * (x - y) <= 0),
            "with +sign",
        ),
        implication(
            "all values near 0 lie in [−1, 1], the value at 0",
            lambda s, x, h: (sign_values(x, h), [-h <= s, -h >= -s]),
            "in [−½, ½]",
            0.5,
        ),
        implication(
            "and those at y with |y − x| < |x| are the value at x",
            lambda s, x, y, h, k: ([*sign_values(x, h), *sign_values(y, k), (y - x) * (y - x) < s * x * x], h == k),
            "with |y − x| < 2|x|",
            4,
        ),
    )


@claim(
    "c1.monotone-maps",
    "The set-valued sign function is a monotone map, that is one-sided Lipschitz continuous with L = 0.",
    source="Remark 1.15",
    quote=(
        "we actually showed a stronger property for the sign function, namely that it is a monotone map … with L = 0."
    ),
    correction=Correction(
        ("-sign is one-sided Lipschitz with L = 0; sign is not for any L, as the remark says in its next sentence"),
        Effect.PROOF,
        "the remark itself; Theorem 1.13 is applied to -sign",
        why=(
            "Remark 1.14 is about −sign, and the next sentence says that sign is neither monotone nor one-sided "
            "Lipschitz: for y → 0 the quotient of sign grows like 1/|y|"
        ),
        place=498,
    ),
    rests_on=("c1.step-continuity",),
)
def _monotone_maps() -> Evidence:
    """h and k are values of sign at x and y, any of [-1, 1] at 0."""
    monotone = implication(
        "(v − w)(x − y) ≤ 0 for all values v, w of −sign at any x, y",
        lambda s, x, y, h, k: ([*sign_values(x, h), *sign_values(y, k)], s * (k - h) * (x - y) <= 0),
        "(v − w)(x − y) ≤ 0 for all values of sign",
    )
    steep = implication(
        "for every L ≥ 0 the values 1 and −1 of sign at ±e, e = 1/(L + 1), have 2 · 2e > L(2e)²",
        lambda s, L, e: ([L >= 0, e * (L + 1) == 1], s * 2 * 2 * e > L * (2 * e) * (2 * e)),
        "the same for −sign",
    )
    return Evidence(printed=put_right(monotone).printed, corrected=(monotone, steep))


@claim(
    "c1.neither",
    ("The right-hand side of the model of discs is neither upper semicontinuous nor one-sided Lipschitz continuous."),
    source="after Remark 1.15",
    quote=("the multi-functions F considered will neither be upper semicontinuous nor one-sided Lipschitz continuous."),
    recorded=Verdict.PROVED,
    rests_on=("c1.equivalent",),
    chosen="F = 0 and two discs",
)
def _neither() -> Evidence:
    """Discs at -e, e and -f, f with unit vectors e, f at any angle: a normal of length s at the first pair."""
    sp = library()
    a, b, size, other = sp.symbols("a b s m", real=True)
    e, f = (sp.Matrix([sp.cos(at), sp.sin(at)]) for at in (a, b))
    x, y, normal = sp.Matrix([-e, e]), sp.Matrix([-f, f]), size * sp.Matrix([e, -e])
    gap = normal - other * sp.Matrix([f, -f])
    return proved(
        identity(
            "two touching discs turned by any angle have the one-sided slope s/2, −n·(x − y) = (s/2)‖x − y‖², "
            "with a normal n ~ s, for every s: no constant bounds it",
            lambda s: -normal.dot(x - y) - s * size / 2 * (x - y).dot(x - y),
            "slope −s/2",
        ),
        identity(
            "n is √2 s sin θ or more away from the other cone, |n − m|² = 2s² sin²θ + 2(m − s cos θ)²: unbounded",
            lambda s: gap.dot(gap) - s * 2 * (size * sp.sin(a - b)) ** 2 - 2 * (other - size * sp.cos(a - b)) ** 2,
            "−2s² sin²θ",
        ),
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
    quote=("The main theorems of this chapter (Theorem 1.31 and Lemma 1.32) generalise Theorem 1.11 and Theorem 1.13."),
    correction=Correction(
        (
            "they carry existence and uniqueness over to F - N(S, ·) with a single-valued, Lipschitz continuous "
            "F; neither pair contains the other"
        ),
        Effect.PROOF,
        "a force with several values, as dry friction has, beside constraints: Theorem 1.31 does not cover it",
        why=(
            "Theorems 1.11 and 1.13 cover (1.13), whose value at 0 is [-1, 1]; F(x) - N(S, x) is a point plus a "
            "cone, in ℝ one point, a half-line or all of ℝ, so that Theorem 1.31 does not cover it"
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
