"""A scheme bound to one problem: what the loop over the steps works with."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, NamedTuple

from dincl.checks import bounded, describe
from dincl.constants import LARGEST
from dincl.errors import InvalidProblem, StepFailure
from dincl.status import Status
from dincl.work import Work

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from dincl.problem import Problem
    from dincl.run.grid import Output, TimeGrid


class StepState(NamedTuple):
    """Positions (N, d) and, for second-order schemes, velocities (N, d)."""

    x: NDArray[np.float64]
    v: NDArray[np.float64] | None = None


class Reached(NamedTuple):
    """The step that a run reached, its state, and why it went no further; None if nothing failed."""

    k: int
    state: StepState
    failure: StepFailure | None = None


class Stepper(ABC):
    """A scheme bound to one problem; what it stores between steps (lists, warm starts) does not change its results.

    Attributes
    ----------
    problem
        The problem that it is bound to.
    work
        Counters that the steps add to; ``advance`` counts the steps themselves.
    """

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        self.work = Work(degrees_of_freedom=problem.x0.size)

    def start(self) -> StepState:
        """The state at t = 0."""
        return StepState(self.problem.x0)

    @abstractmethod
    def step(self, t: float, h: float, state: StepState) -> StepState:
        """The state at t + h from the one at t, in new arrays; StepFailure if there is none."""

    def advance(self, on: TimeGrid, k: int, end: int, state: StepState, output: Output | None = None) -> Reached:
        """Make the steps from t_k to t_end, or until one fails or leaves the finite numbers; fill in the output."""
        for index in range(k, end):
            try:
                after = self.step(on.time(index), on.h, state)
            except StepFailure as failure:
                return Reached(index, state, failure)
            if not isinstance(after, StepState) or getattr(after.x, "shape", None) != state.x.shape:
                raise InvalidProblem(
                    f"scheme: {type(self).__name__}.step returned {describe(after)}: must be a dincl.StepState with x "
                    f"of shape {state.x.shape}"
                )
            if not bounded(after.x):
                detail = f"A coordinate is not a number, or exceeds {LARGEST:g} in magnitude."
                return Reached(index, state, StepFailure(Status.NON_FINITE, detail))
            self.work.steps += 1
            self.work.callbacks += 1
            if output is not None:
                output.fill(index, state, after)
            state = after
        return Reached(end, state)

    def velocity(self, t: float, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """The drift F(t, x), shape (N, d), counted; StepFailure if it cannot be evaluated."""
        self.work.drift_evaluations += 1
        return self.problem.velocity(t, x)
