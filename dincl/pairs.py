"""The near pairs of discs, or the Status of a crowd that has too many of them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dincl import kernels
from dincl.errors import StepFailure
from dincl.status import Status

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


def near_pairs(x: NDArray[np.float64], reach: NDArray[np.float64]) -> tuple[NDArray[np.int64], NDArray[np.int32]]:
    """All (i, j < i) with |X_i - X_j| <= reach_i + reach_j, by rows, as in ``kernels.neighbours.near_pairs``."""
    try:
        found: tuple[NDArray[np.int64], NDArray[np.int32]] = kernels.neighbours.near_pairs(x, reach)
    except kernels.neighbours.TooManyPairs:
        most = kernels.neighbours.MOST_PAIRS
        raise StepFailure(Status.CROWDED, f"More than {most:,} pairs of particles are near each other.") from None
    return found
