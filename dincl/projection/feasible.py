"""The nearest point of S(t), with only the rows that matter."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dincl.errors import StepFailure
from dincl.norms import longest
from dincl.projection.base import NO_BACK_END
from dincl.rows.near import Near
from dincl.status import Status

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from dincl.problem import Problem
    from dincl.projection.base import Projected, Solver
    from dincl.work import Work

# A projection that ends farther away than the rows reach is repeated with twice its distance, at most this often.
MOST_REACHES = 60


class FeasibleSet:
    """S(t), or its inner convex approximation, of one problem; it keeps near rows and a solver for one run."""

    def __init__(self, problem: Problem, solver: Solver, work: Work, *, linearised: bool) -> None:
        self._near = Near(problem.constraints, work)
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
        for _ in range(MOST_REACHES):
            near = self._near.select(t, around, reach)
            target = near.linearised(t, around, carried_to) if self._linearised else near.at(t)
            found = self._solver.nearest(target, y, around)
            if found.back_end != NO_BACK_END:
                self._work.count_call(found.back_end, found.iterations)
            distance = longest(found.point - around)
            if carried_to is not None:
                distance += near.carried(t, carried_to)
            if distance <= reach:
                return found
            reach = 2 * distance
        raise StepFailure(Status.NOT_CONVERGED, f"The projection moved a particle by more than {distance:g}.")
