"""Pairs of discs that are close to each other: all (i, j) with |X_i - X_j| <= r_i + r_j for search radii r.

Three searches give the same lists: all pairs for few discs, one grid for discs of similar radii that fill their
bounding box, and a hierarchy of hashed grids for everything else.
"""

import numpy as np

from dincl.compiled import inner, kernel
from dincl.compiled.arrays import Axes, Floats, Indices, Offsets, axes_of
from dincl.errors import StepFailure
from dincl.neighbours import ALL_PAIRS
from dincl.neighbours.grid import MOST_PAIRS, TooManyPairs, grid_layout, grid_pairs
from dincl.neighbours.hierarchy import hierarchy_pairs
from dincl.rows.formulas import square_distance
from dincl.status import Status


def neighbour_pairs(x: Floats, radius: Floats) -> tuple[Offsets, Indices]:
    """List, for each disc i, all j < i with |X_i - X_j| <= r_i + r_j.

    The cost is linear in n plus the number of pairs, however unequal the radii and however far apart the discs.

    Parameters
    ----------
    x : (n, d), C-contiguous
        Centres [length], any d >= 1. A disc whose centre is not a number has no neighbours.
    radius : (n,)
        Search radii r [length]; between 1e-150 and 1e150 so that squares neither vanish nor overflow.

    Returns
    -------
    start : (n + 1,) int64
        Row offsets.
    partner : (start[n],) int32
        The partners of disc i are ``partner[start[i]:start[i + 1]]``, ascending.

    Raises
    ------
    StepFailure
        CROWDED when there are more than MOST_PAIRS candidates.

    Notes
    -----
    Collision detection in linear time: thesis, Remark 2.6.
    """
    if x.shape[0] <= ALL_PAIRS:
        return compared_pairs(x, radius, axes_of(x))
    shape, low, cell = grid_layout(x, radius)
    try:
        if shape.size > 0:
            return grid_pairs(x, radius, shape, low, cell, axes_of(x))
        return hierarchy_pairs(x, radius, axes_of(x))
    except TooManyPairs:
        detail = f"More than {MOST_PAIRS:,} pairs of particles are close to each other."
        raise StepFailure(Status.CROWDED, detail) from None


@kernel
def compared_pairs(x: Floats, radius: Floats, axes: Axes) -> tuple[Offsets, Indices]:
    """List the same pairs as :func:`neighbour_pairs` by comparing all n (n - 1) / 2 of them."""
    n = x.shape[0]
    start, partner = np.zeros(n + 1, np.int64), np.empty(n * (n - 1) // 2, np.int32)
    compare_all(x.ravel(), radius, 0.0, start, partner, axes)
    return start, partner[: start[n]]


@inner
def compare_all(x: Floats, radius: Floats, skin: float, start: Offsets, partner: Indices, axes: Axes) -> None:
    """Write the pairs with |X_i - X_j| <= r_i + r_j + 2 skin, x (n d,), into ``start`` and ``partner``."""
    d, count = len(axes), 0
    for i in range(radius.size):
        for j in range(i):
            # Every pair is written and only a close one is counted: this spares a branch that nobody can predict.
            partner[count] = j
            limit = radius[i] + radius[j] + 2.0 * skin
            count += square_distance(x, i * d, x, j * d, axes) <= limit * limit
        start[i + 1] = count
