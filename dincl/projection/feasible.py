"""The nearest point of S(t), with only the rows that matter."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dincl.constraints.rows import RowsTogether
from dincl.errors import StepFailure
from dincl.near import Near
from dincl.norms import longest
from dincl.projection.base import NO_BACK_END
from dincl.status import Status

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dincl.constraints.rows import AffineRows
    from dincl.problem import Problem
    from dincl.projection.base import Projected, Solver
    from dincl.work import Work

# A projection that ends farther away than the rows reach is repeated with twice its distance, at most this often.
MOST_REACHES = 60


class FeasibleSet:
    """S(t), or its inner convex approximation, of one problem; it keeps near rows and a solver for one run."""

    def __init__(self, problem: Problem, solver: Solver, work: Work, *, linearised: bool) -> None:
        self._constraints = problem.constraints
        self._near = Near(problem, work)
        self._solver = solver
        self._work = work
        self._linearised = linearised

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
        carried, each family along its own path, to a later time.
        """
        shifts = None if carried_to is None else self._shifts(t, carried_to, y.shape[1])
        for _ in range(MOST_REACHES):
            rows = self._near.rows(t, around, reach)
            target = self._linear(rows, around, shifts) if self._linearised else rows
            found = self._solver.nearest(target, y, around)
            if found.back_end != NO_BACK_END:
                self._work.count_call(found.back_end, found.iterations)
            distance = longest(found.point - around) + (0.0 if shifts is None else longest(shifts))
            if distance <= reach:
                return found
            reach = 2 * distance
        raise StepFailure(Status.NOT_CONVERGED, f"The projection moved a particle by more than {distance:g}.")

    def _shifts(self, t: float, later: float, d: int) -> NDArray[np.float64] | None:
        """How far each family is carried from t to a later time, shape (families, d); None if all are at rest."""
        paths = [(family.displacement(t, d), family.displacement(later, d)) for family in self._constraints]
        if all(start is None or end is None for start, end in paths):
            return None
        return np.array([np.zeros(d) if start is None or end is None else end - start for start, end in paths])

    def _linear(
        self, rows: RowsTogether, around: NDArray[np.float64], shifts: NDArray[np.float64] | None
    ) -> AffineRows:
        if shifts is None:
            return rows.linearised(around)
        pairs = zip(rows.blocks, shifts, strict=True)
        carried = tuple(block.linearised(around).shifted(shift) for block, shift in pairs)
        return RowsTogether(carried, rows.size).linearised(around)
