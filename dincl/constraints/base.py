"""What a constraint is: the class to derive an own one from."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any

from dincl.rows.smooth import all_rows

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from dincl.rows.base import RowsOfOneKind
    from dincl.rows.sweeper import Sweeper


class Constraint(ABC):
    """A set S = {x : g(x) >= 0} for a continuously differentiable g; every scheme and projection takes it.

    Derive from it for an own set, best as a frozen dataclass that checks its arguments. Needed are ``values`` and
    ``derivative``, for states x of shape (N, d), which are read and not changed::

        @dataclass(frozen=True, eq=False)
        class InEllipse(dincl.Constraint):
            axes: tuple[float, float]

            def values(self, x):  # (m,), here one row for each particle
                return 1 - ((x / self.axes) ** 2).sum(axis=1)

            def derivative(self, x):  # (m, N*d) or (m, N, d), dense; or scipy.sparse of shape (m, N*d)
                rows = np.zeros((len(x), *x.shape))
                each = np.arange(len(x))
                rows[each, each] = -2 * x / np.square(self.axes)
                return rows

    The number of rows m is the same for all x. ``dincl.Moving(InEllipse(...), path)`` carries such a set along a path:
    a constraint itself knows no time. All else is optional:

    ``check`` refuses a problem that the set does not fit. ``select`` leaves out rows that are far from being violated,
    or returns rows of a kind in ``dincl.rows`` that has more formulas. ``sweeper`` gives the exact projections that
    PBD goes through; without it, each violated row is linearised again and again at the point reached, which ends at
    its nearest point.

    ``docs/extend/constraint.md`` says how a set or a kind of row is added to the package.
    """

    @abstractmethod
    def values(self, x: NDArray[np.float64]) -> Any:
        """g(x) of all rows, shape (m,)."""

    @abstractmethod
    def derivative(self, x: NDArray[np.float64]) -> Any:
        """dg/dx at x: shape (m, N*d) or (m, N, d), or sparse of shape (m, N*d)."""

    def check(self, count: int, d: int) -> None:  # noqa: B027 - shapes of values are checked at every evaluation
        """Raise InvalidProblem unless the constraint fits ``count`` particles in dimension d."""

    def select(self, x: NDArray[np.float64], reach: float) -> RowsOfOneKind:
        """The rows that can be violated after every particle moved by at most ``reach`` from x (N, d), or more rows.

        All of them, as nothing is known of how fast g changes.
        """
        name = type(self).__name__
        return all_rows(self.values, self.derivative, x, (f"{name}.values", f"{name}.derivative"))

    def sweeper(self, x: NDArray[np.float64]) -> Sweeper:
        """The exact projections onto the single rows, in their documented order, for states of the shape of x."""
        return self.select(x, math.inf).sweeper(x.shape[1])

    def pattern(self, x: NDArray[np.float64]) -> RowsOfOneKind:
        """Rows that show which particles the set ties: all of them, or enough to see that two rows share a particle."""
        return self.select(x, math.inf)

    def displacement(self, t: float, d: int) -> NDArray[np.float64] | None:
        """How far the set was carried at time t, shape (d,); None for a set at rest. Only ``Moving`` gives another."""
        return None


class SetOfRows(Constraint):
    """A constraint that is given by its rows, which are of a kind of ``dincl.rows``."""

    @abstractmethod
    def select(self, x: NDArray[np.float64], reach: float) -> RowsOfOneKind:
        """As in Constraint."""

    def values(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        return self.select(x, math.inf).values(x)

    def derivative(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        return self.select(x, math.inf).jacobian(x).dense()
