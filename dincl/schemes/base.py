"""Schemes: base classes, and the run of a scheme of equal time steps with the straight lines between the steps."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from dincl.checks import number
from dincl.errors import StepFailure
from dincl.forces import Reaction
from dincl.norms import longest
from dincl.status import Status
from dincl.steps.grid import Output, Reached, Stepper, StepState, TimeGrid, divide_time
from dincl.trajectory import Between, RunOutcome

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from dincl.problem import Problem


@dataclass(frozen=True)
class Scheme(ABC):
    """A way to solve x' in F(t, x) - N(S, x), an object that ``solve`` is given."""

    @abstractmethod
    def run(self, problem: Problem, times: NDArray[np.float64]) -> RunOutcome:
        """Compute the solution at increasing ``times`` (K,) >= 0, or until it fails; InvalidProblem if it cannot."""


@dataclass(frozen=True)
class FixedStep(Scheme):
    """A scheme with steps of length ``dt`` > 0 [time]; a run takes the next smaller length that divides it evenly.

    A subclass is a frozen dataclass; its further fields come after dt, and ``stepper`` makes its steps.
    """

    dt: float = field()

    def __post_init__(self) -> None:
        object.__setattr__(self, "dt", number("dt", self.dt, positive=True))

    def run(self, problem: Problem, times: NDArray[np.float64]) -> RunOutcome:
        """Make equal steps of at most ``dt`` to the last of ``times``."""
        return run_steps(partial(self.stepper, problem), self.dt, times)

    @abstractmethod
    def stepper(self, problem: Problem) -> Stepper:
        """Bind to a problem; InvalidProblem if the two do not go together."""


def run_steps(bind: Callable[[], Stepper], dt: float, times: NDArray[np.float64]) -> RunOutcome:
    """Make equal steps of at most ``dt`` until the last of ``times`` (K,), or until one fails.

    ``bind()`` makes a Stepper; it is stored, and must pickle for the outcome to pickle.
    """
    grid, stepper = divide_time(float(times[-1]), dt), bind()
    start = stepper.start()
    output = Output(grid, times, start)
    # Numbers that overflow end the run with a Status of their own.
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        reached = stepper.advance(grid, 0, grid.steps, start, output)
    count = int(output.filled[0])
    t, x, last = times[:count].copy(), output.x[:count], None
    status, detail, failure = Status.SUCCESS, "", reached.failure
    if failure is not None:
        status, time = failure.status, grid.time(reached.k)
        detail = f"{failure.detail} This was in the step from t = {time:.6g} with dt = {grid.h:.6g}."
        if not count or t[-1] < time:
            t, x = np.append(t, time), np.concatenate((x, reached.state.x[None]))
            last = reached
    return RunOutcome(t, x, status, detail, stepper.work, StraightLines(bind, grid, output, last), failure=failure)


@dataclass(frozen=True, eq=False)
class StraightLines(Between):
    """Straight lines between the steps; the steps around a time are repeated from a stored state before it.

    ``bind()`` makes a new Stepper of the scheme for the problem: repeated steps do not add to the work of the run.
    Stored are the states before the steps of the output times, and the ``last`` one of a run that failed.
    """

    bind: Callable[[], Stepper]
    grid: TimeGrid
    output: Output
    last: Reached | None = None

    def states(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """Compute x between two steps by (1.48)."""
        stepper, steps = self.bind(), self.grid.before(times)
        values = np.empty((len(times), *stepper.problem.x0.shape))
        k, state = 0, stepper.start()
        for index, (step, weight) in enumerate(zip(steps, self.grid.weights(times, steps), strict=True)):
            stored = self._stored_before(int(step))
            if stored.k > k:
                k, state = stored.k, stored.state
            if times[index] > 0 and self.grid.steps:
                state, after = self._step(stepper, int(step), k, state)
                k, values[index] = int(step), state.towards(after, float(weight))
            else:
                values[index] = state.x
        return values

    def reactions(self, times: NDArray[np.float64]) -> list[Reaction | None]:
        """Compute the reactions of the steps that end at or after each time; None at the start."""
        stepper, found = self.bind(), list[Reaction | None]()
        k, state = 0, stepper.start()
        for step, t in zip(self.grid.before(times).tolist(), times, strict=True):
            stored = self._stored_before(step)
            if stored.k > k:
                k, state = stored.k, stored.state
            try:
                if not (t > 0 and self.grid.steps):
                    found.append(None)
                    continue
                state, after = self._step(stepper, step, k, state)
                k = step
                found.append(step_reaction(stepper.problem, self.grid.time(k), self.grid.h, state, after.x))
            except StepFailure:
                found.append(None)
        return found

    def _stored(self, q: int) -> Reached:
        """Return the step and state of output time q."""
        if self.last is not None and q == self.output.filled[0]:
            return self.last
        v = self.output.velocity[q] if len(self.output.velocity) else None
        return Reached(int(self.output.step[q]), StepState(self.output.before[q], v, self.output.memory[q]))

    def _stored_before(self, step: int) -> Reached:
        """Return the last stored state at or before a step; without any, step -1."""
        if self.last is not None and self.last.k <= step:
            return self.last
        q = int(np.searchsorted(self.output.step[: int(self.output.filled[0])], step, side="right")) - 1
        return self._stored(q) if q >= 0 else Reached(-1, StepState(np.zeros(0)))

    def _step(self, stepper: Stepper, step: int, k: int, state: StepState) -> tuple[StepState, StepState]:
        """Compute the states before and after a step, from the state at step k; StepFailure if there is none."""
        before = stepper.advance(self.grid, k, step, state)
        after = before if before.failure else stepper.advance(self.grid, step, step + 1, before.state)
        if after.failure:
            raise after.failure
        return before.state, after.state


def step_reaction(problem: Problem, t: float, h: float, before: StepState, after: NDArray[np.float64]) -> Reaction:
    """Compute (after - before) / h - F(t, before) of a step, or of second order ((after - before) / h - v) / h - F."""
    drift = velocity = problem.velocity(t, before.x)
    rate = (after - before.x) / h
    if before.v is not None:
        rate, velocity = (rate - before.v) / h, before.v + h * drift
    value = (rate - drift).ravel()
    return Reaction(t + h, after, value, h * longest(velocity) / 2, second_order=before.v is not None)
