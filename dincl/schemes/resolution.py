"""Faults that agreement of runs does not show: states outside of the set, and steps too long for what happens.

Runs with different steps agree, and are all wrong, where steps of either length jump over what comes and goes, or where
an unstable step throws a particle onto the same wall.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from dincl.errors import StepFailure
from dincl.system.time_scales import time_scales

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dincl.problem import Problem

# Finer steps mend violations if the distance from the set falls at least by this factor from one run to the next.
FALLS = 0.75
# Steps are at most this part of those that resolve all functions of time in a run of high order.
PART = 0.25
# A step of an explicit method is stable if it is at most this over the rate of the drift (Euler, midpoint).
STABLE = 2.0
# The rate is looked at in so many states of a run, with so many iterations in each.
STATES, ITERATIONS = 4, 4
# Of the difference that gives it, relative to the largest coordinate.
DIFFERENCE = math.sqrt(np.finfo(float).eps)


def distance_outside(problem: Problem, times: NDArray[np.float64], x: NDArray[np.float64]) -> float:
    """Return a lower bound of max_i |X_i - exact| over all times, to first order: a solution stays in the set.

    It is max_k (-g_k) / sum_i |grad_i g_k|.
    """
    largest = 0.0
    for t, state in zip(times, x, strict=True):
        try:
            rows = problem.rows_within(float(t), state, 0.0)
            depth = np.maximum(-rows.values(state), 0.0)
            jacobian = rows.jacobian(state).tocoo()
        except StepFailure:
            return math.inf
        if depth.any():
            particles = jacobian.row * len(state) + jacobian.col // state.shape[1]
            pairs, place = np.unique(particles, return_inverse=True)  # of a row and a particle
            gradients = np.sqrt(np.bincount(place, jacobian.data**2))
            slopes = np.bincount(pairs // len(state), gradients, len(depth))
            largest = max(largest, float((depth[slopes > 0] / slopes[slopes > 0]).max(initial=0.0)))
    return largest


def resolving_step(problem: Problem, times: NDArray[np.float64], accuracy: float) -> float:
    """Return the longest step that resolves all functions of time until ``times[-1]`` [time]; infinite without any."""
    return PART * time_scales(problem, times, accuracy).shortest


def stable_step(problem: Problem, times: NDArray[np.float64], x: NDArray[np.float64]) -> float:
    """Return the longest step with which an explicit method is stable at states x (K, N, d) [time].

    It is 2 / L, L the norm of dF/dx by a few power iterations of differences: a lower bound of it.
    """
    rate = 0.0
    for k in np.unique(np.linspace(0, len(times) - 1, STATES).astype(np.int64)):
        rate = max(rate, _rate(problem, float(times[k]), x[k]))
    return STABLE / rate if rate > 0 else math.inf


def _rate(problem: Problem, t: float, x: NDArray[np.float64]) -> float:
    try:
        velocity, rate = problem.velocity(t, x), 0.0
        # No direction of a drift that people write is at right angles to this one.
        way = np.cos(1.0 + np.arange(x.size)).reshape(x.shape)
        for _ in range(ITERATIONS):
            length = DIFFERENCE * (float(np.abs(x).max()) or 1.0)
            way *= length / np.linalg.norm(way)
            change = problem.velocity(t, x + way) - velocity
            rate = max(rate, float(np.linalg.norm(change)) / length)
            if not change.any():
                break
            way = change
    except StepFailure:
        return 0.0
    return rate
