"""Sets of rows of the package: walls, orders, discs that do not overlap, pairs held together, balls."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np

from dincl.checks import array, describe, indices, integer, lengths, number, spread, vector, within
from dincl.constants import LARGEST
from dincl.constraints.base import Constraint, Timed, for_members, members
from dincl.errors import InvalidProblem
from dincl.matrices import from_equal_rows
from dincl.rows.base import DiscPairs
from dincl.rows.kinds import AffineRows, DistanceRows, HeightRows

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True, eq=False)
class HalfSpace(Timed):
    """g_i(x) = n . X_i - offset - r_i >= 0 for every particle i, with |n| = 1: a wall.

    Parameters
    ----------
    normal
        Inward normal, shape (d,); any length but zero, it is scaled to |n| = 1.
    offset
        Distance of the wall from the origin along the unit normal [length].
    radius
        Least distance of each particle from the wall, >= 0, one for all or one each, shape (n,) [length].
    particles
        The particles that the wall holds back, shape (n,), each at most once; None: all.

    The first three may be functions of time: t -> value.
    """

    normal: Any
    offset: Any = 0.0
    radius: Any = 0.0
    particles: ArrayLike | None = None
    # The normal as it was given, of any length: the unit normal is rounded, and proofs need the exact one.
    given_normal: Any = field(init=False, repr=False, default=None)
    box: Any = field(default=None, kw_only=True, repr=False)
    functions_of_time = ("normal", "offset", "radius")

    def __post_init__(self) -> None:
        if self.particles is not None:
            object.__setattr__(self, "particles", indices("particles", self.particles, distinct=True))
        if self.timed:
            return
        normal = array("normal", self.normal)
        largest = np.abs(normal).max(initial=0.0)
        if normal.ndim != 1 or not largest > 1 / LARGEST:
            raise InvalidProblem(f"normal = {self.normal!r}: must be a vector of shape (d,) other than zero")
        scaled = normal / largest
        unit = scaled / np.sqrt(scaled @ scaled)
        unit.flags.writeable = False
        object.__setattr__(self, "normal", unit)
        object.__setattr__(self, "given_normal", normal)
        object.__setattr__(self, "offset", number("offset", self.offset))
        object.__setattr__(self, "radius", lengths("radius", self.radius, positive=False))
        if self.box is not None and unit.shape == self.box.shape and unit[self.box > 0].any():
            raise InvalidProblem(f"normal = {describe(normal)}: a wall must not cross an axis that repeats")

    def check(self, count: int, d: int) -> None:
        now = self.at(0.0)
        vector("normal", np.asarray(now.normal), d)
        within("particles", members(self.particles, count), count)
        now.radii(count)

    def radii(self, count: int) -> NDArray[np.float64]:
        """Return the least distance of each of ``count`` particles from the wall, 0 of those that it does not hold."""
        return for_members("radius", self.radius, self.particles, count)

    def in_box(self, box: NDArray[np.float64]) -> HalfSpace:
        replace(self.at(0.0), box=box)  # refuses a wall that crosses an axis that repeats
        return replace(self, box=box) if self.timed else self

    def longest_length(self, d: int) -> float:
        now = self.at(0.0)
        return float(max(abs(now.offset), np.max(now.radius)))

    def select(self, x: NDArray[np.float64], search_radius: float) -> HeightRows:
        """Return the particles closer to the wall than ``search_radius``, or beyond it."""
        normal, bound, held = np.asarray(self.normal), self.offset + self.radii(len(x)), members(self.particles, len(x))
        close = held[(x @ normal - bound <= search_radius)[held]]
        return HeightRows(normal, close, bound[close], len(x))

    def updated(self, rows: HeightRows, count: int) -> HeightRows:
        bound = self.offset + self.radii(count)
        return HeightRows(np.asarray(self.normal), rows.particle, bound[rows.particle], count)

    def change_from(self, other: HalfSpace, x: NDArray[np.float64], search_radius: float) -> float:
        turned = np.asarray(self.normal) - np.asarray(other.normal)
        heights = x @ turned - (self.offset - other.offset) - (self.radii(len(x)) - other.radii(len(x)))
        return float(
            np.abs(heights[members(self.particles, len(x))]).max(initial=0.0) + np.sqrt(turned @ turned) * search_radius
        )


@dataclass(frozen=True, eq=False)
class Ordered(Constraint):
    """g_k(x) = X_{chain[k+1], axis} - X_{chain[k], axis} >= 0 for consecutive entries of the chain.

    Parameters
    ----------
    chain
        Particle indices, shape (m + 1,), each at most once.
    axis
        The coordinate that is ordered, 0 ... d - 1.
    """

    chain: ArrayLike
    axis: int

    def __post_init__(self) -> None:
        object.__setattr__(self, "chain", indices("chain", self.chain, distinct=True))
        object.__setattr__(self, "axis", integer("axis", self.axis, least=0))

    def in_box(self, box: NDArray[np.float64]) -> Ordered:
        if self.axis < len(box) and box[self.axis] > 0:
            raise InvalidProblem(f"axis = {self.axis}: particles have no order along an axis that repeats")
        return self

    def check(self, count: int, d: int) -> None:
        within("chain", np.asarray(self.chain), count)
        if self.axis >= d:
            raise InvalidProblem(f"axis = {self.axis}: must be below the dimension d = {d}")

    def select(self, x: NDArray[np.float64], search_radius: float) -> AffineRows:
        """Return the neighbours in the chain that are at most 2 search_radius apart."""
        columns = np.asarray(self.chain) * x.shape[1] + self.axis
        entries = np.column_stack((columns[1:], columns[:-1]))
        matrix = from_equal_rows(entries, np.tile([1.0, -1.0], (len(entries), 1)), x.size)
        rows = AffineRows(matrix, np.zeros(len(entries)))
        return rows.take(rows.values(x) <= 2 * search_radius)


@dataclass(frozen=True, eq=False)
class Distances(Timed):
    """Sets of distances, which are those to the nearest image in a periodic ``box`` that the problem sets."""

    box: Any = field(default=None, kw_only=True, repr=False)

    def in_box(self, box: NDArray[np.float64]) -> Self:
        return replace(self, box=box)

    def check_period(self, name: str, length: float) -> None:
        """Refuse a length that two images of one particle can be at together."""
        shortest = math.inf if self.box is None else float(self.box[self.box > 0].min(initial=math.inf))
        if 2.0 * length >= shortest:
            raise InvalidProblem(f"{name}: {length:g} must be less than half of the period of the box, {shortest:g}")


@dataclass(frozen=True, eq=False)
class NonOverlap(Distances):
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
        self.check_period("radius: the largest sum of two", 2.0 * float(self.at(0.0).radii(count).max()))

    def discs(self, count: int) -> NDArray[np.int64]:
        """Return which of ``count`` particles are discs, shape (n,)."""
        return members(self.among, count)

    def radii(self, count: int) -> NDArray[np.float64]:
        """Return the radius of each of ``count`` particles, shape (count,); 0 for particles that are no discs."""
        return for_members("radius", self.radius, self.among, count)

    def select(self, x: NDArray[np.float64], search_radius: float) -> DistanceRows:
        """Return the pairs with a gap of at most 2 search_radius."""
        discs, radii = self.discs(len(x)), self.radii(len(x))
        if np.isfinite(search_radius):
            from dincl.neighbours.search import neighbour_pairs

            places = neighbour_pairs(x[discs], radii[discs] + search_radius, self.box)
        else:
            places = np.tril_indices(len(discs), -1)
        i, j = (discs[place] for place in places)
        return DistanceRows(i, j, radii[i] + radii[j], 1.0, box=self.box)

    def updated(self, rows: DistanceRows | DiscPairs, count: int) -> DistanceRows | DiscPairs:
        radii = self.radii(count)
        if isinstance(rows, DiscPairs):
            return rows._replace(radius=radii[self.discs(count)])
        return replace(rows, length=radii[rows.i] + radii[rows.j])

    def change_from(self, other: NonOverlap, x: NDArray[np.float64], search_radius: float) -> float:
        return float(np.abs(self.radii(len(x)) - other.radii(len(x))).max())

    def sweep_rows(self, x: NDArray[np.float64]) -> DiscPairs:
        discs = self.discs(len(x))
        return DiscPairs(self.radii(len(x))[discs], None if self.among is None else discs, self.box)


@dataclass(frozen=True, eq=False)
class MaxDistance(Distances):
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
        self.check_period("length", float(np.max(self.at(0.0).length, initial=0.0)))

    def select(self, x: NDArray[np.float64], search_radius: float) -> DistanceRows:
        """Return the pairs with a slack of at most 2 search_radius."""
        pairs = np.asarray(self.pairs)
        rows = DistanceRows(pairs[:, 0].copy(), pairs[:, 1].copy(), np.asarray(self.length), -1.0, box=self.box)
        return rows.take(rows.values(x) <= 2 * search_radius)

    def updated(self, rows: DistanceRows, count: int) -> DistanceRows:
        """Give each row the least length that its pair has: a pair may be listed more than once."""
        pairs = np.asarray(self.pairs)
        names, place = np.unique(pairs @ (count, 1), return_inverse=True)
        least = np.full(len(names), np.inf)
        np.minimum.at(least, place, np.asarray(self.length))
        return replace(rows, length=least[np.searchsorted(names, rows.i * count + np.asarray(rows.j))])

    def change_from(self, other: MaxDistance, x: NDArray[np.float64], search_radius: float) -> float:
        return float(np.abs(np.asarray(self.length) - np.asarray(other.length)).max(initial=0.0)) / 2


@dataclass(frozen=True, eq=False)
class Distance(MaxDistance):
    """|X_i - X_j| = length_k for the pairs (i, j), each at most once: rigid rods. An equality is two rows, g and -g.

    Parameters
    ----------
    pairs
        Particle indices, shape (m, 2), two different ones in each pair.
    length
        The distance, > 0, one for all pairs or shape (m,) [length]; or a function of time: t -> length.
    """

    equality: ClassVar[bool] = True

    def __post_init__(self) -> None:
        super().__post_init__()
        ends = np.sort(np.asarray(self.pairs), axis=1)
        if len(np.unique(ends, axis=0)) < len(ends):
            raise InvalidProblem(f"pairs = {describe(self.pairs)}: must name each pair at most once")

    def select(self, x: NDArray[np.float64], search_radius: float) -> DistanceRows:
        """Return all rows: the ones that keep apart, then the ones that hold together."""
        i, j = np.tile(np.asarray(self.pairs), (2, 1)).T.copy()
        sign = np.repeat((1.0, -1.0), len(i) // 2)
        return DistanceRows(i, j, np.tile(np.asarray(self.length), 2), sign, box=self.box)

    def updated(self, rows: DistanceRows, count: int) -> DistanceRows:
        return replace(rows, length=np.tile(np.asarray(self.length), 2))


@dataclass(frozen=True, eq=False)
class _Ball(Distances):
    centre: Any
    distance: Any
    particles: ArrayLike | None = None
    functions_of_time = ("centre", "distance")
    sign: ClassVar[float]

    def __post_init__(self) -> None:
        if self.particles is not None:
            object.__setattr__(self, "particles", indices("particles", self.particles, distinct=True))
        if self.timed:
            return
        centre = array("centre", self.centre)
        vector("centre", centre, centre.size)
        object.__setattr__(self, "centre", centre)
        object.__setattr__(self, "distance", lengths("distance", self.distance, positive=True))

    def check(self, count: int, d: int) -> None:
        now = self.at(0.0)
        vector("centre", np.asarray(now.centre), d)
        within("particles", members(self.particles, count), count)
        self.check_period("distance", float(now.distances(count).max()))

    def distances(self, count: int) -> NDArray[np.float64]:
        """Return ``distance`` of each of ``count`` particles, 0 of those that the set is not for."""
        return for_members("distance", self.distance, self.particles, count)

    def select(self, x: NDArray[np.float64], search_radius: float) -> DistanceRows:
        """Return the particles closer to the sphere than ``search_radius``, or beyond it."""
        held = members(self.particles, len(x))
        centres = np.tile(np.asarray(self.centre), (len(held), 1))
        rows = DistanceRows(held, None, self.distances(len(x))[held], self.sign, centres, box=self.box)
        return rows.take(rows.values(x) <= search_radius)

    def updated(self, rows: DistanceRows, count: int) -> DistanceRows:
        return replace(
            rows, length=self.distances(count)[rows.i], anchor=np.tile(np.asarray(self.centre), (len(rows), 1))
        )

    def change_from(self, other: _Ball, x: NDArray[np.float64], search_radius: float) -> float:
        way, grown = (
            np.asarray(getattr(self, name)) - np.asarray(getattr(other, name)) for name in ("centre", "distance")
        )
        return float(np.sqrt(way @ way) + np.abs(grown).max())


class OutsideBall(_Ball):
    """g_i(x) = |X_i - centre| - distance_i >= 0 for each particle i: an obstacle.

    ``centre`` has shape (d,); ``distance`` > 0 is one for all or has shape (n,): the radius of the obstacle plus that
    of the particle [length]. Each may be a function of time: t -> value. ``particles`` (n,) are those that the obstacle
    holds back, each at most once; None: all.
    """

    sign = 1.0


class InsideBall(_Ball):
    """g_i(x) = distance_i - |X_i - centre| >= 0 for each particle i: a container.

    ``centre`` has shape (d,); ``distance`` > 0 is one for all or has shape (n,): the radius of the container less that
    of the particle [length]. Each may be a function of time: t -> value. ``particles`` (n,) are those that it contains,
    each at most once; None: all.
    """

    sign = -1.0
