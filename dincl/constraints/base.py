"""What a constraint is: the rows that matter near a state, and what follows from them."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from dincl.rows.base import RowsOfOneKind
    from dincl.rows.sweeper import DiscPairs, Sweeper


class Constraint(ABC):
    """A set S = {x : g(x) >= 0}, given by its rows, which are of a kind of ``dincl.rows``.

    Derive from ``DifferentiableConstraint`` for a set of one's own with a g and its Jacobian; from this class for a set
    of many rows of which few matter at a time, best as a frozen dataclass that checks its arguments. Needed is
    ``select`` alone; states x have shape (N, d), and are read and not changed. A constraint itself knows no time:
    ``dincl.Moving(constraint, path)`` carries it along a path.

    All else is optional. ``check`` refuses a problem that the set does not fit. ``sweeper`` gives the exact projections
    that PBD makes; without it, they are those of the rows.

    ``docs/extend/constraint.md`` says how a set or a kind of row is added to the package.
    """

    def check(self, count: int, d: int) -> None:  # noqa: B027 - many sets fit every problem
        """Raise InvalidProblem unless the constraint fits ``count`` particles in dimension d."""

    @abstractmethod
    def select(self, x: NDArray[np.float64], reach: float) -> RowsOfOneKind:
        """The rows that can be violated after every particle moved by at most ``reach`` from x (N, d), or more rows."""

    def sweeper(self, x: NDArray[np.float64]) -> RowsOfOneKind | DiscPairs | Sweeper:
        """What PBD projects onto, for states of the shape of x: rows one after another, or a Sweeper of your own."""
        return self.select(x, math.inf)

    def pattern(self, x: NDArray[np.float64]) -> RowsOfOneKind:
        """Rows that show which particles the set ties: all of them, or enough to see that two rows share a particle."""
        return self.select(x, math.inf)

    def displacement(self, t: float, d: int) -> NDArray[np.float64] | None:
        """How far the set was carried at time t, shape (d,); None for a set at rest. Only ``Moving`` gives another."""
        return None
