"""A scheme bound to one problem: what the loop over the steps works with."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, NamedTuple

from dincl.work import Work

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from dincl.problem import Problem


class StepState(NamedTuple):
    """Positions (N, d) and, for second-order schemes, velocities (N, d)."""

    x: NDArray[np.float64]
    v: NDArray[np.float64] | None = None


class Stepper(ABC):
    """A scheme bound to one problem; what it keeps between steps (lists, warm starts) does not change its results.

    Attributes
    ----------
    problem
        The problem that it is bound to.
    work
        Counters that the steps add to; the loop counts the steps themselves.
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

    def velocity(self, t: float, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """The drift F(t, x), shape (N, d), counted; StepFailure if it cannot be evaluated."""
        self.work.drift_evaluations += 1
        return self.problem.velocity(t, x)
