"""Base class of all constraints."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from dincl.rows.base import CustomSweep, DiscPairs, RowsOfOneKind


class Constraint(ABC):
    """A set S = {x : g(x) >= 0}, given by its rows, which are of a kind of ``dincl.rows``.

    Derive from ``DifferentiableConstraint`` for a set of your own with g and its Jacobian; from this class for a set of
    many rows of which few matter at a time, best as a frozen dataclass that checks its arguments. Only ``select`` is
    required; the other methods are optional. States x have shape (N, d) and must not be changed. A constraint does not
    depend on time: ``dincl.Moving(constraint, path)`` translates it along a path.

    ``docs/extend/constraint.md`` says how a set or a kind of row is added to the package.
    """

    def check(self, count: int, d: int) -> None:  # noqa: B027 - many sets fit every problem
        """Raise InvalidProblem unless the constraint fits ``count`` particles in dimension d."""

    @abstractmethod
    def select(self, x: NDArray[np.float64], search_radius: float) -> RowsOfOneKind:
        """Return the rows that can be violated after each particle moved at most ``search_radius`` from x, or more."""

    def sweep_rows(self, x: NDArray[np.float64]) -> RowsOfOneKind | DiscPairs | CustomSweep:
        """Return the rows that PBD projects onto, one after another, for states of the shape of x; or a CustomSweep."""
        return self.select(x, math.inf)

    def pattern(self, x: NDArray[np.float64]) -> RowsOfOneKind:
        """Return all rows, or enough of them to show that two rows share a particle."""
        return self.select(x, math.inf)

    def displacement(self, t: float, d: int) -> NDArray[np.float64] | None:
        """Return the displacement of the set at time t, shape (d,); None for all sets but ``Moving``."""
        return None
