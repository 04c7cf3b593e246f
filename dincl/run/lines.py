"""Between the kept times of time steps: the straight lines, made again from the last kept state."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dincl.cone import distance_to_cone
from dincl.errors import StepFailure
from dincl.norms import longest
from dincl.run.bound import Stepper, StepState
from dincl.run.grid import TimeGrid
from dincl.run.outcome import Between
from dincl.run.segments import Segment, make_segment

if TYPE_CHECKING:
    from numpy.typing import NDArray


class Checkpoint(NamedTuple):
    """Where a run can be taken up again: the state at step k."""

    k: int
    state: StepState


@dataclass(frozen=True, eq=False)
class StraightLines(Between):
    """The straight lines between the steps; those around a time are made again from the last kept one before it.

    ``bind()`` makes a new Stepper of the scheme for the problem, so that asking does not add to the work of the run.
    """

    bind: Callable[[], Stepper]
    grid: TimeGrid
    checkpoints: tuple[Checkpoint, ...]

    def states(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """(1.48); nothing but the checkpoints is stored, so the steps from one of them to the time are made again."""
        stepper = self.bind()
        values = np.empty((len(times), *stepper.problem.x0.shape))
        last = Checkpoint(0, stepper.start())
        for index, t in enumerate(times):
            values[index], last = self._at(stepper, float(t), last)
        return values

    def residuals(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """For the step that ends at or after each of the times of the checkpoints."""
        stepper = self.bind()
        kept = zip(times, self.checkpoints, strict=True)
        return np.array([self._residual(stepper, point) if t > 0 else np.inf for t, point in kept])

    def _at(self, stepper: Stepper, t: float, last: Checkpoint) -> tuple[NDArray[np.float64], Checkpoint]:
        k = self.grid.before(t)
        point = max((p for p in (last, *self.checkpoints) if p.k <= k), key=lambda p: p.k)
        if t <= 0 or not self.grid.steps:
            return point.state.x, point
        segment = self._segment(stepper, k, point)
        return segment.at(t, self.grid), Checkpoint(k, segment.before)

    def _segment(self, stepper: Stepper, k: int, point: Checkpoint) -> Segment:
        return make_segment(stepper, self.grid, k, *point)

    def _residual(self, stepper: Stepper, point: Checkpoint) -> float:
        try:
            segment = self._segment(stepper, point.k, point)
            return self._residual_of(stepper, segment) if segment.after.v is None else np.inf
        except StepFailure:
            return np.inf

    def _residual_of(self, stepper: Stepper, segment: Segment) -> float:
        problem, h, t = stepper.problem, self.grid.h, self.grid.time(segment.k)
        drift = problem.velocity(t, segment.before.x)
        reaction = (segment.after.x - segment.before.x) / h - drift
        rows = problem.rows_within(t + h, segment.after.x, h * longest(drift) / 2)
        return distance_to_cone(reaction.ravel(), rows.jacobian(segment.after.x))
