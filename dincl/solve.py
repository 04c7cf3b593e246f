"""The user's verb: run a scheme on a problem and keep the states asked for."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dincl.checks import array, describe
from dincl.errors import InvalidProblem, StepFailure
from dincl.problem import Problem
from dincl.schemes.base import Scheme
from dincl.status import Status
from dincl.stepping import grid, iterate
from dincl.trajectory import Mark, StepFailed, Trajectory

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


def solve(problem: Problem, scheme: Scheme, t: ArrayLike, *, throw: bool = True) -> Trajectory:
    """Approximate x' in F(t, x) - N(S, x), x(0) = x0, with the steps of ``scheme``.

    Parameters
    ----------
    problem, scheme
        What to solve, and how.
    t
        Times to keep, shape (K,), K >= 1, >= 0, increasing; the last one ends the run. The steps are the fewest equal
        ones of at most ``scheme.dt`` that end there; a kept time between two steps is interpolated (1.48).
    throw
        Whether a run that fails raises; otherwise its Trajectory comes back with the Status.

    Raises
    ------
    InvalidProblem
        For times that are not increasing, or a scheme that cannot serve the problem.
    StepFailed
        When a step fails and ``throw`` is true; ``trajectory`` holds all until then.
    """
    if not isinstance(problem, Problem):
        raise InvalidProblem(f"problem = {describe(problem)}: must be a dincl.Problem")
    if not isinstance(scheme, Scheme):
        raise InvalidProblem(f"scheme = {describe(scheme)}: must be a scheme such as PBD(dt=1e-3)")
    trajectory = _Run(problem, scheme, _times(t)).run()
    if throw and not trajectory.status:
        raise StepFailed(trajectory)
    return trajectory


class _Run:
    """Steps and keeps."""

    def __init__(self, problem: Problem, scheme: Scheme, times: NDArray[np.float64]) -> None:
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
            grid=self._grid,
            marks=tuple(self._marks),
        )


def _times(t: ArrayLike) -> NDArray[np.float64]:
    times = np.atleast_1d(array("t", t))
    if times.ndim != 1 or times.size == 0 or times[0] < 0 or (np.diff(times) <= 0).any():
        raise InvalidProblem(f"t = {describe(t)}: must be one or more increasing times >= 0")
    return times
