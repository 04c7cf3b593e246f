"""A problem as compiled code sees it: one table of rows, the drift by its address, arrays to write to."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, NoReturn

import numpy as np

from dincl.compiled.structs import StructPointer
from dincl.constants import LARGEST
from dincl.errors import StepFailure
from dincl.kernels import system as codes
from dincl.kernels.active_set import least_distance
from dincl.kernels.factor import room
from dincl.kernels.system import Drift, SystemArrays
from dincl.kernels.table import DISTANCE, room_for_list
from dincl.rows.near import select
from dincl.rows.table import tabulate
from dincl.run.drift_pointer import DriftPointer
from dincl.run.sets_pointer import SetsPointer
from dincl.run.units import Units
from dincl.status import Status

if TYPE_CHECKING:
    from collections.abc import Mapping

    from dincl.problem import Problem
    from dincl.rows.near import Selection
    from dincl.rows.sweeper import Sweeper
    from dincl.work import Work

ONE = Units()
NONE: Mapping[int, Sweeper] = {}
# The name in ``Work.back_ends``.
NAME = "active set"
FAILURES = {
    codes.INFEASIBLE: (Status.INFEASIBLE, f"{NAME}: no point meets all constraints."),
    codes.CYCLES: (Status.NOT_CONVERGED, f"{NAME}: rounding keeps it from an answer."),
    codes.TOO_FAR: (Status.NOT_CONVERGED, "The projection moved a particle again and again beyond the rows looked at."),
    codes.NOT_A_NUMBER: (Status.NON_FINITE, f"A coordinate is not a number, or exceeds {LARGEST:g} in magnitude."),
    codes.SINGULAR: (Status.NOT_CONVERGED, "Gradients of the contacts that are held became dependent."),
}


class SmallSystem:
    """A problem, bound to one run.

    Attributes
    ----------
    problem
        Which one.
    selection
        The rows in its table: all of them, if not given.
    units
        In which the arrays are; the problem and its functions keep their own.
    solver
        Whether programs are solved for the rows in the table, which takes more memory.
    arrays, place
        What kernels take, and the handle by which they do; they may be called inside of ``with drift, sets``.
    drift, sets
        What the arrays point to.
    """

    def __init__(
        self,
        problem: Problem,
        selection: Selection | None = None,
        units: Units = ONE,
        *,
        sweepers: Mapping[int, Sweeper] = NONE,
        solver: bool = True,
    ) -> None:
        self.problem, self.units = problem, units
        if selection is None:
            selection = select(problem.constraints, 0.0, problem.x0, np.inf)
        self.selection = selection
        n, d = problem.x0.size, problem.x0.shape[1]
        rows, called = tabulate(self.selection.blocks, n, d, n if solver else 0)
        rows.row["length"] /= units.length
        rows.coefficient[np.repeat(rows.row["kind"] == DISTANCE, np.diff(rows.start))] /= units.length
        self.drift, self.sets = DriftPointer(problem), SetsPointer(self.selection, called, units, sweepers)
        m, families = len(rows.row), len(problem.constraints)
        most = min(m, n) + 1 if solver else 1
        self.arrays = SystemArrays(
            rows=rows,
            sets=self.sets.arrays,
            near=room_for_list(m, n, families, d),
            program=least_distance(np.zeros(len(rows.column)), np.zeros(m), np.zeros(m), n),
            chosen=room(most, n),
            drift=Drift(
                self.drift.address,
                self.drift.data,
                np.zeros(2, dtype=np.int64),
                np.zeros(1 + 2 * n),
                np.array([units.time, units.length, units.speed]),
                np.zeros(n),
            ),
            velocity=np.zeros(n),
            middle=np.zeros(n),
            move=np.zeros((families, d)),
            blamed=np.zeros(1, dtype=np.int64),
        )
        self._pointer = self.sets.system = StructPointer(self.arrays)
        self.place = self._pointer.address
        self._counted = (0, 0, 0.0, 0.0, 0)

    @cached_property
    def names(self) -> tuple[tuple[int, str], ...]:
        """For each row of the table the index of its constraint, and the row in words."""
        return self.selection.names

    def count(self, work: Work) -> None:
        """Add what was done since this was asked last, and tell the drift."""
        arrays, before = self.arrays, self._counted
        drifts, builds = int(arrays.drift.calls[0]), int(arrays.near.number[1])
        iterations, calls = float(arrays.program.answer[0]), float(arrays.program.answer[2])
        self._counted = (drifts, builds, iterations, calls, self.sets.calls)
        work.drift_evaluations += drifts - before[0]
        work.neighbour_builds += builds - before[1]
        work.solver_iterations += round(iterations - before[2])
        work.solver_calls += round(calls - before[3])
        work.callbacks += self.sets.calls - before[4]
        if calls > 0 and NAME not in work.back_ends:
            work.back_ends += (NAME,)
        self.drift.made(drifts - before[0])

    def failure(self, code: int, tol: float = 0.0) -> NoReturn:
        """Raise StepFailure, or what a function of the user raised, for the code by which a kernel ended."""
        arrays = self.arrays
        if self.sets.failed:
            self.sets.failure()
        if code == codes.DRIFT:
            at, n = arrays.drift.failed, arrays.velocity.size
            self.drift.failure(float(at[0]), at[1 : n + 1], at[n + 1 :], int(arrays.drift.calls[1]))
        if code == codes.COINCIDENT:
            name = self.names[int(arrays.blamed[0])][1]
            raise StepFailure(Status.COINCIDENT_CENTRES, f"Two centres lie on one point: {name}.")
        if code == codes.MISSED:
            residual = float(arrays.program.answer[1])
            detail = f"{NAME} left a residual of {residual:.2g}, asked for was {tol:.2g}."
            raise StepFailure(Status.NOT_CONVERGED, detail)
        raise StepFailure(*FAILURES[code])
