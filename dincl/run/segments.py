"""The straight line that a step makes."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from dincl.run.bound import StepState
from dincl.run.grid import ROUNDING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from dincl.run.bound import Stepper
    from dincl.run.grid import TimeGrid


class Segment(NamedTuple):
    """The step from t_k to t_{k+1}."""

    k: int
    before: StepState
    after: StepState

    def at(self, t: float, on: TimeGrid) -> NDArray[np.float64]:
        """x on the straight line from t_k to t_{k+1}  (1.48); exactly x_{k+1} at its end."""
        weight = (t - on.time(self.k)) / on.h
        if weight >= 1 - ROUNDING * on.steps:
            return self.after.x
        return self.before.x + weight * (self.after.x - self.before.x)


def make_segment(stepper: Stepper, on: TimeGrid, k: int, first: int, state: StepState) -> Segment:
    """The step from t_k, when ``state`` is that of step ``first`` <= k; StepFailure if there is none."""
    before = stepper.advance(on, first, k, state)
    after = before if before.failure else stepper.advance(on, k, k + 1, before.state)
    if after.failure:
        raise after.failure
    return Segment(k, before.state, after.state)
