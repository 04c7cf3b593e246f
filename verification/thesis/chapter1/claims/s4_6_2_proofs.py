"""Chapter 1, section 4.6.2: the proof of existence, the steps of the catch-up scheme and their bounds."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import math

import numpy as np

from verification.claims import Correction, Effect, claim
from verification.evidence import Evidence, Kind, at_most
from verification.thesis.chapter1.sets import Floats, catch_up, outside

ROUNDING = 1e-12
T, STEPS = 1.0, 200
H = T / STEPS
# A force that pushes towards one axis and away from the other, and its constant of linear growth.
MATRIX, SHIFT = np.array([[0.9, 0.2], [0.1, -1.1]]), np.array([0.1, -0.2])
M_F = max(float(np.linalg.norm(MATRIX, 2)), float(np.linalg.norm(SHIFT)))
# Two discs of radius 1/2: their constant of prox-regularity, a part of it; a seed, and what counts as nearly as near.
ETA, SURE, PUSHES, NEARLY = math.sqrt(0.5), 0.99, 19, 1e-5
STARTS = np.array([[1.2, 0.1], [0.05, 1.3], [-0.1, 1.01], [40.0, 30.0]])


def pushing(x: Floats) -> Floats:
    """A force with ‖F(x)‖ <= M_F (1 + ‖x‖)."""
    return np.asarray(x @ MATRIX.T + SHIFT)


def reach(y: Floats) -> Floats:
    """dist(y, S) for the outside of the unit disc."""
    return np.asarray(np.maximum(1 - np.linalg.norm(y, axis=-1), 0.0))


@claim(
    "c1.projection-step",
    "The distance of a step of catch-up from the free step.",
    source="before (1.50)",
    quote="With x_{k+1} ∈ P_S(x_k), we get ‖x_{k+1} - (x_k + hF(x_k))‖ = dist(x_k + hF(x_k), S)",
    recorded=Kind.CORRECTED,
    correction=Correction(
        "x_{k+1} ∈ P_S(x_k + hF(x_k))",
        Effect.NOTATION,
        "nothing else: (1.46) is right",
        why="(1.46) projects x_k + hF(x_k); P_S(x_k) = x_k as x_k ∈ S",
        place=974,
    ),
    chosen="the outside of the unit disc and a linear force",
    tried_on="a linear force outside of a disc, four starts",
)
def _projection_step() -> Evidence:
    """The first line of (1.50) at points of S, with the next point as printed and as in (1.46)."""
    x = catch_up(STARTS, pushing, H, STEPS)[:-1]
    target = x + H * pushing(x)
    printed, right = (
        float(np.abs(np.linalg.norm(outside(y) - target, axis=-1) - reach(target)).max() / H) for y in (x, target)
    )
    return Evidence(
        f"P_S(x_k) = x_k for x_k ∈ S, so as printed nothing moves, and the first equality of (1.50) is off by up to "
        f"{printed:.2f} h. With P_S(x_k + hF(x_k)), as in (1.46), by {right:.0e} h.",
        printed=(at_most("error of the equality in (1.50), over h", printed, 0.0, 1e-9),),
        corrected=(at_most("error with P_S(x_k + hF(x_k)), over h", right, 0.0, 1e-9),),
    )


@claim(
    "c1.step-bounds",
    "How far a step of catch-up goes.",
    source="(1.50), (1.51)",
    quote="… ≤ hM_F(1 + ‖x_k‖), ‖x_{k+1} - x_k‖ ≤ 2hM_F(‖x_k‖ + 1)",
    chosen="the outside of the unit disc and a linear force",
    recorded=Kind.NOT_REFUTED,
    tried_on="a linear force outside of a disc, four starts",
)
def _step_bounds() -> Evidence:
    path = catch_up(STARTS, pushing, H, STEPS)
    bound = H * M_F * (1 + np.linalg.norm(path[:-1], axis=-1))
    off = float((reach(path[:-1] + H * pushing(path[:-1])) / bound).max())
    moved = float((np.linalg.norm(np.diff(path, axis=0), axis=-1) / (2 * bound)).max())
    return Evidence(
        f"A linear force outside of a disc, 4 starts, {STEPS} steps: dist(x_k + hF, S) is at most {off:.3f} "
        f"hM_F(1 + ‖x_k‖) and ‖x_(k+1) - x_k‖ at most {moved:.3f} · 2hM_F(1 + ‖x_k‖).",
        printed=(at_most("left over right side of (1.50)", off, 1.0), at_most("the same, (1.51)", moved, 1.0)),
    )


def first_constant(start: Floats, growth: float = M_F) -> Floats:
    """C_1 of (1.52) by Theorem 1.36 with A = B = 2 M_F, for first distances from 0."""
    grown = math.exp(2 * growth * T)
    return start * grown + grown - 1


@claim(
    "c1.constant",
    "What the bound of the discrete solutions depends on.",
    source="(1.52)",
    quote="‖x_k‖ ≤ C₁ < ∞ for a constant C₁ which only depends on T and M_F.",
    recorded=Kind.CORRECTED,
    correction=Correction(
        "C₁ = exp(2M_F T)(‖xⁱⁿⁱᵗ‖ + 1) - 1 depends on ‖xⁱⁿⁱᵗ‖ as well",
        Effect.PROOF,
        "C₂ and C₃; the solution of one start exists all the same",
        why=(
            "Theorem 1.36 with A = B = 2M_F bounds ‖x_k‖ by exp(2M_F T)‖x₀‖ + exp(2M_F T) − 1, and k = 0 alone "
            "needs C₁ ≥ ‖xⁱⁿⁱᵗ‖"
        ),
        place=995,
    ),
    chosen="the outside of the unit disc and a linear force",
    tried_on="a linear force outside of a disc, four starts",
)
def _constant() -> Evidence:
    sizes = np.linalg.norm(catch_up(STARTS, pushing, H, STEPS), axis=-1)
    printed = float(sizes.max() / first_constant(np.ones(1))[0])
    right = float((sizes / first_constant(sizes[0])).max())
    return Evidence(
        f"‖x_k‖ ≤ C₁ for k = 0 says that C₁ ≥ ‖xⁱⁿⁱᵗ‖. With T = 1, M_F = {M_F:.2f} the ‖x_k‖ from ‖x₀‖ = 50 are up to "
        f"{printed:.1f} times the C₁ that (1.45) gives without the start, and {right:.2f} times that of "
        "exp(2M_F T)(‖xⁱⁿⁱᵗ‖ + 1) - 1.",
        printed=(at_most("‖x_k‖ over C₁(T, M_F)", printed, 1.0),),
        corrected=(at_most("‖x_k‖ over C₁(T, M_F, ‖xⁱⁿⁱᵗ‖)", right, 1.0, ROUNDING),),
    )


@claim(
    "c1.speeds",
    "Bounds of the interpolated solutions, their speeds and the constraint forces.",
    source="(1.53), (1.54), before (1.67)",
    quote="2M_F(1 + C₁) =: C₂, ‖x⁽ⁿ⁾‖_∞ ≤ C₁, ‖ẋ⁽ⁿ⁾‖_∞ ≤ C₂, C₃ := C₂ + M_F(1 + C₁)",
    chosen="C₁ with the start in it; the outside of the unit disc and a linear force",
    recorded=Kind.NOT_REFUTED,
    tried_on="a linear force outside of a disc, four starts",
)
def _speeds() -> Evidence:
    path = catch_up(STARTS, pushing, H, STEPS)
    first = first_constant(np.linalg.norm(path[0], axis=-1))
    second = 2 * M_F * (1 + first)
    third = second + M_F * (1 + first)
    speed = np.diff(path, axis=0) / H
    fast = float((np.linalg.norm(speed, axis=-1) / second).max())
    rest = float((np.linalg.norm(speed - pushing(path[:-1]), axis=-1) / third).max())
    halves = float((np.linalg.norm((path[1:] + path[:-1]) / 2, axis=-1) / first).max())
    return Evidence(
        f"A linear force outside of a disc, 4 starts: ‖x⁽ⁿ⁾‖ between the steps is at most {halves:.3f} C₁, the speed "
        f"{fast:.3f} C₂, ‖ẋ⁽ⁿ⁾ - F⁽ⁿ⁾‖ {rest:.3f} C₃, with C₂ = 2M_F(1 + C₁) and C₃ = C₂ + M_F(1 + C₁).",
        printed=(
            at_most("‖x⁽ⁿ⁾‖ over C₁", halves, 1.0),
            at_most("speed over C₂", fast, 1.0),
            at_most("‖ẋ⁽ⁿ⁾ - F⁽ⁿ⁾‖ over C₃", rest, 1.0),
        ),
    )


def touching_pushed(reach: float) -> Floats:
    """Predictions y = x + hF of two touching discs in random directions, most of them straight at each other."""
    rng = np.random.default_rng(PUSHES)
    angles = rng.uniform(0, 2 * np.pi, 50)
    turns = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    x = np.stack([-turns, turns], axis=1) / 2
    straight = -x / np.linalg.norm(x, axis=(1, 2), keepdims=True)
    away = rng.normal(size=x.shape)
    mixed = away / np.linalg.norm(away, axis=(1, 2), keepdims=True)
    return np.concatenate([x + reach * straight, x + reach * mixed])


def spread(y: Floats, nearly: float) -> float:
    """How far apart the directions are in which two discs at y can be parted with nearly the least effort."""
    turns = np.linspace(0, 2 * np.pi, 3600, endpoint=False)
    units = np.stack([np.cos(turns), np.sin(turns)], axis=1)
    effort = ((units - (y[1] - y[0])) ** 2).sum(axis=1) / 2
    near = units[effort <= effort.min() + nearly]
    return float(np.linalg.norm(near - near[0], axis=1).max()) if np.linalg.norm(y[1] - y[0]) < 1 else 0.0


@claim(
    "c1.unique-projections",
    "With short steps the catch-up scheme has one place to go to.",
    source="(1.55)",
    quote="dist(x_k + hF(x_k), S) ≤ … < η … the projections in (1.39) are unique for sufficiently large n.",
    chosen="two discs of radius R, for which η = √2 R",
    recorded=Kind.NOT_REFUTED,
    tried_on="two touching discs",
)
def _unique() -> Evidence:
    """Steps hF nearly as long as (1.55) allows; and n for F = -x, M_F = 1, from a start with |x| = 1/sqrt(2)."""
    (wide, below), (_, at) = (
        [max(spread(y, nearly) for y in touching_pushed(part * ETA)) for nearly in (16 * NEARLY, NEARLY)]
        for part in (SURE, 1.0)
    )
    start = np.array([math.sqrt(0.5)])
    steps = math.ceil(T * (1 + first_constant(start, 1.0)[0]) / ETA)
    return Evidence(
        f"Two touching discs, η = √2 R, 100 predictions {SURE:g} η away: the directions to part them with nearly the "
        f"least effort differ by {wide:.2f}, and by {below:.2f} with a 16th of the slack: one point of S is nearest; "
        f"η away by up to {at:.1f}. For F = −x and T = 1 (1.55) asks for n ≥ {steps}.",
        printed=(at_most("difference of directions, a 16th of the slack over all", below / wide, 0.5),),
        seed=PUSHES,
    )
