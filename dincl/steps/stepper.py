"""Steps that compiled code makes, many in one call."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.compiled.structs import StructPointer
from dincl.errors import StepFailure
from dincl.steps import loop
from dincl.steps.grid import Output, Reached, Stepper, StepState, TimeGrid
from dincl.steps.loop import NO_PROJECTION, OutputArrays, ProjectionArrays, Stepping, StepRange, advance
from dincl.steps.sweeps import NO_FAMILIES
from dincl.steps.swept_sets import SweptSets
from dincl.system.arrays import OK
from dincl.system.compiled_problem import CompiledProblem

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from dincl.problem import Problem
    from dincl.projection.base import Projection

# In the first call, particles times steps; each call makes twice as many steps as the last one while it takes less than
# this [s], so that an interrupt, or a budget, does not wait.
FIRST, SHORT = 6400, 0.02
NO_OUTPUT = StructPointer(loop.NO_OUTPUT)


class CompiledStepper(Stepper):
    """A scheme whose step is compiled, bound to a problem.

    Parameters
    ----------
    step
        The step, compiled by ``dincl.steps.loop.step_function``.
    setting
        The numbers that the step reads from setting[1], setting[2], ...
    system
        The drift, the sets and their rows.
    swept, projection
        The sets of schemes that make sweeps, or the projection of schemes that have one.
    v0
        Velocity at the start, (N, d), of a second-order scheme.

    Attributes
    ----------
    system
        The problem as compiled code sees it.
    pointer
        The ``Stepping`` that kernels are given.
    """

    def __init__(
        self,
        problem: Problem,
        step: Any,
        setting: Sequence[float],
        *,
        system: CompiledProblem,
        swept: SweptSets | None = None,
        projection: ProjectionArrays = NO_PROJECTION,
        v0: NDArray[np.float64] | None = None,
    ) -> None:
        super().__init__(problem)
        self._step, self._swept, self._v0, self.system = step, swept, v0, system
        system.sets.work = self.work
        n = problem.x0.size
        self.pointer = StructPointer(
            Stepping(
                place=system.place,
                families=NO_FAMILIES if swept is None else swept.arrays,
                x=np.zeros(n),
                v=np.zeros(0 if v0 is None else n),
                after=np.zeros(n),
                rate=np.zeros(n),
                setting=np.array([0.0, *setting]),
                projection=projection,
            )
        )

    @classmethod
    def sweeping(
        cls,
        problem: Problem,
        step: Any,
        setting: Sequence[float],
        *,
        projected: bool = True,
        v0: NDArray[np.float64] | None = None,
    ) -> CompiledStepper:
        """Bind a scheme that takes one row after another; projections of the user are made if ``projected``."""
        swept = SweptSets(problem, projected=projected)
        system = CompiledProblem(problem, swept.selection, custom_sweeps=swept.custom_sweeps, programs=False)
        system.functions += swept.searches
        system.sets.updates += swept.updates
        return cls(problem, step, setting, system=system, swept=swept, v0=v0)

    @classmethod
    def correcting(cls, problem: Problem, step: Any, setting: Sequence[float]) -> CompiledStepper:
        """Bind a scheme that corrects one row of the table after another, with a multiplier for each."""
        system = CompiledProblem(problem, programs=False)
        program, n = system.arrays.program, problem.x0.size
        arrays = ProjectionArrays(0, program.y, np.zeros(n), program.z, np.zeros(4))
        return cls(problem, step, setting, system=system, projection=arrays)

    @classmethod
    def projecting(cls, problem: Problem, step: Any, projection: Projection, *, linearised: bool) -> CompiledStepper:
        """Bind a scheme that projects onto S, or onto its linearisation, in each step."""
        from dincl.steps.catch_up import nearest_point

        projection.check(problem)
        system = CompiledProblem(problem, solver=projection.solver())
        program, question = system.arrays.program, np.array([0.0, 0.0, 0.0, not linearised])
        arrays = ProjectionArrays(nearest_point.address, program.y, np.zeros(problem.x0.size), program.z, question)
        return cls(problem, step, [projection.tol], system=system, projection=arrays)

    def start(self) -> StepState:
        return StepState(self.problem.x0, self._v0)

    def step(self, t: float, h: float, state: StepState) -> StepState:
        reached = self._steps(t, TimeGrid(h, 1), 0, 1, state, None)
        if reached.failure:
            raise reached.failure
        return reached.state

    def advance(self, on: TimeGrid, k: int, end: int, state: StepState, output: Output | None = None) -> Reached:
        reached = self._steps(0.0, on, k, end, state, output)
        self.work.steps += reached.k - k
        return reached

    def _steps(self, origin: float, on: TimeGrid, k: int, end: int, state: StepState, output: Output | None) -> Reached:
        """Make the steps k ... end - 1 of a grid whose t_0 is ``origin``."""
        shape, run = self.problem.x0.shape, self.pointer.value
        run.x[:] = state.x.ravel()
        if run.v.size:
            v = self._v0 if state.v is None else state.v
            run.v[:] = np.asarray(v).ravel()
        table = NO_OUTPUT if output is None else StructPointer(_arrays(output, run.x.size))
        most, code = max(FIRST // len(self.problem.x0), 1), OK
        with self.system.callbacks():
            while k < end and code == OK:
                began = time.perf_counter()
                grid = StepRange(origin, on.t_end, on.steps, k, min(end, k + most))
                code, k = advance(self.pointer.address, self._step.address, grid, table.address)
                if self._swept:
                    self._swept.count(self.work)
                self.system.count(self.work)
                most = 2 * most if time.perf_counter() - began < SHORT else most
        reached = StepState(run.x.reshape(shape).copy(), run.v.reshape(shape).copy() if run.v.size else None)
        try:
            if code != OK:
                self.fail(code)
        except StepFailure as failure:
            return Reached(k, reached, failure)
        return Reached(k, reached)

    def fail(self, code: int) -> None:
        """Raise StepFailure, or what a function of the user raised, for the code by which a step ended."""
        self.system.raise_errors()
        if self._swept:
            self._swept.failure(code)
        self.system.failure(code, float(self.pointer.value.setting[-1]))


def _arrays(output: Output, n: int) -> OutputArrays:
    x, before, velocity = (part.reshape(-1, n) for part in (output.x, output.before, output.velocity))
    return OutputArrays(output.step, output.weight, x, before, velocity, output.filled)
