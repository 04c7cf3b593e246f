"""Output states of an external program, as the outcome of a run."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

import dincl
from dincl import Between
from dincl.checks import bounded
from dincl.constants import LARGEST
from dincl.errors import StepFailure

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class _Lines(Between):
    """Straight lines from the start through the output states; nothing is known of x' at a time."""

    t: Floats
    x: Floats

    def states(self, times: Floats) -> Floats:
        columns = self.x.reshape(len(self.t), -1).T
        lines = [np.interp(times, self.t, column) for column in columns]
        return np.array(lines).T.reshape(len(times), *self.x.shape[1:])

    def residuals(self, times: Floats) -> Floats:
        return np.full(len(times), np.inf)


class Kept:
    """States of a run at increasing times, and the outcome that is made of them."""

    def __init__(self, problem: dincl.Problem, times: Floats) -> None:
        self.work = dincl.Work(degrees_of_freedom=problem.x0.size)
        self._problem, self._times = problem, times
        self._t: list[float] = []
        self._x: list[Floats] = []

    def velocity(self, t: float, x: Floats) -> Floats:
        """Return the drift, counted."""
        self.work.drift_evaluations += 1
        return self._problem.velocity(t, x)

    def due(self, t: float) -> Floats:
        """Return the times up to t that are still to be kept."""
        return self._times[len(self._t) : np.searchsorted(self._times, t, side="right")]

    def keep(self, t: float, x: Floats) -> None:
        """Add a state (N, d); StepFailure if it has left the finite numbers."""
        if not bounded(x):
            raise StepFailure(
                dincl.Status.NON_FINITE, f"A coordinate is not a number, or exceeds {LARGEST:g} in magnitude."
            )
        self._t.append(t)
        self._x.append(x)

    def outcome(self, failure: StepFailure | None = None) -> dincl.RunOutcome:
        """Return the run so far, and how it ended; a run that kept nothing still has its start."""
        t, x = np.array([0.0, *self._t]), np.array([self._problem.x0, *self._x])
        self.work.callbacks = self.work.steps  # Python makes each step by a call of the external program.
        first = 1 if self._t else 0
        return dincl.RunOutcome(
            t=t[first:],
            x=x[first:],
            status=dincl.Status.SUCCESS if failure is None else failure.status,
            detail="" if failure is None else failure.detail,
            stats=self.work,
            between=_Lines(t, x),
        )
