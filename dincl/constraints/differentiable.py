"""The base of a constraint of one's own: its values and its Jacobian are enough."""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING, Any

from dincl.constraints.base import Constraint
from dincl.rows.smooth import all_rows

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from dincl.rows.base import RowsOfOneKind


class DifferentiableConstraint(Constraint):
    """{x : g(x) >= 0} for a continuously differentiable g, given by two methods of a subclass.

    Needed are ``values`` and ``jacobian``, for states x of shape (N, d), which are read and not changed::

        @dataclass(frozen=True, eq=False)
        class InEllipse(dincl.DifferentiableConstraint):
            axes: tuple[float, float]

            def values(self, x):  # (m,), here one row for each particle
                return 1 - ((x / self.axes) ** 2).sum(axis=1)

            def jacobian(self, x):  # (m, N*d) or (m, N, d), dense; or scipy.sparse of shape (m, N*d)
                rows = np.zeros((len(x), *x.shape))
                each = np.arange(len(x))
                rows[each, each] = -2 * x / np.square(self.axes)
                return rows

    The number of rows m is the same for all x. ``Smooth`` is the same from two functions. Every scheme, minimiser and
    projection but ``ClosedForm`` serves it; so does ``Moving``. All rows are near at all times, since nothing is known
    of how fast g changes, and for PBD each violated row is linearised again and again at the point reached, which ends
    at its nearest point; ``select`` and ``sweeper`` may be overridden by what knows better. To be drawn, a subclass is
    registered with ``dincl.shapes.shapes_of``.
    """

    @abstractmethod
    def values(self, x: NDArray[np.float64]) -> Any:
        """g(x) of all rows, for x of shape (N, d), shape (m,)."""

    @abstractmethod
    def jacobian(self, x: NDArray[np.float64]) -> Any:
        """dg/dx at x, dense of shape (m, N*d) or (m, N, d), or scipy.sparse of shape (m, N*d)."""

    def select(self, x: NDArray[np.float64], reach: float) -> RowsOfOneKind:
        """All rows."""
        name = type(self).__name__
        return all_rows(self.values, self.jacobian, x, (f"{name}.values", f"{name}.jacobian"))
