"""A set that is translated along a path, and the velocity of a path: Moreau's sweeping process."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.callables import UserFunction
from dincl.checks import describe, function
from dincl.constraints.base import Constraint
from dincl.errors import InvalidProblem
from dincl.status import Status

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dincl.rows.base import CustomSweep, DiscPairs, RowsOfOneKind

PATH = UserFunction("path", ("t",), Status.CONSTRAINT_FAILED)
# t -> displacement (d,) [length].
Path = Callable[[float], "NDArray[np.float64]"]
# Central and one-sided differences of order 6 for the first derivative.
CENTRAL = np.array([-1, 9, -45, 0, 45, -9, 1]) / 60
FORWARD = np.array([-147, 360, -450, 400, -225, 72, -10]) / 60


@dataclass(frozen=True, eq=False)
class Moving(Constraint):
    """S(t) = S + path(t): x is feasible at time t when x - path(t) is feasible for ``constraint``  (1.16).

    Parameters
    ----------
    constraint
        The set S, any Constraint but another Moving.
    path
        t -> displacement of shape (d,) [length], the same for all particles.

    The rows of ``select``, ``sweep_rows`` and ``pattern`` are those of S, for x relative to the displacement.
    """

    constraint: Constraint
    path: Callable[[float], Any]

    def __post_init__(self) -> None:
        if not isinstance(self.constraint, Constraint) or isinstance(self.constraint, Moving):
            raise InvalidProblem(
                f"constraint = {describe(self.constraint)}: must be a Constraint that is not itself Moving"
            )
        function("path", self.path, "a callable of t that returns shape (d,)")

    def check(self, count: int, d: int) -> None:
        self.constraint.check(count, d)
        shape = PATH.evaluated(self.path, 0.0).shape
        if shape != (d,):
            raise InvalidProblem(f"path(0.0) of shape {shape}: must have shape ({d},)")

    def displacement(self, t: float, d: int) -> NDArray[np.float64]:
        return PATH.evaluated(self.path, t, shape=(d,))

    def select(self, x: NDArray[np.float64], search_radius: float) -> RowsOfOneKind:
        return self.constraint.select(x, search_radius)

    def pattern(self, x: NDArray[np.float64]) -> RowsOfOneKind:
        return self.constraint.pattern(x)

    def sweep_rows(self, x: NDArray[np.float64]) -> RowsOfOneKind | DiscPairs | CustomSweep:
        return self.constraint.sweep_rows(x)


def derivative(
    path: Path, t: float, spacing: float, smooth: tuple[float, float] = (0.0, np.inf)
) -> NDArray[np.float64]:
    """Compute the velocity of a path, shape (d,), by differences of order 6 within ``smooth`` [length / time]."""
    spacing = min(spacing, (smooth[1] - smooth[0]) / (len(FORWARD) - 1))
    if t - 3 * spacing < smooth[0]:
        places, weights = range(7), FORWARD
    elif t + 3 * spacing > smooth[1]:
        places, weights = range(0, -7, -1), -FORWARD
    else:
        places, weights = range(-3, 4), CENTRAL
    shifts = np.array([path(t + k * spacing) for k in places])
    # A constant path has velocity 0, without rounding.
    found: NDArray[np.float64] = weights @ (shifts - shifts[places.index(0)]) / spacing
    return found
