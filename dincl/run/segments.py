"""The steps of a run one after another, each with the straight line that it makes."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from dincl.checks import LARGEST, bounded, describe
from dincl.errors import InvalidProblem, StepFailure
from dincl.run.bound import StepState
from dincl.run.grid import ROUNDING
from dincl.status import Status

if TYPE_CHECKING:
    from collections.abc import Iterator

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


def make_segments(stepper: Stepper, on: TimeGrid, k: int, state: StepState) -> Iterator[Segment]:
    """The steps from t_k on; StepFailure ends it when a step cannot be made or leaves the finite numbers."""
    for index in range(k, on.steps):
        after = stepper.step(on.time(index), on.h, state)
        if not isinstance(after, StepState) or getattr(after.x, "shape", None) != state.x.shape:
            raise InvalidProblem(
                f"scheme: {type(stepper).__name__}.step returned {describe(after)}: must be a dincl.StepState with x "
                f"of shape {state.x.shape}"
            )
        if not bounded(after.x):
            raise StepFailure(Status.NON_FINITE, f"A coordinate is not a number, or exceeds {LARGEST:g} in magnitude.")
        stepper.work.steps += 1
        yield Segment(index, state, after)
        state = after
