"""Particles that keep their order along an axis."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from dincl.checks import indices, integer, within
from dincl.constraints.base import Constraint
from dincl.errors import InvalidProblem
from dincl.matrices import from_equal_rows
from dincl.rows.affine import AffineRows

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


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
        chain = indices("chain", self.chain)
        if len(np.unique(chain)) != len(chain):
            raise InvalidProblem(f"chain = {self.chain!r}: must name each particle at most once")
        object.__setattr__(self, "chain", chain)
        object.__setattr__(self, "axis", integer("axis", self.axis, least=0))

    def check(self, count: int, d: int) -> None:
        within("chain", np.asarray(self.chain), count)
        if self.axis >= d:
            raise InvalidProblem(f"axis = {self.axis}: must be below the dimension d = {d}")

    def rows(self, x: NDArray[np.float64]) -> AffineRows:
        """All rows, for states of the shape of x."""
        columns = np.asarray(self.chain) * x.shape[1] + self.axis
        entries = np.column_stack((columns[1:], columns[:-1]))
        matrix = from_equal_rows(entries, np.tile([1.0, -1.0], (len(entries), 1)), x.size)
        return AffineRows(matrix, np.zeros(len(entries)))

    def select(self, x: NDArray[np.float64], reach: float) -> AffineRows:
        """The neighbours in the chain that are at most 2 reach apart."""
        rows = self.rows(x)
        return rows.take(rows.values(x) <= 2 * reach)
