"""The loop over the equal steps of a scheme."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from dincl.errors import StepFailure
from dincl.run.grid import divide_time
from dincl.run.lines import Checkpoint, StraightLines
from dincl.run.outcome import RunOutcome
from dincl.run.segments import Segment
from dincl.status import Status

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dincl.run.bound import Stepper


def run_steps(bind: Callable[[], Stepper], dt: float, times: NDArray[np.float64]) -> RunOutcome:
    """Equal steps of at most ``dt`` until the last of ``times`` (K,), or until one fails.

    ``bind()`` makes a Stepper; it is kept, and must pickle for the outcome to pickle.
    """
    return _Loop(bind, dt, times).run()


class _Loop:
    """Makes the steps and keeps states."""

    def __init__(self, bind: Callable[[], Stepper], dt: float, times: NDArray[np.float64]) -> None:
        self._bind, self._times = bind, times
        self._grid = divide_time(float(times[-1]), dt)
        self._stepper = bind()
        self._t: list[float] = []
        self._x: list[NDArray[np.float64]] = []
        self._checkpoints: list[Checkpoint] = []

    def run(self) -> RunOutcome:
        """Make the steps; a failure ends the run with the last state."""
        status, detail, cause = Status.SUCCESS, "", None
        self._state, self._reached = self._stepper.start(), 0
        if self._times[0] == 0:
            self._keep(0.0, self._state.x, Checkpoint(0, self._state))
        try:
            # Numbers that overflow end the run with a Status of their own.
            with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
                self._make_steps()
        except StepFailure as failure:
            status, cause = failure.status, failure
            time = self._grid.time(self._reached)
            detail = f"{failure.detail} This was in the step from t = {time:.6g} with dt = {self._grid.h:.6g}."
            if not self._t or self._t[-1] < time:
                self._keep(time, self._state.x, Checkpoint(self._reached, self._state))
        return self._outcome(status, detail, cause)

    def _make_steps(self) -> None:
        segment = None
        for time in self._times[len(self._t) :] if self._grid.steps else ():
            k = self._grid.before(time)
            if segment is None or segment.k < k:
                self._advance(k)
                before = self._state
                self._advance(k + 1)
                segment = Segment(k, before, self._state)
            self._keep(float(time), segment.at(float(time), self._grid), Checkpoint(k, segment.before))

    def _advance(self, k: int) -> None:
        """Go on to step k."""
        self._reached, self._state, failure = self._stepper.advance(self._grid, self._reached, k, self._state)
        if failure:
            raise failure

    def _keep(self, t: float, x: NDArray[np.float64], checkpoint: Checkpoint) -> None:
        self._t.append(t)
        self._x.append(x)
        self._checkpoints.append(checkpoint)

    def _outcome(self, status: Status, detail: str, cause: StepFailure | None) -> RunOutcome:
        between = StraightLines(self._bind, self._grid, tuple(self._checkpoints))
        t, x = np.array(self._t), np.array(self._x)
        return RunOutcome(t, x, status, detail, self._stepper.work, between, failure=cause)
