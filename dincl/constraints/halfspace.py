"""A wall."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from dincl.checks import array, lengths, number, spread, vector
from dincl.constants import LARGEST
from dincl.constraints.base import Constraint
from dincl.errors import InvalidProblem
from dincl.rows.affine import HeightRows

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True, eq=False)
class HalfSpace(Constraint):
    """g_i(x) = n . X_i - offset - r_i >= 0 for every particle i, with |n| = 1.

    Parameters
    ----------
    normal
        Inward normal, shape (d,); any length but zero, it is scaled to |n| = 1.
    offset
        Distance of the wall from the origin along the unit normal [length].
    radius
        What each particle keeps from the wall, >= 0, one for all or shape (N,) [length].
    """

    normal: ArrayLike
    offset: float = 0.0
    radius: ArrayLike = 0.0

    def __post_init__(self) -> None:
        normal = array("normal", self.normal)
        largest = np.abs(normal).max(initial=0.0)
        if normal.ndim != 1 or not largest > 1 / LARGEST:
            raise InvalidProblem(f"normal = {self.normal!r}: must be a vector of shape (d,) other than zero")
        scaled = normal / largest
        unit = scaled / np.sqrt(scaled @ scaled)
        unit.flags.writeable = False
        object.__setattr__(self, "normal", unit)
        object.__setattr__(self, "offset", number("offset", self.offset))
        object.__setattr__(self, "radius", lengths("radius", self.radius, positive=False))

    def check(self, count: int, d: int) -> None:
        vector("normal", np.asarray(self.normal), d)
        self.bounds(count)

    def bounds(self, count: int) -> NDArray[np.float64]:
        """The least allowed n . X_i, shape (count,)."""
        return self.offset + spread("radius", np.asarray(self.radius), count, "particles")

    def select(self, x: NDArray[np.float64], reach: float) -> HeightRows:
        """The particles closer to the wall than ``reach``."""
        normal, bound = np.asarray(self.normal), self.bounds(len(x))
        near = np.flatnonzero(x @ normal - bound <= reach)
        return HeightRows(normal, near, bound[near], len(x))
