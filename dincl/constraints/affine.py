"""Affine sets: a wall, and an order of particles along an axis."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.checks import array, describe, indices, integer, lengths, number, vector, within
from dincl.constants import LARGEST
from dincl.constraints.base import Constraint
from dincl.constraints.timed import Timed, for_members, members
from dincl.errors import InvalidProblem
from dincl.matrices import from_equal_rows
from dincl.rows.affine import AffineRows, HeightRows

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
