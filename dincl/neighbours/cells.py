"""Parts of all grids: discs sorted by cell, the comparison of two of them, lists of pairs that grow and are sorted."""

from typing import NamedTuple

import numpy as np

from dincl.compiled import inner, maker
from dincl.compiled.arrays import Axes, Floats, Indices, Offsets

# A grid spans at most so many axes; distances always use all of them.
GRID_AXES = 3
# Room for so many pairs per disc to begin with.
PAIRS_PER_DISC = 4
# A longer list would take more than a gigabyte: discs lie on top of each other, not side by side.
MOST_PAIRS = 50_000_000


class TooManyPairs(Exception):
    """More than MOST_PAIRS candidates are near each other."""


class Sorted(NamedTuple):
    """Discs in the order of their cells, so that those of one cell lie side by side."""

    first: Indices  # (cells + 1,): cell c holds the places first[c] ... first[c + 1] - 1
    disc: Indices  # (n,): the disc at each place, ascending in each cell
    x: Floats  # (n, d)
    reach: Floats  # (n,)


@maker
def sort_by_cell(cell: Indices, cells: int, x: Floats, reach: Floats, axes: Axes) -> Sorted:
    """Sort the discs by the number of their cell, each in 0 .. cells - 1: a counting sort."""
    first = np.zeros(cells + 2, np.int32)
    for i in range(cell.size):
        first[cell[i] + 2] += 1
    for c in range(2, first.size):
        first[c] += first[c - 1]
    disc = np.empty(cell.size, np.int32)
    x_sorted = np.empty_like(x)
    reach_sorted = np.empty_like(reach)
    for i in range(cell.size):
        place = first[cell[i] + 1]
        first[cell[i] + 1] = place + 1
        disc[place] = i
        reach_sorted[place] = reach[i]
        for k in range(len(axes)):
            x_sorted[place, k] = x[i, k]
    return Sorted(first[: cells + 1], disc, x_sorted, reach_sorted)


@inner
def is_near(x: Floats, reach: Floats, i: int, j: int, axes: Axes) -> bool:
    """Whether |X_i - X_j| <= reach_i + reach_j, compared by their squares."""
    square = 0.0
    for k in range(len(axes)):
        difference = x[i, k] - x[j, k]
        square += difference * difference
    limit = reach[i] + reach[j]
    return bool(square <= limit * limit)


@maker
def longer(pairs: Indices, count: int, more: int) -> Indices:
    """Copy pairs[:count] into a list with room for `more` others, twice over; TooManyPairs if that is too long."""
    if count + more > MOST_PAIRS:
        raise TooManyPairs
    copied = np.empty((2 * (count + more), 2), np.int32)
    for p in range(count):
        copied[p, 0], copied[p, 1] = pairs[p, 0], pairs[p, 1]
    return copied


@maker
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


@maker
def rows_of_pairs(pairs: Indices, n: int) -> tuple[Offsets, Indices]:
    """Sort pairs of discs, in linear time, into rows of the larger number.

    Parameters
    ----------
    pairs : (m, 2)
        Two different numbers in 0 .. n - 1 each, in any order.
    n : int
        Number of discs.

    Returns
    -------
    start : (n + 1,) int64
        Row offsets.
    entry : (m,) int32
        Row i holds the partners j < i, ascending.
    """
    smaller, larger = np.empty(len(pairs), np.int32), np.empty(len(pairs), np.int32)
    for p in range(len(pairs)):
        smaller[p], larger[p] = min(pairs[p, 0], pairs[p, 1]), max(pairs[p, 0], pairs[p, 1])
    start, larger = _group(smaller, larger, n)
    for j in range(n):
        for p in range(start[j], start[j + 1]):
            smaller[p] = j
    return _group(larger, smaller, n)
