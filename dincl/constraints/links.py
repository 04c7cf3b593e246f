"""Threads: pairs that may come as close as they like, but no farther apart than a given length."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from dincl.checks import indices, lengths, spread, within
from dincl.constraints.base import Constraint
from dincl.errors import InvalidProblem
from dincl.rows.distance import DistanceRows

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True, eq=False)
class MaxDistance(Constraint):
    """g_k(x) = length_k - |X_i - X_j| >= 0 for the pairs (i, j) in their order.

    Parameters
    ----------
    pairs
        Particle indices, shape (m, 2), two different ones in each pair.
    length
        Greatest distance, > 0, one for all pairs or shape (m,) [length].
    """

    pairs: ArrayLike
    length: ArrayLike

    def __post_init__(self) -> None:
        pairs = indices("pairs", self.pairs, columns=2)
        same = np.flatnonzero(pairs[:, 0] == pairs[:, 1])
        if same.size:
            raise InvalidProblem(f"pairs[{same[0]}] = {pairs[same[0]].tolist()}: must name two different particles")
        length = lengths("length", self.length, positive=True)
        object.__setattr__(self, "pairs", pairs)
        object.__setattr__(self, "length", spread("length", length, len(pairs), "pairs"))

    def check(self, count: int, d: int) -> None:
        within("pairs", np.asarray(self.pairs), count)

    def rows(self) -> DistanceRows:
        """All rows."""
        pairs = np.asarray(self.pairs)
        return DistanceRows(pairs[:, 0].copy(), pairs[:, 1].copy(), np.asarray(self.length), -1.0)

    def select(self, x: NDArray[np.float64], reach: float) -> DistanceRows:
        """The threads with a slack of at most 2 reach."""
        rows = self.rows()
        return rows.take(rows.values(x) <= 2 * reach)
