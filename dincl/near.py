"""The rows that matter near the current state, kept until somebody has moved far enough."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dincl.constraints.rows import RowsOfOneKind, RowsTogether
from dincl.norms import longest

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from dincl.constraints.base import Constraint
    from dincl.problem import Problem
    from dincl.work import Work

# Rows are selected for this many times the reach asked for, so that one selection serves several steps.
GENEROUS = 4.0


class _NearOne:
    """The near rows of one constraint, in the frame in which the constraint is at rest."""

    def __init__(self, constraint: Constraint) -> None:
        self._constraint = constraint
        self._reference: NDArray[np.float64] | None = None
        self._reach = 0.0

    def rows(self, t: float, x: NDArray[np.float64], reach: float, work: Work) -> RowsOfOneKind:
        shift = self._constraint.displacement(t, x.shape[1])
        at_rest = x if shift is None else x - shift
        if self._reference is None or longest(at_rest - self._reference) + reach > self._reach:
            self._reference, self._reach = at_rest.copy(), GENEROUS * reach
            self._rows = self._constraint.select(at_rest, self._reach)
            work.neighbour_builds += 1
        return self._rows if shift is None else self._rows.shifted(shift)


class Near:
    """The near rows of a problem; one per run.

    ``rows(t, x, reach)`` holds every row that can be violated at time t after each particle moved at most ``reach``
    from x (N, d). Which rows there are changes only now and then, so a solver can keep what it built for them.
    """

    def __init__(self, problem: Problem, work: Work) -> None:
        self._parts = [_NearOne(constraint) for constraint in problem.constraints]
        self._size = problem.x0.size
        self._work = work

    def rows(self, t: float, x: NDArray[np.float64], reach: float) -> RowsTogether:
        """The near rows, see the class."""
        return RowsTogether(tuple(part.rows(t, x, reach, self._work) for part in self._parts), self._size)
