"""Runs of an inclusion: states at output times, their overlap and error, how the run ended; and which are made next."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from dincl.errors import InvalidProblem, StepFailure
from dincl.norms import longest
from dincl.problem import Problem
from dincl.schemes import FixedStep
from dincl.status import Status
from dincl.steps.grid import Reached, TimeGrid
from verification.explore.inclusions.problems import METHODS, PICTURES, Floats, Inclusion, reference

Gone = Callable[[], bool]


class InclusionRun(NamedTuple):
    """Run to make: ``method`` is of METHODS; it makes ``steps`` steps, a power of 2, to ``end``."""

    inclusion: Inclusion
    method: str
    steps: int
    end: float

    @property
    def dt(self) -> float:
        """The step [time]."""
        return self.end / self.steps


class SavedState(NamedTuple):
    """A state.

    Attributes
    ----------
    t, x
        Time, and positions (N, d).
    deep
        Largest violation of a constraint that ties the particle, (N,).
    error
        Distance max_i |X_i - reference|; None where that is not known.
    status, detail
        Why the run ends here; SUCCESS and "" if it goes on, or is at its end.
    """

    t: float
    x: Floats
    deep: Floats
    error: float | None
    status: Status
    detail: str

    @property
    def overlap(self) -> float:
        """The largest violation of a constraint."""
        return float(self.deep.max())

    @property
    def fault(self) -> str:
        """The fault, and what to try; "" if there is none."""
        return "" if self.status else f"{self.status.value} {self.detail}".rstrip()


def integrate(run: InclusionRun, gone: Gone = lambda: False) -> Iterator[SavedState]:
    """Compute the states of ``solve`` at all steps, or at 128 equal times, and give each as it comes.

    ``gone`` is asked before each: once it says True no more come. A run that fails ends with the last state that it
    reached.

    Raises
    ------
    InvalidProblem
        If the method cannot serve the problem.
    """
    problem, grid, scheme = run.inclusion.problem, TimeGrid(run.end, run.steps), METHODS[run.method](run.dt)
    if not isinstance(scheme, FixedStep):
        raise InvalidProblem(f"{run.method}: must be a scheme with a step")
    stepper, known, every = scheme.stepper(problem), reference(problem, run.end).x, max(1, run.steps // PICTURES)
    reached = Reached(0, stepper.start())
    for k in range(0, run.steps + 1, every):
        if gone():
            return
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            reached = stepper.advance(grid, reached.k, k, reached.state)
        failure, t, x = reached.failure, grid.time(reached.k), reached.state.x
        place = reached.k * PICTURES / run.steps
        error = None if known is None or place % 1 else longest(x - known[int(place)])
        status, detail = (failure.status, failure.detail) if failure else (Status.SUCCESS, "")
        yield SavedState(t, x, depths(problem, t, x), error, status, detail)
        if failure:
            return


def depths(problem: Problem, t: float, x: Floats) -> Floats:
    """Return for each particle the largest violation of a constraint that ties it, (N,); inf where one is undefined."""
    deep = np.zeros(len(x))
    try:
        for block in problem.rows_within(t, x, 0.0).by_kind():
            depth = -block.values(x)
            violated = depth > 0
            if violated.any():
                # The derivative of squared distances is defined also where two centres coincide.
                matrix = block.take(violated).squared_jacobian(x)
                deepest = np.repeat(depth[violated], np.diff(matrix.indptr))
                np.maximum.at(deep, matrix.indices // x.shape[1], deepest)
    except StepFailure:
        deep[:] = np.inf
    return deep
