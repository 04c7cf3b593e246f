"""Lists of pairs in row form: (start, entry), the entries of row i being entry[start[i]:start[i + 1]]."""

import numpy as np

from dincl.compiled import maker
from dincl.kernels.arrays import Indices, Offsets


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
