"""A set that is carried along a path: Moreau's sweeping process."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from dincl.callables import UserFunction
from dincl.checks import describe
from dincl.constraints.base import Constraint
from dincl.errors import InvalidProblem
from dincl.status import Status

if TYPE_CHECKING:
    from collections.abc import Callable

    import numpy as np
    from numpy.typing import NDArray

    from dincl.rows.base import RowsOfOneKind
    from dincl.rows.sweeper import DiscPairs, Sweeper

PATH = UserFunction("path", ("t",), Status.CONSTRAINT_FAILED)


@dataclass(frozen=True, eq=False)
class Moving(Constraint):
    """S(t) = S + path(t): x is feasible at time t when x - path(t) is feasible for ``constraint``  (1.16).

    Parameters
    ----------
    constraint
        The set at rest, any Constraint but another Moving.
    path
        t -> displacement of shape (d,) [length], the same for all particles.
    """

    constraint: Constraint
    path: Callable[[float], Any]

    def __post_init__(self) -> None:
        if not isinstance(self.constraint, Constraint) or isinstance(self.constraint, Moving):
            raise InvalidProblem(
                f"constraint = {describe(self.constraint)}: must be a Constraint that is not itself Moving"
            )
        if not callable(self.path):
            raise InvalidProblem(f"path = {describe(self.path)}: must be a callable of t that returns shape (d,)")

    def check(self, count: int, d: int) -> None:
        self.constraint.check(count, d)
        shape = self._shift(0.0).shape
        if shape != (d,):
            raise InvalidProblem(f"path(0.0) of shape {shape}: must have shape ({d},)")

    def displacement(self, t: float, d: int) -> NDArray[np.float64]:
        return self._shift(t, (d,))

    def _shift(self, t: float, shape: tuple[int, ...] | None = None) -> NDArray[np.float64]:
        return PATH.evaluated(self.path, t, shape=shape)

    def select(self, x: NDArray[np.float64], reach: float) -> RowsOfOneKind:
        """The near rows of the set at rest; x is given relative to the displacement."""
        return self.constraint.select(x, reach)

    def pattern(self, x: NDArray[np.float64]) -> RowsOfOneKind:
        return self.constraint.pattern(x)

    def sweeper(self, x: NDArray[np.float64]) -> RowsOfOneKind | DiscPairs | Sweeper:
        """That of the set at rest."""
        return self.constraint.sweeper(x)
