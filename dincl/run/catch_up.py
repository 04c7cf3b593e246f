"""Catch-up schemes, bound to a problem and a projection."""

from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.kernels.steps import ProjectionArrays
from dincl.kernels.system import PYTHON
from dincl.projection.feasible import FeasibleSet
from dincl.run.callback import Callback
from dincl.run.compiled import CompiledStepper
from dincl.run.drift_pointer import C_FUNCTION, PLACE
from dincl.run.families import no_rows
from dincl.run.small import SmallSystem

if TYPE_CHECKING:
    from dincl.problem import Problem
    from dincl.projection.base import Projection, Solver


class CatchUpStepper(CompiledStepper):
    """A catch-up scheme whose compiled step calls the projection that it is given."""

    def __init__(self, problem: Problem, step: Any, projection: Projection, *, linearised: bool) -> None:
        projection.check(problem)
        compiled = projection.compiled(len(problem.x0), linearised=linearised)
        system = SmallSystem(problem) if compiled else SmallSystem(problem, no_rows(problem), solver=False)
        project: Any = compiled or PythonProjection()
        program, around = system.arrays.program, np.zeros(problem.x0.size)
        arrays = ProjectionArrays(project.address, program.y, around, program.z, np.zeros(3))
        super().__init__(problem, step, [projection.tol], system=system, projection=arrays)
        self._python: PythonProjection | None = None if compiled else project
        if self._python:
            solver = projection.solver()
            feasible = FeasibleSet(problem, solver, self.work, linearised=linearised)
            self._python.bind(feasible, solver, arrays, problem.x0.shape)
            self.callbacks.append(self._python)

    def fail(self, code: int) -> None:
        if self._python:
            self._python.failure()
        super().fail(code)


class PythonProjection(Callback):
    """A projection that Python makes, called by compiled steps.

    Attributes
    ----------
    address
        That of the function, see ``dincl.kernels.steps.ProjectionArrays``.
    """

    def __init__(self) -> None:
        self._error: BaseException | None = None
        self.python: Any = self._answer
        self._callback = C_FUNCTION(self.python)
        self.address = int(ctypes.cast(self._callback, PLACE).value or 0)

    def bind(self, feasible: FeasibleSet, solver: Solver, arrays: ProjectionArrays, shape: tuple[int, ...]) -> None:
        """Say onto what and by whom, and where the points are."""
        self._feasible, self._solver, self._arrays, self._shape = feasible, solver, arrays, shape

    def keep(self, error: BaseException) -> None:
        self._error = error

    def failure(self) -> None:
        """Raise what the projection raised, if anything."""
        error, self._error = self._error, None
        if error is not None:
            raise error

    def _answer(self, t: float, around: int, z: int, place: int, d: int, question: int) -> int:
        arrays = self._arrays
        later, reach, self._solver.tol = (float(part) for part in arrays.question)
        try:
            y, near = (part.reshape(self._shape).copy() for part in (arrays.y, arrays.around))
            carried_to = later if later != t else None
            arrays.z[:] = self._feasible.nearest(t, y, near, reach, carried_to=carried_to).point.ravel()
        except BaseException as error:  # noqa: BLE001  # raised again by ``failure``; here it would be printed
            self.keep(error)
            return PYTHON
        return 0
