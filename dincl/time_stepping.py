"""A run of a time-stepping scheme: the loop over the steps, and what lies between the kept times."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dincl.cone import distance_to_cone
from dincl.errors import StepFailure
from dincl.norms import longest
from dincl.status import Status
from dincl.stepping import Grid, Step, grid, iterate
from dincl.trajectory import Between, Trajectory

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dincl.problem import Problem
    from dincl.schemes.base import State, Stepper, TimeStepping


class Mark(NamedTuple):
    """Where a run can be taken up again: the state at step k."""

    k: int
    state: State


def run(problem: Problem, scheme: TimeStepping, times: NDArray[np.float64]) -> Trajectory:
    """Make the steps of ``scheme`` until the last of ``times`` (K,), or until one fails."""
    return _Run(problem, scheme, times).run()


class _Run:
    """Steps and keeps."""

    def __init__(self, problem: Problem, scheme: TimeStepping, times: NDArray[np.float64]) -> None:
        self._problem, self._scheme, self._times = problem, scheme, times
        self._grid = grid(float(times[-1]), scheme.dt)
        self._stepper = scheme.stepper(problem)
        self._t: list[float] = []
        self._x: list[NDArray[np.float64]] = []
        self._marks: list[Mark] = []

    def run(self) -> Trajectory:
        """Make the steps; a failure ends the run with the last state."""
        status, detail = Status.SUCCESS, ""
        self._state, self._reached = self._stepper.start(), 0
        if self._times[0] == 0:
            self._keep(0.0, self._state.x, Mark(0, self._state))
        try:
            # Numbers that overflow end the run with a Status of their own.
            with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
                self._steps()
        except StepFailure as failure:
            status = failure.status
            time = self._grid.time(self._reached)
            detail = f"{failure.detail} This was in the step from t = {time:.6g} with dt = {self._grid.h:.6g}."
            if not self._t or self._t[-1] < time:
                self._keep(time, self._state.x, Mark(self._reached, self._state))
        return self._trajectory(status, detail)

    def _steps(self) -> None:
        for step in iterate(self._stepper, self._grid, 0, self._state):
            while len(self._t) < len(self._times) and self._grid.before(self._times[len(self._t)]) <= step.k:
                time = float(self._times[len(self._t)])
                self._keep(time, step.at(time, self._grid), Mark(step.k, step.before))
            self._state, self._reached = step.after, step.k + 1

    def _keep(self, t: float, x: NDArray[np.float64], mark: Mark) -> None:
        self._t.append(t)
        self._x.append(x)
        self._marks.append(mark)

    def _trajectory(self, status: Status, detail: str) -> Trajectory:
        return Trajectory(
            t=np.array(self._t),
            x=np.array(self._x),
            status=status,
            detail=detail,
            stats=self._stepper.work,
            problem=self._problem,
            scheme=self._scheme,
            between=_Steps(self._problem, self._scheme, self._grid, tuple(self._marks)),
        )


@dataclass(frozen=True, eq=False)
class _Steps(Between):
    """The straight lines between the steps; those around a time are made again from the last kept one before it."""

    problem: Problem
    scheme: TimeStepping
    grid: Grid
    marks: tuple[Mark, ...]

    def states(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """(1.48); nothing but the marks is stored, so the steps from a mark to the time are made again."""
        values = np.empty((len(times), *self.problem.x0.shape))
        stepper = self.scheme.stepper(self.problem)
        mark = Mark(0, stepper.start())
        for index, t in enumerate(times):
            values[index], mark = self._at(stepper, float(t), mark)
        return values

    def residuals(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """For the step that ends at or after each of the times of the marks."""
        stepper = self.scheme.stepper(self.problem)
        marked = zip(times, self.marks, strict=True)
        return np.array([self._residual(stepper, mark) if t > 0 else np.inf for t, mark in marked])

    def _at(self, stepper: Stepper, t: float, mark: Mark) -> tuple[NDArray[np.float64], Mark]:
        k = self.grid.before(t)
        mark = max((m for m in (mark, *self.marks) if m.k <= k), key=lambda m: m.k)
        if t <= 0 or not self.grid.steps:
            return mark.state.x, mark
        step = self._step(stepper, k, mark)
        return step.at(t, self.grid), Mark(k, step.before)

    def _step(self, stepper: Stepper, k: int, mark: Mark) -> Step:
        return next(step for step in iterate(stepper, self.grid, *mark) if step.k == k)

    def _residual(self, stepper: Stepper, mark: Mark) -> float:
        try:
            step = self._step(stepper, mark.k, mark)
            return self._residual_of(step) if step.after.v is None else np.inf
        except StepFailure:
            return np.inf

    def _residual_of(self, step: Step) -> float:
        h, t = self.grid.h, self.grid.time(step.k)
        drift = self.problem.velocity(t, step.before.x)
        reaction = (step.after.x - step.before.x) / h - drift
        rows = self.problem.rows_within(t + h, step.after.x, h * longest(drift) / 2)
        return distance_to_cone(reaction.ravel(), rows.jacobian(step.after.x))
