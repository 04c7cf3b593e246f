"""Bias of simpler models without random numbers: their distance from a reference whose error is known."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from dincl.equivalence.bias import Bias
from dincl.equivalence.search import Row, compared
from dincl.errors import InvalidProblem

Floats = NDArray[np.float64]
Result = TypeVar("Result")
# A stated error over the difference of two refinements.
SAFETY = 2.0
# A run is repeated until it was measured for so long [s], at most so often; the first one may compile.
LEAST_SECONDS, MOST_REPEATS = 0.1, 5


class RunCost(NamedTuple):
    """CPU time of a run [s] and its counted work."""

    seconds: float
    work: float


class Solved(NamedTuple):
    """Quantity of a model at the accuracy asked for and at finer ones, and the cost of the first."""

    values: tuple[object, ...]
    cost: RunCost


class NoQuantity(Exception):
    """A model that gives no quantity; the message is the reason."""


@dataclass(frozen=True)
class FullSolution:
    """Quantity of the full model with its error.

    Attributes
    ----------
    value
        Of the finest solution.
    error
        SAFETY times its distance from the second finest one. Of a method of order 1 whose step was halved this is
        twice the error, of one of higher order more.
    cost
        Of the full model at the accuracy asked for.
    """

    value: object
    error: float
    cost: RunCost


def reference(full: Solved, distance: Callable[[object, object], float]) -> FullSolution:
    """Take the finest solution of the full model, of two or more, as the reference."""
    *_, coarse, fine = full.values
    return FullSolution(fine, SAFETY * abs(distance(coarse, fine)), full.cost)


@dataclass(frozen=True)
class ErrorBounds:
    """Decisions by bounds of errors: the bias of a model is known to the error of the reference.

    A model is compared as it runs, with its own step, so that this step is a part of its bias. It also runs with half
    of the step, and the larger one of both biases counts: a model that agrees at one step by chance is not enough.

    Attributes
    ----------
    full
        FullSolution.
    solve
        Name of a model -> its quantity and cost; raises NoQuantity.
    distance
        Two quantities -> their difference, first minus second, or a distance >= 0.
    tolerance
        The largest bias that does not matter.
    """

    full: FullSolution
    solve: Callable[[str], Solved]
    distance: Callable[[object, object], float]
    tolerance: float

    def decide(self, models: Sequence[str], error: float, *, again: bool) -> list[Row]:
        """Return the row of each model; ``error`` and ``again`` are for models with random numbers."""
        return [self._row(model) for model in models]

    def _row(self, model: str) -> Row:
        try:
            solved = self.solve(model)
        except NoQuantity as failure:
            return compared(model, None, cpu=np.nan, work=np.nan, reason=str(failure))
        bias = max((self.distance(value, self.full.value) for value in solved.values), key=abs)
        one = Bias(bias, bias, bias, self.tolerance).widened(self.full.error)
        own, full = solved.cost, self.full.cost
        return compared(model, one, cpu=own.seconds / full.seconds, work=own.work / max(full.work, 1.0))


def largest_difference(first: object, second: object) -> float:
    """Return first - second of single numbers, max_i |first_i - second_i| of arrays of one shape.

    Raises InvalidProblem for arrays of different shapes.
    """
    a, b = np.asarray(first, dtype=np.float64), np.asarray(second, dtype=np.float64)
    if a.shape != b.shape:
        raise InvalidProblem(f"quantity of shapes {a.shape} and {b.shape}: must have one shape for all models")
    return float((a - b).item()) if a.size == 1 else float(np.abs(a - b).max(initial=0.0))


def timed(run: Callable[[], Result]) -> tuple[Result, float]:
    """Run until LEAST_SECONDS are measured, at least twice; return the result and the least CPU time of a run [s]."""
    seconds: list[float] = []
    while len(seconds) < 2 or (sum(seconds) < LEAST_SECONDS and len(seconds) < MOST_REPEATS):
        began = time.process_time()
        result = run()
        seconds.append(time.process_time() - began)
    return result, max(min(seconds), 1e-9)
