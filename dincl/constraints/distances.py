"""Sets of distances: discs that do not overlap, pairs held together, balls to stay inside or outside of."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from dincl.checks import array, indices, lengths, spread, vector, within
from dincl.constraints.timed import Timed
from dincl.errors import InvalidProblem
from dincl.rows.base import DiscPairs
from dincl.rows.distance import DistanceRows

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True, eq=False)
class NonOverlap(Timed):
    """g_ij(x) = |X_i - X_j| - (r_i + r_j) >= 0 for all pairs j < i  (1.2).

    Parameters
    ----------
    radius
        One radius > 0 for all discs, or one each, shape (n,) [length]; or a function of time: t -> radius.
    among
        The particles that are discs, shape (n,), each at most once; all others are points that touch nothing. None:
        all particles are discs.

    Rows are ordered by i, then j < i, as in Algorithm 1 of chapter 2; with ``among``, by its order. Only pairs close to
    each other are ever formed, at a cost linear in n. Raises InvalidProblem for a radius that is not a finite
    number > 0.
    """

    radius: Any
    among: ArrayLike | None = None
    functions_of_time = ("radius",)

    def __post_init__(self) -> None:
        if not self.timed:
            object.__setattr__(self, "radius", lengths("radius", self.radius, positive=True))
        if self.among is not None:
            object.__setattr__(self, "among", indices("among", self.among, distinct=True))

    def check(self, count: int, d: int) -> None:
        within("among", self.discs(count), count)
        self.at(0.0).radii(count)

    def discs(self, count: int) -> NDArray[np.int64]:
        """Return which of ``count`` particles are discs, shape (n,)."""
        return np.arange(count) if self.among is None else np.asarray(self.among)

    def radii(self, count: int) -> NDArray[np.float64]:
        """Return the radius of each of ``count`` particles, shape (count,); 0 for particles that are no discs."""
        discs = self.discs(count)
        radii = np.zeros(count)
        radii[discs] = spread("radius", np.asarray(self.radius), len(discs), "particles")
        return radii

    def select(self, x: NDArray[np.float64], search_radius: float) -> DistanceRows:
        """Return the pairs with a gap of at most 2 search_radius."""
        discs, radii = self.discs(len(x)), self.radii(len(x))
        if not np.isfinite(search_radius):
            return _all_pairs(discs, radii)
        from dincl.neighbours.search import neighbour_pairs

        start, partner = neighbour_pairs(x[discs], radii[discs] + search_radius)
        i, j = np.repeat(discs, np.diff(start)), discs[partner]
        return DistanceRows(i, j, radii[i] + radii[j], 1.0)

    def updated(self, rows: DistanceRows | DiscPairs, count: int) -> DistanceRows | DiscPairs:
        radii = self.radii(count)
        if isinstance(rows, DiscPairs):
            return rows._replace(radius=radii[self.discs(count)])
        return replace(rows, length=radii[rows.i] + radii[rows.j])

    def change_from(self, other: NonOverlap, x: NDArray[np.float64], search_radius: float) -> float:
        return float(np.abs(self.radii(len(x)) - other.radii(len(x))).max())

    def sweep_rows(self, x: NDArray[np.float64]) -> DiscPairs:
        discs = self.discs(len(x))
        return DiscPairs(self.radii(len(x))[discs], None if self.among is None else discs)


def _all_pairs(discs: NDArray[np.int64], radii: NDArray[np.float64]) -> DistanceRows:
    i, j = (discs[place] for place in np.tril_indices(len(discs), -1))
    return DistanceRows(i, j, radii[i] + radii[j], 1.0)


@dataclass(frozen=True, eq=False)
class MaxDistance(Timed):
    """g_k(x) = length_k - |X_i - X_j| >= 0 for the pairs (i, j) in their order.

    Parameters
    ----------
    pairs
        Particle indices, shape (m, 2), two different ones in each pair.
    length
        Greatest distance, > 0, one for all pairs or shape (m,) [length]; or a function of time: t -> length.
    """

    pairs: ArrayLike
    length: Any
    functions_of_time = ("length",)

    def __post_init__(self) -> None:
        pairs = indices("pairs", self.pairs, columns=2)
        same = np.flatnonzero(pairs[:, 0] == pairs[:, 1])
        if same.size:
            raise InvalidProblem(f"pairs[{same[0]}] = {pairs[same[0]].tolist()}: must name two different particles")
        object.__setattr__(self, "pairs", pairs)
        if not self.timed:
            length = lengths("length", self.length, positive=True)
            object.__setattr__(self, "length", spread("length", length, len(pairs), "pairs"))

    def check(self, count: int, d: int) -> None:
        within("pairs", np.asarray(self.pairs), count)

    def select(self, x: NDArray[np.float64], search_radius: float) -> DistanceRows:
        """Return the pairs with a slack of at most 2 search_radius."""
        pairs = np.asarray(self.pairs)
        rows = DistanceRows(pairs[:, 0].copy(), pairs[:, 1].copy(), np.asarray(self.length), -1.0)
        return rows.take(rows.values(x) <= 2 * search_radius)

    def updated(self, rows: DistanceRows, count: int) -> DistanceRows:
        """Of a pair that is listed more than once every row gets the least length."""
        pairs = np.asarray(self.pairs)
        names, place = np.unique(pairs @ (count, 1), return_inverse=True)
        least = np.full(len(names), np.inf)
        np.minimum.at(least, place, np.asarray(self.length))
        return replace(rows, length=least[np.searchsorted(names, rows.i * count + np.asarray(rows.j))])

    def change_from(self, other: MaxDistance, x: NDArray[np.float64], search_radius: float) -> float:
        return float(np.abs(np.asarray(self.length) - np.asarray(other.length)).max(initial=0.0)) / 2


@dataclass(frozen=True, eq=False)
class _Ball(Timed):
    centre: Any
    distance: Any
    functions_of_time = ("centre", "distance")
    sign: ClassVar[float]

    def __post_init__(self) -> None:
        if self.timed:
            return
        centre = array("centre", self.centre)
        vector("centre", centre, centre.size)
        object.__setattr__(self, "centre", centre)
        object.__setattr__(self, "distance", lengths("distance", self.distance, positive=True))

    def check(self, count: int, d: int) -> None:
        now = self.at(0.0)
        vector("centre", np.asarray(now.centre), d)
        spread("distance", np.asarray(now.distance), count, "particles")

    def select(self, x: NDArray[np.float64], search_radius: float) -> DistanceRows:
        """Return the particles closer to the sphere than ``search_radius``, or beyond it."""
        count = len(x)
        length = spread("distance", np.asarray(self.distance), count, "particles")
        rows = DistanceRows(np.arange(count), None, length, self.sign, np.tile(np.asarray(self.centre), (count, 1)))
        return rows.take(rows.values(x) <= search_radius)

    def updated(self, rows: DistanceRows, count: int) -> DistanceRows:
        length = spread("distance", np.asarray(self.distance), count, "particles")[rows.i]
        return replace(rows, length=length, anchor=np.tile(np.asarray(self.centre), (len(rows), 1)))

    def change_from(self, other: _Ball, x: NDArray[np.float64], search_radius: float) -> float:
        way, grown = (
            np.asarray(getattr(self, name)) - np.asarray(getattr(other, name)) for name in ("centre", "distance")
        )
        return float(np.sqrt(way @ way) + np.abs(grown).max())


class OutsideBall(_Ball):
    """g_i(x) = |X_i - centre| - distance_i >= 0 for every particle i: an obstacle.

    ``centre`` has shape (d,); ``distance`` > 0 is one for all or has shape (N,): the radius of the obstacle plus that
    of the particle [length]. Each may be a function of time: t -> value.
    """

    sign = 1.0


class InsideBall(_Ball):
    """g_i(x) = distance_i - |X_i - centre| >= 0 for every particle i: a container.

    ``centre`` has shape (d,); ``distance`` > 0 is one for all or has shape (N,): the radius of the container less that
    of the particle [length]. Each may be a function of time: t -> value.
    """

    sign = -1.0
