"""Any smooth constraint, given by its function and its Jacobian."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.callables import call, numbers
from dincl.checks import describe
from dincl.constraints.base import Constraint
from dincl.constraints.rows import SmoothRows
from dincl.errors import InvalidProblem, StepFailure
from dincl.status import Status
from dincl.sweepers import SmoothSweeper, Sweeper

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray


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

    def check(self, count: int, d: int) -> None:
        """Nothing to compare before there is a state; shapes are checked at every evaluation."""

    def select(self, x: NDArray[np.float64], reach: float) -> SmoothRows:
        """All rows."""
        value = numbers("g", Status.CONSTRAINT_FAILED, call("g", Status.CONSTRAINT_FAILED, self.g, x))
        if value.ndim != 1:
            raise StepFailure(Status.CONSTRAINT_FAILED, f"g returned an array of shape {value.shape}: must be (m,).")
        return SmoothRows(self.g, self.jacobian, len(value), np.arange(len(value)))

    def sweeper(self, x: NDArray[np.float64]) -> Sweeper:
        return SmoothSweeper(self.select(x, 0.0))
