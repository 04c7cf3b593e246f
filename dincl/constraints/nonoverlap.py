"""Discs (balls, intervals) that may touch but not overlap."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from dincl.checks import lengths, spread
from dincl.constraints.base import Constraint
from dincl.constraints.rows import DistanceRows
from dincl.pairs import near_pairs
from dincl.sweepers import PairSweeper, Sweeper

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True, eq=False)
class NonOverlap(Constraint):
    """g_ij(x) = |X_i - X_j| - (r_i + r_j) >= 0 for all pairs j < i  (1.2).

    Parameters
    ----------
    radius
        One radius > 0 for all particles, or one each, shape (N,) [length].

    Rows are ordered by i, then j < i, as in Algorithm 1 of chapter 2. Only near pairs are ever formed, at a cost
    linear in N. Raises InvalidProblem for a radius that is not a finite number > 0.
    """

    radius: ArrayLike

    def __post_init__(self) -> None:
        object.__setattr__(self, "radius", lengths("radius", self.radius, positive=True))

    def check(self, count: int, d: int) -> None:
        self.radii(count)

    def radii(self, count: int) -> NDArray[np.float64]:
        """The radius of each of ``count`` particles, shape (count,)."""
        return spread("radius", np.asarray(self.radius), count, "particles")

    def select(self, x: NDArray[np.float64], reach: float) -> DistanceRows:
        """The pairs with a gap of at most 2 reach."""
        radius = self.radii(len(x))
        start, partner = near_pairs(x, radius + reach)
        i = np.repeat(np.arange(len(x)), np.diff(start))
        j = partner.astype(np.int64)
        return DistanceRows(i, j, radius[i] + radius[j], 1.0)

    def sweeper(self, x: NDArray[np.float64]) -> Sweeper:
        return PairSweeper(self.radii(len(x)))
