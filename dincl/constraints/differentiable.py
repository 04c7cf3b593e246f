"""The base of a constraint of one's own: its values and its Jacobian are enough."""

from __future__ import annotations

from abc import abstractmethod
from functools import cached_property
from typing import TYPE_CHECKING, Any

from dincl.constraints.base import Constraint
from dincl.constraints.smooth import Smooth

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from dincl.constraints.rows import RowsOfOneKind
    from dincl.sweepers import Sweeper


class DifferentiableConstraint(Constraint):
    """{x : g(x) >= 0} for a continuously differentiable g, given by two methods of a subclass.

    ``Smooth`` is the same from two functions. Every scheme and every projection but ``ClosedForm`` serves it; so does
    ``Moving``. All rows are near at all times, since nothing is known of how fast g changes: a set of many rows of
    which few matter derives from ``Constraint`` itself and says in ``select`` which do. To be drawn, a subclass is
    registered with ``dincl.shapes.shapes_of``.
    """

    @abstractmethod
    def values(self, x: NDArray[np.float64]) -> Any:
        """g(x) for x of shape (N, d), shape (m,)."""

    @abstractmethod
    def jacobian(self, x: NDArray[np.float64]) -> Any:
        """dg/dx at x, dense of shape (m, N*d) or (m, N, d), or scipy.sparse of shape (m, N*d)."""

    def check(self, count: int, d: int) -> None:
        """Raise InvalidProblem unless it fits ``count`` particles in dimension d; to be overridden where it may not."""

    def select(self, x: NDArray[np.float64], reach: float) -> RowsOfOneKind:
        """All rows."""
        return self._by_functions.select(x, reach)

    def sweeper(self, x: NDArray[np.float64]) -> Sweeper:
        return self._by_functions.sweeper(x)

    @cached_property
    def _by_functions(self) -> Smooth:
        """One object for all calls, since compiled programs are kept by the identity of g."""
        return Smooth(self.values, self.jacobian)
