"""Steps that compiled code makes, many in one call."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.compiled.arrays import axes_of
from dincl.compiled.structs import StructPointer
from dincl.errors import StepFailure
from dincl.steps import loop
from dincl.steps.grid import Output, Reached, Stepper, StepState, TimeGrid
from dincl.steps.loop import OutputArrays, Settings, Stepping
from dincl.steps.sweeps import NO_FAMILIES
from dincl.steps.swept_sets import SweptSets
from dincl.system.arrays import NEED_ROOM, OK
from dincl.system.compiled_problem import CompiledProblem
from dincl.system.time_scales import smooth_pieces

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from dincl.problem import Problem
    from dincl.projection.certificate import Projection

# In the first call, particles times steps; each call makes twice as many steps as the last one while it takes less than
# this [s], so that an interrupt, or a budget, does not wait.
FIRST, SHORT = 6400, 0.02
NO_OUTPUT = StructPointer(loop.NO_OUTPUT)


class CompiledStepper(Stepper):
    """A scheme whose step is compiled, bound to a problem.

    Parameters
    ----------
    run
        The kernel of the scheme, which calls a loop made by ``dincl.steps.loop.loop_of``.
    settings
        The parameters of the scheme.
    system
        The drift, the sets and their rows.
    swept
        The sets of schemes that make sweeps.
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
        run: Any,
        settings: Settings,
        *,
        system: CompiledProblem,
        swept: SweptSets | None = None,
        v0: NDArray[np.float64] | None = None,
    ) -> None:
        super().__init__(problem)
        self._run, self._swept, self._v0, self.system = run, swept, v0, system
        self._prepared, self._axes = False, axes_of(problem.x0) if swept else ()
        n = problem.x0.size
        self.pointer = StructPointer(
            Stepping(
                system=system.place,
                families=NO_FAMILIES if swept is None else swept.arrays,
                x=np.zeros(n),
                v=np.zeros(0 if v0 is None else n),
                after=np.zeros(n),
                rate=np.zeros(n),
                repeats=np.zeros(1, dtype=np.int64),
                settings=settings,
            )
        )

    @classmethod
    def sweeping(
        cls,
        problem: Problem,
        run: Any,
        settings: Settings,
        *,
        of_any: Any = None,
        multipliers: bool = False,
        v0: NDArray[np.float64] | None = None,
    ) -> CompiledStepper:
        """Bind a scheme that takes one row after another; with ``multipliers`` each row has one.

        The kernel ``of_any`` is taken for discs in scaled coordinates or a periodic box, where that is another one.
        """
        swept = SweptSets(problem, multipliers=multipliers)
        run = run if swept.plain or of_any is None else of_any
        system = CompiledProblem.for_sweeps(problem, swept.selection)
        system.functions += swept.searches
        system.sets.updates += swept.updates
        return cls(problem, run, settings, system=system, swept=swept, v0=v0)

    @classmethod
    def projecting(cls, problem: Problem, run: Any, projection: Projection, settings: Settings) -> CompiledStepper:
        """Bind a scheme that projects onto S, or onto its linearisation, in each step."""
        system = CompiledProblem.for_projections(problem, exact=settings.exact != 0)
        return cls(problem, run, settings._replace(tol=projection.tol), system=system)

    def start(self) -> StepState:
        return StepState(self.problem.x0, self._v0)

    def step(self, t: float, h: float, state: StepState) -> StepState:
        reached = self._steps(TimeGrid(h, 1, origin=t), 0, 1, state, None)
        if reached.failure:
            raise reached.failure
        return reached.state

    def advance(self, on: TimeGrid, k: int, end: int, state: StepState, output: Output | None = None) -> Reached:
        if not self._prepared:
            self.prepare((on,), np.zeros(0))
        reached = self._steps(on, k, end, state, output)
        self.work.steps += reached.k - k
        return reached

    def prepare(self, grids: Sequence[TimeGrid], times: NDArray[np.float64]) -> None:
        """Tabulate the sets that depend on time alone, so that compiled code evaluates them."""
        self.system.sets.tabulate(smooth_pieces(self.problem, grids, times), compares=self._swept is None)
        self._prepared = True

    def _steps(self, on: TimeGrid, k: int, end: int, state: StepState, output: Output | None) -> Reached:
        """Make the steps k ... end - 1 of a grid."""
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
                grid = on._replace(first=k, last=min(end, k + most))
                code, k = self._run(self.pointer.address, grid, table.address, self._axes)
                if self._swept:
                    self._swept.count(self.work)
                self.system.count(self.work)
                if code == NEED_ROOM:
                    self._make_room()
                    code = OK
                most = 2 * most if time.perf_counter() - began < SHORT else most
        reached = StepState(run.x.reshape(shape).copy(), run.v.reshape(shape).copy() if run.v.size else None)
        try:
            if code != OK:
                self.fail(code)
        except StepFailure as failure:
            return Reached(k, reached, failure)
        return Reached(k, reached)

    def _make_room(self) -> None:
        """Make arrays longer in which something had no room; the step is repeated."""
        if self._swept:
            self._swept.make_room()
            self.pointer.value.repeats[0] = 1

    def fail(self, code: int) -> None:
        """Raise StepFailure, or what a function of the user raised, for the code by which a step ended."""
        self.system.raise_errors()
        if self._swept:
            self._swept.failure(code)
        self.system.failure(code, self.pointer.value.settings.tol)


def _arrays(output: Output, n: int) -> OutputArrays:
    x, before, velocity = (part.reshape(-1, n) for part in (output.x, output.before, output.velocity))
    return OutputArrays(output.step, output.weight, x, before, velocity, output.filled)
