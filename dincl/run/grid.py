"""The equal time steps of a run."""

from __future__ import annotations

import math
from typing import NamedTuple

from dincl.errors import InvalidProblem

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

    def before(self, t: float) -> int:
        """The last k with t_k < t, or 0; a t that is t_k up to rounding counts as t_k."""
        if t <= 0 or not self.steps:
            return 0
        place = t / self.t_end * self.steps
        nearest = round(place)
        on_grid = abs(place - nearest) <= ROUNDING * self.steps
        return max(0, nearest - 1 if on_grid else math.floor(place))


def divide_time(t_end: float, dt: float) -> TimeGrid:
    """The fewest equal steps no longer than dt that end at t_end."""
    if t_end / dt > MOST_STEPS:
        raise InvalidProblem(f"dt = {dt:g}: needs {t_end / dt:.3g} steps to t = {t_end:g}, allowed are {MOST_STEPS:g}")
    return TimeGrid(t_end, math.ceil(t_end / dt * (1 - ROUNDING)))
