"""Pairs of discs that are near each other: all (i, j) with |X_i - X_j| <= reach_i + reach_j.

Three searches give the same lists: all pairs for few discs, one grid for discs of similar reach that fill their
bounding box, and a hierarchy of hashed grids for everything else.
"""

import numpy as np

from dincl.compiled import kernel
from dincl.compiled.arrays import Axes, Floats, Indices, Offsets, axes_of
from dincl.errors import StepFailure
from dincl.neighbours.cells import MOST_PAIRS, TooManyPairs, is_near
from dincl.neighbours.grid import grid_pairs, grid_shape
from dincl.neighbours.hierarchy import hierarchy_pairs
from dincl.status import Status

# Below this number of discs comparing all pairs is faster than building a grid (measured for d = 2 and 3).
BRUTE_FORCE_LIMIT = 90


def near_pairs(x: Floats, reach: Floats) -> tuple[Offsets, Indices]:
    """List, for each disc i, all j < i with |X_i - X_j| <= reach_i + reach_j.

    The cost is linear in n plus the number of pairs, however unequal the reaches and however far apart the discs.

    Parameters
    ----------
    x : (n, d), C-contiguous
        Centres [length], any d >= 1. A disc whose centre is not a number is near none.
    reach : (n,)
        Reaches [length]; between 1e-150 and 1e150 so that squares neither vanish nor overflow.

    Returns
    -------
    start : (n + 1,) int64
        Row offsets.
    partner : (start[n],) int32
        The partners of disc i are ``partner[start[i]:start[i + 1]]``, ascending.

    Raises
    ------
    StepFailure
        CROWDED when more than MOST_PAIRS are near each other.

    Notes
    -----
    Collision detection in linear time: thesis, Remark 2.6.
    """
    if x.shape[0] <= BRUTE_FORCE_LIMIT:
        return brute_force_pairs(x, reach)
    shape, low, cell = grid_shape(x, reach)
    try:
        if shape.size > 0:
            return grid_pairs(x, reach, shape, low, cell, axes_of(x))
        return hierarchy_pairs(x, reach, axes_of(x))
    except TooManyPairs:
        detail = f"More than {MOST_PAIRS:,} pairs of particles are near each other."
        raise StepFailure(Status.CROWDED, detail) from None


def brute_force_pairs(x: Floats, reach: Floats) -> tuple[Offsets, Indices]:
    """List the same pairs as :func:`near_pairs` by comparing all n (n - 1) / 2 of them; arguments as there."""
    return _all_pairs(x, reach, axes_of(x))


@kernel
def _all_pairs(x: Floats, reach: Floats, axes: Axes) -> tuple[Offsets, Indices]:
    n = x.shape[0]
    start = np.zeros(n + 1, np.int64)
    partner = np.empty(n * (n - 1) // 2, np.int32)
    count = 0
    for i in range(n):
        for j in range(i):
            partner[count] = j
            count += is_near(x, reach, i, j, axes)
        start[i + 1] = count
    return start, partner[:count]
