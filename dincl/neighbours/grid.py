"""Near pairs of discs of similar reach that fill their bounding box: one dense grid of cells."""

import numpy as np

from dincl.compiled import kernel, maker
from dincl.compiled.arrays import Axes, Floats, Indices, Offsets
from dincl.neighbours.cells import GRID_AXES, PAIRS_PER_DISC, is_near, longer, rows_of_pairs, sort_by_cell

# A grid is used while the largest reach is at most this many times the smallest, ...
SPREAD_LIMIT = 3.0
# ... and while it has at most this many cells per disc, where a few discs may have as many as this hundred.
CELLS_PER_DISC = 8.0
FEW_DISCS = 100
# Cells exceed twice the largest reach by this factor, so that rounding cannot move near discs two cells apart.
CELL_MARGIN = 1.0 + 2.0**-20


@kernel
def grid_shape(x: Floats, reach: Floats) -> tuple[Offsets, Floats, float]:
    """Lay out one grid over all discs, with one empty cell around them.

    Parameters
    ----------
    x : (n, d)
        Centres [length], n >= 1.
    reach : (n,)
        Reaches [length].

    Returns
    -------
    shape : (3,) or (0,)
        Cells per axis, unused axes 1; empty if one grid would not do.
    low : (3,)
        Lowest coordinate per axis [length].
    edge : float
        Edge of a cell [length].
    """
    shape = np.zeros(GRID_AXES, np.int64)
    low = np.zeros(GRID_AXES)
    largest, smallest = reach[0], reach[0]
    for i in range(reach.size):
        largest, smallest = max(largest, reach[i]), min(smallest, reach[i])
    edge = 2.0 * CELL_MARGIN * largest
    fits = largest <= SPREAD_LIMIT * smallest
    room = CELLS_PER_DISC * max(x.shape[0], FEW_DISCS)
    for k in range(GRID_AXES):
        shape[k] = 1
    for k in range(min(x.shape[1], GRID_AXES)):
        lowest, highest = x[0, k], x[0, k]
        for i in range(x.shape[0]):
            if x[i, k] < lowest:
                lowest = x[i, k]
            if x[i, k] > highest:
                highest = x[i, k]
        low[k] = lowest
        cells = (highest - lowest) / edge + 3.0
        room /= cells
        fits = fits and room >= 1.0
        shape[k] = int(cells) if fits else 1
    return shape[: GRID_AXES if fits else 0], low, edge


@maker
def _cell_of_each(x: Floats, shape: Offsets, low: Floats, edge: float, axes: Axes) -> Indices:
    """Number of the cell of each disc, the last axis running fastest."""
    per_length = 1.0 / edge
    cell = np.empty(x.shape[0], np.int32)
    for i in range(x.shape[0]):
        number = 0
        for k in range(min(len(axes), GRID_AXES)):
            offset = (x[i, k] - low[k]) * per_length
            number = number * shape[k] + 1
            if offset > 0.0:  # false also where it is not a number, which must not become an index
                number += int(offset)
        cell[i] = number
    return cell


@maker
def _rows_ahead(shape: Offsets, axes: Axes) -> Offsets:
    """Steps from a cell to the middles of the rows of three cells, along the last axis, that follow it.

    Together with the cell next to it these are half of its neighbours; it follows the other half.
    """
    steps = np.zeros(4, np.int64)
    if len(axes) < 3:
        steps[0] = shape[1]
        return steps[: len(axes) - 1]
    row, layer = shape[2], shape[1] * shape[2]
    steps[0], steps[1], steps[2], steps[3] = row, layer - row, layer, layer + row
    return steps


@kernel
def grid_pairs(
    x: Floats, reach: Floats, shape: Offsets, low: Floats, edge: float, axes: Axes
) -> tuple[Offsets, Indices]:
    """Find near pairs in the grid laid out by :func:`grid_shape`; result as in ``neighbours.near_pairs``."""
    n = x.shape[0]
    cell = _cell_of_each(x, shape, low, edge, axes)
    first, disc, x_sorted, reach_sorted = sort_by_cell(cell, shape[0] * shape[1] * shape[2], x, reach, axes)
    ahead = _rows_ahead(shape, axes)
    pairs = np.empty((PAIRS_PER_DISC * n, 2), np.int32)
    count = 0
    for p in range(n):
        i = disc[p]
        here = cell[i]
        candidates = first[here + 2] - p
        for step in ahead:
            candidates += first[here + step + 2] - first[here + step - 1]
        if count + candidates > pairs.shape[0]:
            pairs = longer(pairs, count, candidates)
        # Every candidate is written and only a near one is counted: this spares a branch that nobody can predict.
        for q in range(p + 1, first[here + 2]):
            pairs[count, 0], pairs[count, 1] = i, disc[q]
            count += is_near(x_sorted, reach_sorted, p, q, axes)
        for step in ahead:
            for q in range(first[here + step - 1], first[here + step + 2]):
                pairs[count, 0], pairs[count, 1] = i, disc[q]
                count += is_near(x_sorted, reach_sorted, p, q, axes)
    return rows_of_pairs(pairs[:count], n)
