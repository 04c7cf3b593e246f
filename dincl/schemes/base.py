"""What a scheme is, and what a time-stepping scheme is: a step, without the loop."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

from dincl.checks import number
from dincl.work import Work

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from dincl.problem import Problem
    from dincl.trajectory import Trajectory


class State(NamedTuple):
    """Positions (N, d) and, for second-order schemes, velocities (N, d)."""

    x: NDArray[np.float64]
    v: NDArray[np.float64] | None = None


class Stepper(ABC):
    """A scheme bound to one problem; what it keeps between steps (lists, warm starts) does not change its results."""

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        self.work = Work(degrees_of_freedom=problem.x0.size)

    def start(self) -> State:
        """The state at t = 0."""
        return State(self.problem.x0)

    @abstractmethod
    def step(self, t: float, h: float, state: State) -> State:
        """The state at t + h from the one at t, in new arrays; StepFailure if there is none."""

    def velocity(self, t: float, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """The drift, counted."""
        self.work.drift_evaluations += 1
        return self.problem.velocity(t, x)


@dataclass(frozen=True)
class Scheme(ABC):
    """A way to solve x' in F(t, x) - N(S, x), an object that ``solve`` is given."""

    @abstractmethod
    def run(self, problem: Problem, times: NDArray[np.float64]) -> Trajectory:
        """The solution at increasing ``times`` (K,) >= 0, or until it fails; InvalidProblem if it cannot serve."""


@dataclass(frozen=True)
class TimeStepping(Scheme):
    """A scheme with steps of length ``dt`` > 0 [time]; a run takes the next smaller length that divides it evenly."""

    dt: float = field()

    def __post_init__(self) -> None:
        object.__setattr__(self, "dt", number("dt", self.dt, positive=True))

    def run(self, problem: Problem, times: NDArray[np.float64]) -> Trajectory:
        """Equal steps of at most ``dt`` to the last of ``times``."""
        from dincl.time_stepping import run

        return run(problem, self, times)

    @abstractmethod
    def stepper(self, problem: Problem) -> Stepper:
        """Bind to a problem; InvalidProblem if the two do not go together."""
