"""Steps that compiled code makes, many in one call."""

from __future__ import annotations

import time
from abc import abstractmethod
from typing import TYPE_CHECKING

import numpy as np

from dincl.errors import StepFailure
from dincl.kernels.system import OK, Steps
from dincl.run.bound import Reached, Stepper, StepState
from dincl.run.grid import TimeGrid
from dincl.run.small import SmallSystem

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dincl.problem import Problem
    from dincl.rows.near import Selection

# Steps in the first call; each call has twice as many as the last one while it takes less than this [s], so that an
# interrupt, or a budget, does not wait.
FEWEST, SHORT = 64, 0.02


class CompiledStepper(Stepper):
    """A scheme whose steps are a kernel, bound to a problem of few particles."""

    def __init__(self, problem: Problem, selection: Selection | None = None) -> None:
        super().__init__(problem)
        self.system = SmallSystem(problem, selection)

    @abstractmethod
    def call(self, steps: Steps, x: NDArray[np.float64], v: NDArray[np.float64]) -> tuple[int, int]:
        """Make the steps in x and v (N d,), in place; how it ended, see ``kernels.system``, and at which step."""

    def step(self, t: float, h: float, state: StepState) -> StepState:
        reached = self._go(t, TimeGrid(h, 1), 0, 1, state)
        if reached.failure:
            raise reached.failure
        return reached.state

    def advance(self, on: TimeGrid, k: int, end: int, state: StepState) -> Reached:
        first = k
        reached = self._go(0.0, on, k, end, state)
        self.work.steps += reached.k - first
        return reached

    def _go(self, origin: float, on: TimeGrid, k: int, end: int, state: StepState) -> Reached:
        shape = self.problem.x0.shape
        x, v = (np.array(part).ravel() if part is not None else np.zeros(0) for part in state)
        most, code = FEWEST, OK
        with self.system.drift, self.system.sets:
            while k < end and code == OK:
                began = time.perf_counter()
                code, k = self.call(Steps(origin, on.t_end, on.steps, k, min(end, k + most)), x, v)
                self.count()
                most = 2 * most if time.perf_counter() - began < SHORT else most
        reached = StepState(x.reshape(shape), v.reshape(shape) if v.size else None)
        try:
            if code != OK:
                self.fail(code)
        except StepFailure as failure:
            return Reached(k, reached, failure)
        return Reached(k, reached, None)

    def count(self) -> None:
        """Add what was done since this was asked last to the counters."""
        self.system.count(self.work)

    def fail(self, code: int) -> None:
        """Raise what this code stands for."""
        self.system.failure(code)
