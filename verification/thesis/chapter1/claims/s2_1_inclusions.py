"""Chapter 1, section 2.1: one-sided Lipschitz continuity, and when solutions are unique."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import numpy as np
from scipy.linalg import expm

from verification.claims import Correction, Effect, claim
from verification.evidence import Evidence, Kind, at_least, at_most, equal
from verification.thesis.chapter1.sets import Floats

SAMPLES = 2000
SEED = 11
ROUNDING = 1e-12
# Places on both sides of 0, the nearest as near as numbers that are squared allow.
LINE = np.concatenate([sign * np.logspace(-8, 1, 40) for sign in (-1.0, 1.0)])


def damped_step(start: Floats, t: float) -> Floats:
    """The solutions of x' in -x - sign(x) from start > 0, which reach 0 and stay; L = -1."""
    return np.asarray(np.maximum((start + 1) * np.exp(-t) - 1, 0.0))


def growth(rate: float, t: float) -> float:
    """The factor of Theorem 1.13."""
    return float(np.exp(rate * t))


@claim(
    "c1.one-sided",
    "Solutions of a one-sided Lipschitz inclusion stay within exp(Lt) times their first distance.",
    source="Theorem 1.13",
    quote="‖x(t) - y(t)‖ ≤ exp(Lt) ‖x(0) - y(0)‖",
    recorded=Kind.NOT_REFUTED,
    tried_on="40 linear systems, and a set-valued one on the line",
)
def _one_sided() -> Evidence:
    """Linear systems, for which the best L is the largest eigenvalue of the symmetric part, and a set-valued one."""
    rng, worst, sharp, constants = np.random.default_rng(SEED), 0.0, 0.0, []
    for shift in rng.uniform(-4.0, 1.0, 40):
        a = rng.normal(size=(3, 3)) + shift * np.eye(3)
        constants.append(float(np.linalg.eigvalsh((a + a.T) / 2)[-1]))
        worst = max(worst, float(np.linalg.norm(expm(a), 2)) / growth(constants[-1], 1.0))
        symmetric = (a + a.T) / 2
        sharp = max(sharp, float(np.linalg.norm(expm(symmetric), 2)) / growth(constants[-1], 1.0))
    first, second = rng.uniform(0.0, 5.0, (2, SAMPLES))
    gone = np.abs(damped_step(first, 0.7) - damped_step(second, 0.7)) / np.abs(first - second)
    stepped = float(gone.max()) / growth(-1.0, 0.7)
    return Evidence(
        f"40 linear systems with L from {min(constants):.2f} to {max(constants):.2f}: distances grow by at most "
        f"{worst:.6f} times exp(Lt), and those of ẋ ∈ -x - sign(x) with L = -1 by {stepped:.6f} times; symmetric "
        f"systems attain {sharp:.6f}.",
        printed=(
            at_most("growth over exp(Lt), linear systems", worst, 1.0, 1e-9),
            at_most("growth over exp(Lt), -x - sign(x)", stepped, 1.0, 1e-9),
            at_most("least L of the samples", min(constants), 0.0),
            equal("growth over exp(Lt), sharp case", sharp, 1.0, 1e-9),
        ),
        seed=SEED,
    )


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
    source="Remark 1.14",
    quote="(v - w)(x - y) = (v + 1)(0 - y) ≤ 0 ≤ 2(x - y)²",
)
def _remark() -> Evidence:
    low, high = step_values(0.0)
    away = sum(not low <= end <= high for y in LINE for end in step_values(y))
    slope = steepest(1.0)
    return Evidence(
        f"At {LINE.size} places y no value of (1.13) lies outside of [-1, 1], its value at 0; the largest "
        f"(v - w)(x - y)/(x - y)² is {slope:g} ≤ 0.",
        printed=(equal("values outside of [-1, 1]", away, 0), at_most("largest one-sided slope", slope, 0.0)),
    )


@claim(
    "c1.monotone-maps",
    "The set-valued sign function is one-sided Lipschitz with L = 0.",
    source="Remark 1.15",
    quote=(
        "we actually showed a stronger property for the sign function, namely that it is a monotone map … with L = 0."
    ),
    recorded=Kind.CORRECTED,
    correction=Correction(
        "-sign is one-sided Lipschitz with L = 0; sign is not for any L, as the remark says in its next sentence",
        Effect.PROOF,
        "the remark itself; Theorem 1.13 is applied to -sign",
        why=(
            "Remark 1.14 is about −sign, and the next sentence says that sign is neither monotone nor one-sided "
            "Lipschitz: for y → 0 the quotient of sign grows like 1/|y|"
        ),
        place=498,
    ),
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


def touching(angle: float) -> tuple[Floats, Floats]:
    """Two discs of radius 1/2 in contact, (2, 2), and the unit normal of S there, which pushes them together."""
    arrow = np.array([np.cos(angle), np.sin(angle)])
    return np.array([-arrow, arrow]) / 2, np.array([arrow, -arrow]) / np.sqrt(2)


@claim(
    "c1.neither",
    "The right-hand side of the model of discs fulfils neither assumption of the classical theorems.",
    source="after Remark 1.15",
    quote="the multi-functions F considered will neither be upper semicontinuous nor one-sided Lipschitz continuous.",
    chosen="F = 0 and two discs",
    recorded=Kind.NOT_REFUTED,
    tried_on="two touching discs without forces",
)
def _neither() -> Evidence:
    """-N(S, .) of two discs at two angles, with a normal of length s at the first and none at the second."""
    (x, n), (y, m) = touching(0.0), touching(0.3)
    slopes, gaps = [], []
    for s in (1.0, 1e3, 1e6):
        slopes.append(float(-(s * n * (x - y)).sum() / ((x - y) ** 2).sum()))
        along = max(float((s * n * m).sum()), 0.0)
        gaps.append(float(np.linalg.norm(s * n - along * m)))
    return Evidence(
        f"Two touching discs turned by 0.3, a normal of length s = 1, 10³, 10⁶ at one place: one-sided slopes "
        f"{slopes[0]:.2g}, {slopes[1]:.2g}, {slopes[2]:.2g}, and distances {gaps[0]:.2g}, {gaps[1]:.2g}, {gaps[2]:.2g} "
        "from the cone at the other place; neither is bounded.",
        printed=(
            at_least("one-sided slope, s = 10⁶ over s = 1", slopes[2] / slopes[0], 1e5),
            at_least("one-sided slope, s = 1", slopes[0], 0.1),
            at_least("distance from the other cone, s = 10⁶ over s = 1", gaps[2] / gaps[0], 1e5),
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
    source="after Remark 1.15",
    quote="The main theorems of this chapter (Theorem 1.31 and Lemma 1.32) generalise Theorem 1.11 and Theorem 1.13.",
    recorded=Kind.CORRECTED,
    correction=Correction(
        "they carry existence and uniqueness over to F - N(S, ·) with a single-valued, Lipschitz continuous F; neither "
        "pair contains the other",
        Effect.PROOF,
        "a force with several values, as dry friction has, beside constraints: Theorem 1.31 does not cover it",
        why=(
            "Theorems 1.11 and 1.13 cover (1.13), whose value at 0 is [-1, 1]; F(x) - N(S, x) is a point plus a cone, "
            "in ℝ one point, a half-line or all of ℝ, so that Theorem 1.31 does not cover it"
        ),
        place=502,
    ),
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
