"""Discs (balls, intervals) that may touch but not overlap."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from dincl.checks import indices, lengths, spread, within
from dincl.constraints.base import Constraint
from dincl.errors import InvalidProblem
from dincl.rows.distance import DistanceRows, all_pairs
from dincl.rows.sweeper import DiscPairs

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True, eq=False)
class NonOverlap(Constraint):
    """g_ij(x) = |X_i - X_j| - (r_i + r_j) >= 0 for all pairs j < i  (1.2).

    Parameters
    ----------
    radius
        One radius > 0 for all discs, or one each, shape (n,) [length].
    among
        The particles that are discs, shape (n,), each at most once, where others are points that meet nobody; None:
        all particles.

    Rows are ordered by i, then j < i, as in Algorithm 1 of chapter 2; of ``among``, in its own order. Only near pairs
    are ever formed, at a cost linear in n. Raises InvalidProblem for a radius that is not a finite number > 0.
    """

    radius: ArrayLike
    among: ArrayLike | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "radius", lengths("radius", self.radius, positive=True))
        if self.among is not None:
            among = indices("among", self.among)
            if len(np.unique(among)) != len(among):
                raise InvalidProblem(f"among = {self.among!r}: must name each particle at most once")
            object.__setattr__(self, "among", among)

    def check(self, count: int, d: int) -> None:
        within("among", self.discs(count), count)
        self.radii(count)

    def discs(self, count: int) -> NDArray[np.int64]:
        """Which of ``count`` particles are discs, shape (n,)."""
        return np.arange(count) if self.among is None else np.asarray(self.among)

    def radii(self, count: int) -> NDArray[np.float64]:
        """The radius of each of ``count`` particles, shape (count,); 0 for one that is no disc."""
        discs = self.discs(count)
        radii = np.zeros(count)
        radii[discs] = spread("radius", np.asarray(self.radius), len(discs), "particles")
        return radii

    def select(self, x: NDArray[np.float64], reach: float) -> DistanceRows:
        """The pairs with a gap of at most 2 reach."""
        discs, radii = self.discs(len(x)), self.radii(len(x))
        if not np.isfinite(reach):
            return all_pairs(radii[discs], discs)
        from dincl.neighbours.search import neighbour_pairs

        start, partner = neighbour_pairs(x[discs], radii[discs] + reach)
        i, j = np.repeat(discs, np.diff(start)), discs[partner]
        return DistanceRows(i, j, radii[i] + radii[j], 1.0)

    def sweeper(self, x: NDArray[np.float64]) -> DiscPairs:
        discs = self.discs(len(x))
        return DiscPairs(self.radii(len(x))[discs], None if self.among is None else discs)

    def pattern(self, x: NDArray[np.float64]) -> DistanceRows:
        """Of many discs, two pairs are enough."""
        others = np.arange(1, min(len(x), 3))
        return DistanceRows(others, np.zeros_like(others), np.ones(len(others)), 1.0)
