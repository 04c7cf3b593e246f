"""The nearest point of S(t), with only the rows that matter."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.projection.base import NO_BACK_END, Projected, missed
from dincl.rows.affine import linearised

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dincl.constraints.selection import Selection
    from dincl.problem import Problem
    from dincl.projection.base import Solver
    from dincl.work import Work


class FeasibleSet:
    """S(t), or its inner convex approximation, of one problem; it stores near rows and a solver for one run."""

    def __init__(self, problem: Problem, solver: Solver, work: Work, *, linearised: bool) -> None:
        from dincl.system.compiled_problem import CompiledProblem

        self._system = CompiledProblem(problem, solver=solver)
        self._solver, self._work, self._linearised = solver, work, linearised

    @property
    def near_rows(self) -> Selection:
        """The rows that were looked at last."""
        return self._system.near_rows()

    def nearest(
        self,
        t: float,
        y: NDArray[np.float64],
        around: NDArray[np.float64],
        reach: float,
        *,
        carried_to: float | None = None,
    ) -> Projected:
        """P_S(y) at time t, searched from ``around`` (N, d), or P_{S~(around)}(y).

        The rows near ``around`` are used; a point within their ``reach`` can violate no other, so it is the nearest
        of the whole set. Else it is repeated with rows that reach twice as far as it ended. S~ of time t may be
        carried, each family along its own path, to a later time. StepFailure where there is none.
        """
        from dincl.steps.programs import project_once

        system, later, tol = self._system, t if carried_to is None else carried_to, self._solver.tol
        program = system.arrays.program
        program.y[:] = y.ravel()
        before = float(program.answer[0])
        with system.callbacks():
            code = project_once(system.place, t, around.ravel().copy(), reach, later, not self._linearised, tol)
        system.count(self._work)
        if code:
            system.failure(code, tol)
        if self._solver.whole:
            solving: Any = system.solving
            found: Projected = solving.found
            return found
        return self._certified(t, y, around, carried_to, round(float(system.arrays.program.answer[0]) - before))

    def _certified(
        self,
        t: float,
        y: NDArray[np.float64],
        around: NDArray[np.float64],
        carried_to: float | None,
        iterations: int,
    ) -> Projected:
        """What the system found last, with residuals recomputed from the rows."""
        system, near = self._system, self.near_rows
        arrays, x = system.arrays, system.arrays.program.z.reshape(y.shape).copy()
        rows = near.linearised(t, around, carried_to) if self._linearised else near.at(t)
        if not arrays.solving.called[0]:
            found = self._solver.certify(linearised(rows, x), y, x, np.zeros(len(near)), 0)
            return replace(found, back_end=NO_BACK_END)
        listed = np.sort(arrays.near.row[: int(arrays.near.number[0])])
        multipliers = arrays.program.multiplier[listed] / arrays.program.length[listed]
        found = self._solver.certify(linearised(rows, x), y, x, multipliers, iterations)
        # A sum of other order may round to the other side of the tolerance.
        if not found.residual <= self._solver.tol:
            raise system.reason(missed(self._solver.name, found.residual, self._solver.tol))
        return found
