"""Chapter 1, section 2.1: one-sided Lipschitz continuity, and when solutions are unique."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

from typing import Any

import numpy as np

from verification.claims import Evidence, FormalProof, Verdict, at_least, at_most, equal, proved
from verification.formal.algebra import identity, library
from verification.formal.reals import implication, solver_library
from verification.thesis.text.quoted import claim

# Places on both sides of 0, the nearest as near as numbers that are squared allow.
LINE = np.concatenate([sign * np.logspace(-8, 1, 40) for sign in (-1.0, 1.0)])


def growth_of_distance() -> tuple[FormalProof, FormalProof]:
    """Prove that E = |x - y|^2 with E' <= 2 k E, k(t) any function, has a falling E exp(-2 int k)."""
    sp = library()
    t = sp.Symbol("t")
    E, K = sp.Function("E")(t), sp.Function("K")(t)
    return (
        identity(
            "d/dt(E e^{−2K}) = (Ė − 2K̇E) e^{−2K}, K̇ the one-sided constant",
            lambda s: (E * sp.exp(-2 * K)).diff(t) - (E.diff(t) - s * 2 * K.diff(t) * E) * sp.exp(-2 * K),
            "+2K̇E",
        ),
        implication(
            "which is ≤ 0 if Ė ≤ 2K̇E, so ‖x − y‖ ≤ e^{K(t) − K(0)}‖x(0) − y(0)‖",
            lambda s, rate, k, E: ([E > 0, rate <= 2 * k * E], rate - s * 2 * k * E <= 0),
            "half of the constant",
            0.5,
        ),
    )


@claim(
    "c1.one-sided",
    "Solutions of a one-sided Lipschitz inclusion stay within exp(Lt) times their first distance.",
    "Theorem 1.13",
    Verdict.PROVED,
)
def _one_sided() -> Evidence:
    """E' = 2 (x' - y') (x - y) <= 2 L E for E = |x - y|^2; K = L t."""
    return proved(*growth_of_distance())


def step_values(x: float) -> tuple[float, float]:
    """The least and the largest value of the right-hand side of (1.13)."""
    return (-1.0, 1.0) if x == 0 else (-np.sign(x), -np.sign(x))


def steepest(sign: float) -> float:
    """The largest (v - w)(x - y)/(x - y)^2 of sign times (1.13), over x = 0 and x != 0 and all y of the line."""
    largest = -np.inf
    for x in (0.0, 1e-8, 0.5):
        for y in LINE[np.abs(LINE - x) > 0]:
            ends = ((v - w) * (x - y) / (x - y) ** 2 for v in step_values(x) for w in step_values(y))
            largest = max(largest, *(sign * end for end in ends))
    return float(largest)


@claim(
    "c1.step-continuity",
    "The right-hand side of the step inclusion is upper semicontinuous and one-sided Lipschitz at 0.",
    "Remark 1.14",
    Verdict.PROVED,
)
def _remark() -> Evidence:
    """h and k are values of sign at x and y, any of [-1, 1] at 0; (1.13) has the right side -h."""
    z3 = solver_library()

    def values(x: Any, h: Any) -> list[Any]:
        return [h >= -1, h <= 1, z3.Implies(x > 0, h == 1), z3.Implies(x < 0, h == -1)]

    return proved(
        implication(
            "(v − w)(x − y) ≤ 0 ≤ 2(x − y)² for all values v, w of (1.13) at any x, y",
            lambda s, x, y, h, k: ([*values(x, h), *values(y, k)], s * (k - h) * (x - y) <= 0),
            "with +sign",
        ),
        implication(
            "all values near 0 lie in [−1, 1], the value at 0",
            lambda s, x, h: (values(x, h), [-h <= s, -h >= -s]),
            "in [−½, ½]",
            0.5,
        ),
    )


@claim(
    "c1.monotone-maps",
    "The set-valued sign function is one-sided Lipschitz with L = 0.",
    "Remark 1.15",
    Verdict.CORRECTED,
)
def _monotone_maps() -> Evidence:
    plain, turned = steepest(-1.0), steepest(1.0)
    return Evidence(
        f"The largest (v - w)(x - y)/(x - y)² of sign is {plain:.0e}, at places that are that near to 0, and of -sign "
        f"{turned:g}: what Remark 1.14 shows, and what is one-sided Lipschitz with L = 0, is -sign.",
        printed=(at_most("largest one-sided slope of sign", plain, 0.0),),
        corrected=(
            at_most("largest one-sided slope of -sign", turned, 0.0),
            at_least("largest one-sided slope of sign", plain, 1e6),
        ),
    )


@claim(
    "c1.neither",
    "The right-hand side of the model of discs fulfils neither assumption of the classical theorems.",
    "after Remark 1.15",
    Verdict.PROVED,
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
            "with a normal "
            "n ~ s, for every s: no constant bounds it",
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
    """For how many forces f, eighths from -2 to 2, the values least ... most less f form a cone, as -N(S, x) does."""
    forces = np.arange(-16, 17) / 8
    ends = np.stack([least - forces, most - forces])
    return int((((ends == 0) | np.isinf(ends)).all(axis=0)).sum())


@claim(
    "c1.generalise",
    "How the theorems for prox-regular sets are related to those of section 2.",
    "after Remark 1.15",
    Verdict.CORRECTED,
)
def _generalise() -> Evidence:
    """In R, a value of F - N is a force plus {0}, a half-line or the line; that of (1.13) at 0, and at 0 of [0, oo)."""
    step, wall = cones_from(*step_values(0.0)), cones_from(0.0, np.inf)
    return Evidence(
        f"The value [-1, 1] of (1.13) at 0, to which Theorem 1.11 applies, is a force plus a cone for {step} forces, "
        f"so (1.13) is not of the form (1.40); -N([0, ∞), 0) = [0, ∞) is for {wall} force, which is 0.",
        printed=(at_least("forces f for which [-1, 1] - f is a cone", step, 1),),
        corrected=(equal("forces f for which [0, ∞) - f is a cone", wall, 1),),
    )
