"""Sets, paths and states of chapters 1 and 2 in closed form: discs, the outside of the unit disc, cells."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

import dincl

Floats = NDArray[np.float64]

# Of checks that draw random numbers.
SAMPLES, SEED = 300, 12
# What is left of numbers of size 1 after some hundred operations.
ROUNDING = 1e-12

DOWN = np.array([0.0, -1.0])


def apart(y: Floats, least: float = 1.0) -> Floats:
    """Project pairs of points, (..., 2, d), that must be ``least`` apart, as in Example 2.5: half each."""
    arrow = y[..., 1, :] - y[..., 0, :]
    length = np.linalg.norm(arrow, axis=-1, keepdims=True)
    push = np.maximum(least - length, 0.0) / 2 * arrow / length
    return np.stack((y[..., 0, :] - push, y[..., 1, :] + push), axis=-2)


def outside(y: Floats) -> Floats:
    """Return the projection onto the outside of the unit disc, which is 1-prox-regular; y of shape (..., 2), not 0."""
    length = np.linalg.norm(y, axis=-1, keepdims=True)
    return np.asarray(y / np.minimum(length, 1.0))


def catch_up(start: Floats, drift: Callable[[Floats], Floats], h: float, steps: int) -> Floats:
    """Return x_0, x_1, ... of (1.39) outside of the unit disc, (steps + 1, K, 2) for K starts."""
    path = [start]
    for _ in range(steps):
        path.append(outside(path[-1] + h * drift(path[-1])))
    return np.array(path)


def falling(x: Floats) -> Floats:
    """Return the drift of points that fall onto the disc from above."""
    return np.broadcast_to(DOWN, x.shape)


def contact_gradients(x: Floats, pairs: list[tuple[int, int]]) -> Floats:
    """Return the gradients of |X_i - X_j| for the pairs given, (M, 2 N); they span -N."""
    rows = np.zeros((len(pairs), *x.shape))
    for k, (i, j) in enumerate(pairs):
        unit = (x[i] - x[j]) / np.linalg.norm(x[i] - x[j])
        rows[k, i], rows[k, j] = unit, -unit
    return rows.reshape(len(pairs), x.size)


# Hard spheres of cells around the events of chapter 3: a division, and the beginning of mitosis. Lengths in μm.
# Table 2, (3.4) and (3.7).
HARD, GROWN, OFFSET = 1.66, 0.7 * 5.0, 0.05
TOL = 1e-10
CENTRE = np.array([0.0, -3.0])

State = tuple[Floats, Floats]


def resting() -> State:
    """Return a nucleus between two that touch it, and their radii."""
    around = 2 * HARD * np.array([[math.cos(s), math.sin(s)] for s in (2.4, 0.3)])
    return np.array([around[0], [0.0, 0.0], around[1]]), np.full(3, HARD)


def in_mitosis() -> State:
    """Return these nuclei right after the middle one has begun mitosis (3.4)."""
    x, radii = resting()
    radii[1] = GROWN
    return x, radii


def divided() -> State:
    """Return the daughters of a cell between two others that are far enough, right after its division (3.7), (3.8)."""
    x = np.array([[-4 * HARD, 1.0], [-OFFSET, 0.0], [OFFSET, 0.0], [4 * HARD, 2.0]])
    return x, np.full(4, HARD)


def problem(start: Floats, radii: Floats) -> dincl.Problem:
    """Return nuclei that do not overlap and are pulled to a point."""
    return dincl.Problem(start, lambda _t, x: CENTRE - x, [dincl.NonOverlap(radii)])


def feasible(radii: Floats) -> dincl.Problem:
    """Return this problem from some state of S: a problem must not begin elsewhere."""
    return problem(3 * GROWN * np.arange(len(radii))[:, None] * np.array([[1.0, 0.0]]), radii)


def overlap(state: State) -> float:
    """Return the largest overlap of a state."""
    return feasible(state[1]).violation(0.0, state[0])


def nearest(state: State) -> State:
    """Return the nearest state of S to a state."""
    return dincl.project(feasible(state[1]), state[0], dincl.Daqp(tol=TOL)).point, state[1]


def away(state: State) -> float:
    """Return the distance of a state from S."""
    return float(np.linalg.norm(nearest(state)[0] - state[0]))


# Discs of chapter 2 that are pushed into each other, and the projections that separate them.
RADIUS = 0.5


def separated(x: Floats) -> Floats:
    """Return both discs moved apart by half of their overlap: the formulas of Example 2.5."""
    return apart(x, 2 * RADIUS)


def points_of_step(x: Floats, force: Floats, dt: float) -> list[Floats]:
    """Return p_0 ... p_M of one step of PBD (2.11): pairs (i, j < i) in the order of Algorithm 1."""
    points = [x + dt * force]
    for i in range(len(x)):
        for j in range(i):
            p = points[-1].copy()
            p[[j, i]] = separated(p[[j, i]])
            points.append(p)
    return points


def row(count: int) -> Floats:
    """Return centres of discs that touch each other in a row."""
    return np.column_stack((2 * RADIUS * np.arange(float(count)), np.zeros(count)))
