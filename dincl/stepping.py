"""The time steps of a run: a uniform grid, a generator over it, and the straight line between two steps."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from dincl.checks import LARGEST, bounded
from dincl.errors import InvalidProblem, StepFailure
from dincl.status import Status

if TYPE_CHECKING:
    from collections.abc import Iterator

    import numpy as np
    from numpy.typing import NDArray

    from dincl.schemes.base import State, Stepper

# More steps than this are taken for a mistake in dt.
MOST_STEPS = 10**9
# t_end / dt is taken for a whole number when it is one up to rounding.
ROUNDING = 1e-12


class Grid(NamedTuple):
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

    def before(self, t: float) -> int:
        """The last k with t_k < t, or 0; a t that is t_k up to rounding counts as t_k."""
        if t <= 0 or not self.steps:
            return 0
        place = t / self.t_end * self.steps
        nearest = round(place)
        on_grid = abs(place - nearest) <= ROUNDING * self.steps
        return max(0, nearest - 1 if on_grid else math.floor(place))


def grid(t_end: float, dt: float) -> Grid:
    """The fewest equal steps no longer than dt that end at t_end."""
    if t_end / dt > MOST_STEPS:
        raise InvalidProblem(f"dt = {dt:g}: needs {t_end / dt:.3g} steps to t = {t_end:g}, allowed are {MOST_STEPS:g}")
    return Grid(t_end, math.ceil(t_end / dt * (1 - ROUNDING)))


class Step(NamedTuple):
    """The step from t_k to t_{k+1}."""

    k: int
    before: State
    after: State

    def at(self, t: float, on: Grid) -> NDArray[np.float64]:
        """x on the straight line from t_k to t_{k+1}  (1.48); exactly x_{k+1} at its end."""
        weight = (t - on.time(self.k)) / on.h
        if weight >= 1 - ROUNDING * on.steps:
            return self.after.x
        return self.before.x + weight * (self.after.x - self.before.x)


def iterate(stepper: Stepper, on: Grid, k: int, state: State) -> Iterator[Step]:
    """The steps from t_k on; StepFailure ends it when a step cannot be made or leaves the finite numbers."""
    for index in range(k, on.steps):
        after = stepper.step(on.time(index), on.h, state)
        if not bounded(after.x):
            raise StepFailure(
                Status.NON_FINITE, f"A coordinate is no number of magnitude at most {LARGEST:g} any more."
            )
        stepper.work.steps += 1
        yield Step(index, state, after)
        state = after
