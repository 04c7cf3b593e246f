"""Base class of all constraints."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any, TypeAlias

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from dincl.rows.base import DiscPairs, RowsOfOneKind

    Swept: TypeAlias = RowsOfOneKind | DiscPairs


class Constraint(ABC):
    """A set S = {x : g(x) >= 0}, given by its rows, which are of a kind of ``dincl.rows``.

    Derive from ``DifferentiableConstraint`` for a set of your own with g and its Jacobian; from this class for a set of
    many rows of which few matter at a time, best as a frozen dataclass that checks its arguments. Only ``select`` is
    required; the other methods are optional. States x have shape (N, d) and must not be changed.
    ``dincl.Moving(constraint, path)`` moves a set; of one that depends on time in another way derive from
    ``dincl.constraints.timed.Timed``.

    ``docs/extend/constraint.md`` says how a set or a kind of row is added to the package.
    """

    def check(self, count: int, d: int) -> None:  # noqa: B027 - many sets fit every problem
        """Raise InvalidProblem unless the constraint fits ``count`` particles in dimension d."""

    def in_box(self, box: NDArray[np.float64]) -> Constraint:
        """Return the set in a periodic box, (d,), with 0 for axes that do not repeat; InvalidProblem if there is none.

        A set of your own is left as it is: its g must be periodic.
        """
        return self

    @abstractmethod
    def select(self, x: NDArray[np.float64], search_radius: float) -> RowsOfOneKind:
        """Return the rows that can be violated after each particle moved at most ``search_radius`` from x, or more."""

    def sweep_rows(self, x: NDArray[np.float64]) -> Swept:
        """Return the rows that PBD projects onto, one after another, for states of the shape of x."""
        return self.select(x, math.inf)

    def longest_length(self, d: int) -> float:
        """Return the largest length or offset of the set at time 0, which gaps round with; 0 if none is known."""
        return 0.0

    @property
    def timed(self) -> bool:
        """Whether the set depends on time."""
        return False

    def at(self, t: float) -> Constraint:
        """Return the set with its numbers at time t; a set that only moves returns itself."""
        return self

    def parameters(self, t: float, x: NDArray[np.float64]) -> NDArray[np.float64] | None:
        """Return the numbers by which a timed set depends on time, flat, at time t; None for all others.

        x (N, d) is the start of the problem. Kinks of these numbers in t are located before a run.
        """
        return None

    def displacement(self, t: float, d: int) -> NDArray[np.float64] | None:
        """Return the displacement at time t, shape (d,), of a set that is only translated; None for all others."""
        return None

    def select_at(self, t: float, x: NDArray[np.float64], search_radius: float) -> RowsOfOneKind:
        """Return rows as ``select`` does for the set at time t; only ``rows_at`` puts them where they are."""
        return self.select(x, search_radius)

    def rows_at(self, t: float, rows: Any, shape: tuple[int, ...]) -> Any:
        """Return rows of ``select_at``, or DiscPairs of ``sweep_rows``, for x of this shape, as they are at time t."""
        return rows

    def change(self, t: float, later: float, x: NDArray[np.float64], search_radius: float) -> float:
        """Bound the change of the set between two times, near x.

        If a row cannot be violated at time t after each particle moved at most r <= ``search_radius`` from x, it cannot
        be violated at the other time after moves of at most r less the result.
        """
        return 0.0
