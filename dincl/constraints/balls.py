"""A fixed ball, to stay outside of (an obstacle) or inside of (a container)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from dincl.checks import array, lengths, spread, vector
from dincl.constraints.base import Constraint
from dincl.rows.distance import DistanceRows

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True, eq=False)
class _FixedBall(Constraint):
    centre: ArrayLike
    distance: ArrayLike
    sign: ClassVar[float]

    def __post_init__(self) -> None:
        centre = array("centre", self.centre)
        vector("centre", centre, centre.size)
        object.__setattr__(self, "centre", centre)
        object.__setattr__(self, "distance", lengths("distance", self.distance, positive=True))

    def check(self, count: int, d: int) -> None:
        vector("centre", np.asarray(self.centre), d)
        self._lengths(count)

    def _lengths(self, count: int) -> NDArray[np.float64]:
        return spread("distance", np.asarray(self.distance), count, "particles")

    def rows(self, x: NDArray[np.float64]) -> DistanceRows:
        """One row for each particle."""
        anchor = np.tile(np.asarray(self.centre), (len(x), 1))
        return DistanceRows(np.arange(len(x)), None, self._lengths(len(x)), self.sign, anchor)

    def select(self, x: NDArray[np.float64], reach: float) -> DistanceRows:
        rows = self.rows(x)
        return rows.take(rows.values(x) <= reach)


class OutsideBall(_FixedBall):
    """g_i(x) = |X_i - centre| - distance_i >= 0 for every particle i: an obstacle.

    ``centre`` has shape (d,); ``distance`` > 0 is one for all or has shape (N,): the radius of the obstacle plus that
    of the particle [length].
    """

    sign = 1.0


class InsideBall(_FixedBall):
    """g_i(x) = distance_i - |X_i - centre| >= 0 for every particle i: a container.

    ``centre`` has shape (d,); ``distance`` > 0 is one for all or has shape (N,): the radius of the container less that
    of the particle [length].
    """

    sign = -1.0
