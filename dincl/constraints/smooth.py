"""Any smooth constraint, given by its function and its Jacobian."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from dincl.checks import describe
from dincl.constraints.base import Constraint
from dincl.errors import InvalidProblem
from dincl.rows.smooth import all_rows

if TYPE_CHECKING:
    from collections.abc import Callable

    import numpy as np
    from numpy.typing import NDArray

    from dincl.rows.smooth import SmoothRows


@dataclass(frozen=True, eq=False)
class Smooth(Constraint):
    """g(x) >= 0 for a continuously differentiable g.

    Parameters
    ----------
    g
        (N, d) -> (m,).
    jacobian
        (N, d) -> dg/dx of shape (m, N*d) or (m, N, d), dense, or scipy.sparse of shape (m, N*d).

    All rows are near at all times, since nothing is known of how fast g changes.
    """

    g: Callable[[NDArray[np.float64]], Any]
    jacobian: Callable[[NDArray[np.float64]], Any]

    def __post_init__(self) -> None:
        for name in ("g", "jacobian"):
            if not callable(getattr(self, name)):
                raise InvalidProblem(f"{name} = {describe(getattr(self, name))}: must be a callable of x (N, d)")

    def select(self, x: NDArray[np.float64], reach: float) -> SmoothRows:
        """All rows."""
        return all_rows(self.g, self.jacobian, x)
