"""Close pairs of discs of similar radii that fill their bounding box: one dense grid of cells.

The parts that the hierarchy of grids shares stand first: discs sorted by cell, growing lists of pairs, sorted rows.
"""

from typing import NamedTuple

import numpy as np

from dincl.compiled import allocating, inner, kernel
from dincl.compiled.arrays import Axes, Floats, Indices, Offsets

# A grid spans at most so many axes; distances always use all of them.
GRID_AXES = 3
# Capacity of a list of pairs at the start, per disc.
PAIRS_PER_DISC = 4
# A longer list would take more than a gigabyte: discs lie on top of each other, not side by side.
MOST_PAIRS = 50_000_000
# A dense grid is used while the largest radius is at most this many times the smallest, ...
SPREAD_LIMIT = 3.0
# ... and while it has at most this many cells per disc, where a few discs may have as many as this hundred.
CELLS_PER_DISC = 8.0
FEW_DISCS = 100
# Cells exceed twice the largest radius by this factor, so that rounding cannot move close discs two cells apart.
CELL_MARGIN = 1.0 + 2.0**-20


class TooManyPairs(Exception):
    """More than MOST_PAIRS candidates."""


class SortedDiscs(NamedTuple):
    """Discs in the order of their cells, so that those of one cell lie side by side."""

    first: Indices  # (cells + 1,): cell c holds the places first[c] ... first[c + 1] - 1
    disc: Indices  # (n,): the disc at each place, ascending in each cell
    x: Floats  # (n, d)
    radius: Floats  # (n,)


@allocating
def sort_by_cell(cell: Indices, cells: int, x: Floats, radius: Floats, axes: Axes) -> SortedDiscs:
    """Sort the discs by the number of their cell, each in 0 .. cells - 1: a counting sort."""
    first = np.zeros(cells + 2, np.int32)
    for i in range(cell.size):
        first[cell[i] + 2] += 1
    for c in range(2, first.size):
        first[c] += first[c - 1]
    disc, x_sorted, radius_sorted = np.empty(cell.size, np.int32), np.empty_like(x), np.empty_like(radius)
    for i in range(cell.size):
        place = first[cell[i] + 1]
        first[cell[i] + 1] = place + 1
        disc[place], radius_sorted[place] = i, radius[i]
        for k in range(len(axes)):
            x_sorted[place, k] = x[i, k]
    return SortedDiscs(first[: cells + 1], disc, x_sorted, radius_sorted)


@inner
def is_close(x: Floats, radius: Floats, i: int, j: int, axes: Axes) -> bool:
    """Return whether |X_i - X_j| <= r_i + r_j, compared by their squares."""
    square = 0.0
    for k in range(len(axes)):
        difference = x[i, k] - x[j, k]
        square += difference * difference
    limit = radius[i] + radius[j]
    return bool(square <= limit * limit)


@allocating
def grown(pairs: Indices, count: int, more: int) -> Indices:
    """Copy pairs[:count] into a list with twice the capacity for `more` others; TooManyPairs if that is too long."""
    if count + more > MOST_PAIRS:
        raise TooManyPairs
    copied = np.empty((2 * (count + more), 2), np.int32)
    for p in range(count):
        copied[p, 0], copied[p, 1] = pairs[p, 0], pairs[p, 1]
    return copied


@allocating
def _group(key: Indices, value: Indices, rows: int) -> tuple[Offsets, Indices]:
    """Collect the values of equal key, each in 0 .. rows - 1, into rows, keeping their order: a counting sort."""
    place = np.zeros(rows + 2, np.int64)
    for p in range(key.size):
        place[key[p] + 2] += 1
    for i in range(2, rows + 2):
        place[i] += place[i - 1]
    entry = np.empty(key.size, np.int32)
    for p in range(key.size):
        entry[place[key[p] + 1]] = value[p]
        place[key[p] + 1] += 1
    return place[: rows + 1], entry


@allocating
def rows_of_pairs(pairs: Indices, n: int) -> tuple[Offsets, Indices]:
    """Sort pairs (m, 2) of n discs, in linear time, into rows of the larger number: offsets, ascending partners."""
    smaller, larger = np.empty(len(pairs), np.int32), np.empty(len(pairs), np.int32)
    for p in range(len(pairs)):
        smaller[p], larger[p] = min(pairs[p, 0], pairs[p, 1]), max(pairs[p, 0], pairs[p, 1])
    start, larger = _group(smaller, larger, n)
    for j in range(n):
        for p in range(start[j], start[j + 1]):
            smaller[p] = j
    return _group(larger, smaller, n)


@kernel
def grid_layout(x: Floats, radius: Floats) -> tuple[Offsets, Floats, float]:
    """Lay out one grid over n >= 1 discs, with one empty cell around them.

    Returns
    -------
    shape : (3,) or (0,)
        Cells per axis, unused axes 1; empty if one grid is not suitable.
    low : (3,)
        Lowest coordinate per axis [length].
    edge : float
        Edge of a cell [length].
    """
    shape, low = np.ones(GRID_AXES, np.int64), np.zeros(GRID_AXES)
    largest, smallest = radius[0], radius[0]
    for i in range(radius.size):
        largest, smallest = max(largest, radius[i]), min(smallest, radius[i])
    edge = 2.0 * CELL_MARGIN * largest
    fits = largest <= SPREAD_LIMIT * smallest
    allowed = CELLS_PER_DISC * max(x.shape[0], FEW_DISCS)
    for k in range(min(x.shape[1], GRID_AXES)):
        lowest, highest = x[0, k], x[0, k]
        for i in range(x.shape[0]):
            if x[i, k] < lowest:
                lowest = x[i, k]
            if x[i, k] > highest:
                highest = x[i, k]
        low[k] = lowest
        cells = (highest - lowest) / edge + 3.0
        allowed /= cells
        fits = fits and allowed >= 1.0
        shape[k] = int(cells) if fits else 1
    return shape[: GRID_AXES if fits else 0], low, edge


@allocating
def _cell_of_each(x: Floats, shape: Offsets, low: Floats, edge: float, axes: Axes) -> Indices:
    """Compute the number of the cell of each disc, the last axis running fastest."""
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


@allocating
def _rows_ahead(shape: Offsets, axes: Axes) -> Offsets:
    """Compute the steps from a cell to the middles of the following rows of three cells along the last axis.

    Together with the next cell these are half of its neighbours; it follows the other half.
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
    x: Floats, radius: Floats, shape: Offsets, low: Floats, edge: float, axes: Axes
) -> tuple[Offsets, Indices]:
    """Find close pairs in the grid of :func:`grid_layout`; result as of ``neighbour_pairs``."""
    n = x.shape[0]
    cell = _cell_of_each(x, shape, low, edge, axes)
    first, disc, x_sorted, radius_sorted = sort_by_cell(cell, shape[0] * shape[1] * shape[2], x, radius, axes)
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
            pairs = grown(pairs, count, candidates)
        # Every candidate is written and only a close one is counted: this spares a branch that nobody can predict.
        for q in range(p + 1, first[here + 2]):
            pairs[count, 0], pairs[count, 1] = i, disc[q]
            count += is_close(x_sorted, radius_sorted, p, q, axes)
        for step in ahead:
            for q in range(first[here + step - 1], first[here + step + 2]):
                pairs[count, 0], pairs[count, 1] = i, disc[q]
                count += is_close(x_sorted, radius_sorted, p, q, axes)
    return rows_of_pairs(pairs[:count], n)
