"""Hard spheres of cells around the events of chapter 3: a division, and the beginning of mitosis. Lengths in μm."""

from __future__ import annotations

import math

import numpy as np

import dincl
from verification.thesis.chapter1.sets import Floats

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
