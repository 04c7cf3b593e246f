"""The equal time steps of a run, and the output times among them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dincl.errors import InvalidProblem

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dincl.run.stepper import StepState

# More steps than this are taken for a mistake in dt.
MOST_STEPS = 10**9
# t_end / dt is taken for a whole number when it is one up to rounding.
ROUNDING = 1e-12


class TimeGrid(NamedTuple):
    """t_k = k t_end / steps for k = 0 ... steps, computed from k, never by adding up."""

    t_end: float
    steps: int

    @property
    def h(self) -> float:
        """The step length [time]."""
        return self.t_end / self.steps if self.steps else 0.0

    def time(self, k: int) -> float:
        """t_k."""
        return self.t_end if k == self.steps else k * self.t_end / self.steps

    def before(self, t: NDArray[np.float64]) -> NDArray[np.int64]:
        """The last k with t_k < t, or 0, for times (K,); a t that is t_k up to rounding counts as t_k."""
        if not self.steps:
            return np.zeros(len(t), dtype=np.int64)
        place = t / self.t_end * self.steps
        nearest = np.rint(place)
        on_grid = np.abs(place - nearest) <= ROUNDING * self.steps
        found: NDArray[np.int64] = np.maximum(np.where(on_grid, nearest - 1, np.floor(place)), 0).astype(np.int64)
        return found

    def weights(self, t: NDArray[np.float64], k: NDArray[np.int64]) -> NDArray[np.float64]:
        """The places of times (K,) in the steps k: 1 at the end of a step, up to rounding."""
        start = np.where(k == self.steps, self.t_end, k * self.t_end / max(self.steps, 1))
        weight = (t - start) / (self.h or 1.0)
        weight[weight >= 1 - ROUNDING * self.steps] = 1.0
        return weight


def divide_time(t_end: float, dt: float) -> TimeGrid:
    """The fewest equal steps no longer than dt that end at t_end."""
    if t_end / dt > MOST_STEPS:
        raise InvalidProblem(f"dt = {dt:g}: needs {t_end / dt:.3g} steps to t = {t_end:g}, allowed are {MOST_STEPS:g}")
    return TimeGrid(t_end, math.ceil(t_end / dt * (1 - ROUNDING)))


class Output:
    """States at K increasing output times; the start is filled in at once if it is one of them.

    Attributes
    ----------
    step, weight
        The step k in which each time lies, t_k < t <= t_{k+1}, and its place there, 1 at the end; shape (K,).
    x, before, velocity
        The states at the times, those at t_k, and velocities at t_k for second-order schemes; shape (K, N, d).
    filled
        How many of them a run has reached, shape (1,).
    """

    def __init__(self, on: TimeGrid, times: NDArray[np.float64], start: StepState) -> None:
        self.step = on.before(times)
        self.weight = on.weights(times, self.step)
        shape = (len(times), *start.x.shape)
        self.x, self.before = np.empty(shape), np.empty(shape)
        self.velocity = np.empty(shape if start.v is not None else (0, *shape[1:]))
        self.filled = np.zeros(1, dtype=np.int64)
        if times[0] == 0:
            self.fill(0, start, start, most=1)

    def fill(self, k: int, state: StepState, after: StepState, most: int | None = None) -> None:
        """Fill in what lies in step k, on the straight line between two states  (1.48)."""
        q, last = int(self.filled[0]), len(self.step) if most is None else most
        while q < last and self.step[q] == k:
            self.before[q], self.x[q] = state.x, between(state, after, self.weight[q])
            if state.v is not None:
                self.velocity[q] = state.v
            q += 1
        self.filled[0] = q


def between(state: StepState, after: StepState, weight: float) -> NDArray[np.float64]:
    """x at a place of the step from ``state`` to ``after``; exactly that of ``after`` at the end."""
    return after.x if weight == 1.0 else state.x + weight * (after.x - state.x)
