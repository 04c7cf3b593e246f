"""What a minimiser is: an iteration for points and multipliers, without the loop."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING

import numpy as np

from dincl.checks import bounded, describe, integer
from dincl.constants import LARGEST
from dincl.errors import InvalidProblem, StepFailure
from dincl.minimise.iteration_rows import IterationRows
from dincl.minimise.stop import Stop
from dincl.norms import longest
from dincl.status import Status
from dincl.work import Work

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dincl.minimise.iteration_rows import Point
    from dincl.problem import Problem

# Steps after which an iteration gives up, unless told otherwise; nothing hangs.
LIMIT = 100_000


# Steps of the present length for which the small steps list near rows ahead.
AHEAD = 4.0


class Minimiser(ABC):
    """A way to find a local minimum of an energy over a set, an object that ``minimise`` is given.

    ``stop`` is the rule that ends it; after ``limit`` steps it gives up.
    """

    stop: Stop
    limit: int

    @abstractmethod
    def start(self, problem: Problem) -> Iteration:
        """Bind to a problem, at its x0 and with multipliers zero."""


class Iteration(ABC):
    """A minimiser at work on one problem; ``x`` (N, d) and the multipliers in ``rows`` are always finite."""

    # The length of a step in (3.24).
    dtau = 1.0

    def __init__(self, problem: Problem, *, squared: bool = False, ahead: float) -> None:
        self.problem = problem
        self.work = Work(degrees_of_freedom=problem.x0.size)
        self.rows = IterationRows(problem, self.work, squared=squared, ahead=ahead)
        self.x = problem.x0
        self.rows.update(self.x, 0.0)

    def point(self) -> Point:
        """The present x and multipliers, with all that belongs to them."""
        return self.rows.point(self.x, self.gradient(self.x))

    @abstractmethod
    def step(self, point: Point) -> None:
        """Go on from ``point``; StepFailure if that cannot be done."""

    def gradient(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """grad W = -F(0, x), counted."""
        self.work.drift_evaluations += 1
        return -self.problem.velocity(0.0, x)

    def move(self, x: NDArray[np.float64]) -> None:
        """Take a new x, and the rows near it."""
        if not bounded(x):
            raise StepFailure(Status.NON_FINITE, f"A coordinate is not a number, or exceeds {LARGEST:g} in magnitude.")
        length = longest(x - self.x)
        self.x = x
        self.rows.update(x, length)


def check_choices(stop: Stop, limit: int, squared: bool) -> None:
    """Raise InvalidProblem unless these can be the fields of a minimiser."""
    if not isinstance(stop, Stop):
        raise InvalidProblem(f"stop = {describe(stop)}: must be Stationary(tol) or RelativeMove(eps)")
    integer("limit", limit, least=1)
    if not isinstance(squared, bool):
        raise InvalidProblem(f"squared = {describe(squared)}: must be True or False")
