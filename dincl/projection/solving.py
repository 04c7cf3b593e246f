"""Solvers as compiled projections call them, see ``dincl.system.arrays.Solving``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.errors import StepFailure
from dincl.matrices import from_rows
from dincl.steps.programs import near_program, take_solution
from dincl.system.callbacks import PythonFunction, numbers_at

if TYPE_CHECKING:
    from dincl.projection.base import Projected, Solver
    from dincl.projection.qp import QpSolver
    from dincl.system.compiled_problem import CompiledProblem


class ProgramSolving(PythonFunction):
    """A solver of quadratic programs in Python."""

    def __init__(self, solver: Any, system: CompiledProblem) -> None:
        super().__init__(self._solve)
        self._solver: QpSolver = solver
        self._system = system

    def _solve(self, tol: float, y: int, z: int, place: int, d: int, answer: int) -> None:
        arrays = self._system.arrays
        indptr, indices, data, missing, length, multipliers, _ = near_program(place)
        matrix = from_rows(indptr, indices, data, arrays.program.y.size)
        solver, program = self._solver, arrays.program
        try:
            found = solver.solve(matrix, missing, multipliers, tol / max(1.0, float(length.max(initial=1.0))))
        except StepFailure as failure:
            raise self._system.reason(failure) from failure
        if take_solution(place, found.u, found.multipliers) > tol:
            found = solver.put_right(matrix, missing, length, found, tol)
            take_solution(place, found.u, found.multipliers)
        program.answer[0] += found.iterations
        arrays.solving.called[0] = 1.0 if found.multipliers.any() else 0.0


class WholeSolving(PythonFunction):
    """A solver in Python that projects onto the set itself.

    Attributes
    ----------
    found
        What it found last.
    """

    found: Projected

    def __init__(self, solver: Solver, system: CompiledProblem) -> None:
        super().__init__(self._solve)
        self._solver, self._system = solver, system

    def _solve(self, t: float, around: int, z: int, place: int, d: int, question: int) -> None:
        arrays, shape = self._system.arrays, self._system.problem.x0.shape
        later, exact, self._solver.tol = (float(part) for part in arrays.solving.question[1:])
        near, x = self._system.near_rows(), numbers_at(around, shape).copy()
        target = near.at(t) if exact else near.linearised(t, x, later if later != t else None)
        self.found = self._solver.nearest(target, arrays.program.y.reshape(shape).copy(), x)
        arrays.program.z[:] = self.found.point.ravel()
        arrays.program.multiplier[np.sort(arrays.near.row[: int(arrays.near.number[0])])] = self.found.multipliers
        if self.found.solved:
            arrays.program.answer[0] += self.found.iterations
            arrays.solving.called[0] = 1.0
