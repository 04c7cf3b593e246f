"""Rows that keep the pairs of discs apart: all pairs, or those that are near each other."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dincl import kernels
from dincl.errors import StepFailure
from dincl.rows.distance import DistanceRows
from dincl.status import Status

if TYPE_CHECKING:
    from numpy.typing import NDArray


def near_pairs(x: NDArray[np.float64], reach: NDArray[np.float64]) -> tuple[NDArray[np.int64], NDArray[np.int32]]:
    """All (i, j < i) with |X_i - X_j| <= reach_i + reach_j, by rows, as in ``kernels.neighbours.near_pairs``."""
    try:
        found: tuple[NDArray[np.int64], NDArray[np.int32]] = kernels.neighbours.near_pairs(x, reach)
    except kernels.neighbours.TooManyPairs:
        most = kernels.neighbours.MOST_PAIRS
        raise StepFailure(Status.CROWDED, f"More than {most:,} pairs of particles are near each other.") from None
    return found


def all_pairs(radius: NDArray[np.float64], among: NDArray[np.int64] | None = None) -> DistanceRows:
    """|X_i - X_j| >= r_i + r_j for all pairs of discs, i ascending, for each i its j < i ascending.

    ``radius`` is that of the discs, shape (n,), ``among`` names them; None: they are all particles.
    """
    i, j = np.tril_indices(len(radius), -1)
    length = radius[i] + radius[j]
    return DistanceRows(i, j, length, 1.0) if among is None else DistanceRows(among[i], among[j], length, 1.0)
