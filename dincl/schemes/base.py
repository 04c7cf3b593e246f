"""What a scheme is, and what a scheme of equal time steps is: a step, without the loop."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING

from dincl.checks import number

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from dincl.problem import Problem
    from dincl.run.outcome import RunOutcome
    from dincl.run.stepper import Stepper


@dataclass(frozen=True)
class Scheme(ABC):
    """A way to solve x' in F(t, x) - N(S, x), an object that ``solve`` is given."""

    @abstractmethod
    def run(self, problem: Problem, times: NDArray[np.float64]) -> RunOutcome:
        """The solution at increasing ``times`` (K,) >= 0, or until it fails; InvalidProblem if it cannot serve."""


@dataclass(frozen=True)
class FixedStep(Scheme):
    """A scheme with steps of length ``dt`` > 0 [time]; a run takes the next smaller length that divides it evenly.

    A subclass is a frozen dataclass; its further fields come after dt, and it says with ``stepper`` how a step is made.
    """

    dt: float = field()

    def __post_init__(self) -> None:
        object.__setattr__(self, "dt", number("dt", self.dt, positive=True))

    def run(self, problem: Problem, times: NDArray[np.float64]) -> RunOutcome:
        """Equal steps of at most ``dt`` to the last of ``times``."""
        from dincl.schemes.loop import run_steps

        return run_steps(partial(self.stepper, problem), self.dt, times)

    @abstractmethod
    def stepper(self, problem: Problem) -> Stepper:
        """Bind to a problem; InvalidProblem if the two do not go together."""
