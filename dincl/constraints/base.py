"""What every constraint offers: the rows that matter near a state, and its exact projections one row after another."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from dincl.constraints.rows import RowsOfOneKind
    from dincl.sweepers import Sweeper


class Constraint(ABC):
    """A set {x : g(x) >= 0}, checked at construction and, against a problem's shape, when the problem is made."""

    @abstractmethod
    def check(self, count: int, d: int) -> None:
        """Raise InvalidProblem unless the constraint fits ``count`` particles in dimension d."""

    @abstractmethod
    def select(self, x: NDArray[np.float64], reach: float) -> RowsOfOneKind:
        """The rows that can be violated after every particle moved by at most ``reach`` from x (N, d), or more rows."""

    def near(self, t: float, x: NDArray[np.float64], reach: float) -> RowsOfOneKind:
        """The same at time t, for a set that may have been carried."""
        shift = self.displacement(t, x.shape[1])
        return self.select(x, reach) if shift is None else self.select(x - shift, reach).shifted(shift)

    @abstractmethod
    def sweeper(self, x: NDArray[np.float64]) -> Sweeper:
        """The exact projections onto the single rows, in their documented order, for states of the shape of x."""

    def displacement(self, t: float, d: int) -> NDArray[np.float64] | None:
        """How far the set was carried at time t, shape (d,); None for a set at rest."""
        return None
