"""The Gram matrix A A^T of some rows of a sparse matrix A: where its entries are, and their numbers."""

import numpy as np

from dincl.compiled import allocating, kernel
from dincl.compiled.arrays import Flags, Floats, Offsets


@allocating
def _by_column(indptr: Offsets, indices: Offsets, columns: int, chosen: Offsets) -> tuple[Offsets, Offsets]:
    """Give the rows that have an entry in each column, as places in ``chosen``, ascending."""
    start = np.zeros(columns + 1, np.int64)
    for row in chosen:
        for p in range(indptr[row], indptr[row + 1]):
            start[indices[p]] += 1
    for column in range(columns):
        start[column + 1] += start[column]
    entry = np.empty(start[columns], np.int64)
    for k in range(chosen.size - 1, -1, -1):
        for p in range(indptr[chosen[k]], indptr[chosen[k] + 1]):
            start[indices[p]] -= 1
            entry[start[indices[p]]] = k
    return start, entry


@kernel
def gram_pattern(indptr: Offsets, indices: Offsets, columns: int, chosen: Offsets) -> tuple[Offsets, Offsets]:
    """Find the upper triangle of A_C A_C^T, the diagonal with it, for the rows C = ``chosen``.

    Parameters
    ----------
    indptr, indices, columns : (m + 1,), (k,), int
        The rows of A in compressed sparse row form, and how many columns it has.
    chosen : (c,)
        Numbers of rows, ascending.

    Returns
    -------
    start : (c + 1,)
        Offsets of the columns of the triangle.
    entry : (e,)
        For each column its rows, ascending; the last one is the diagonal.
    """
    first, with_entry = _by_column(indptr, indices, columns, chosen)
    met = np.zeros(chosen.size, np.int64)  # the last k that met it, plus 1
    start = np.zeros(chosen.size + 1, np.int64)
    room = np.empty(16 * chosen.size + 16, np.int64)
    size = 0
    for k in range(chosen.size):
        for p in range(indptr[chosen[k]], indptr[chosen[k] + 1]):
            column = indices[p]
            for q in range(first[column], first[column + 1]):
                other = with_entry[q]
                if other >= k:
                    break
                if met[other] != k + 1:
                    met[other] = k + 1
                    place = size
                    while place > start[k] and room[place - 1] > other:
                        room[place] = room[place - 1]
                        place -= 1
                    room[place] = other
                    size += 1
                    if size == room.size:
                        room = _longer(room)
        room[size] = k
        size += 1
        start[k + 1] = size
        if size == room.size:
            room = _longer(room)
    return start, room[:size]


@allocating
def _longer(entry: Offsets) -> Offsets:
    """Copy it, with room for as many others."""
    copied = np.empty(2 * entry.size, np.int64)
    for p in range(entry.size):
        copied[p] = entry[p]
    return copied


@kernel
def gram_values(
    indptr: Offsets,
    indices: Offsets,
    data: Floats,
    columns: int,
    chosen: Offsets,
    free: Flags,
    shift: float,
    start: Offsets,
    entry: Offsets,
    out: Floats,
) -> None:
    """Write A_F A_F^T + shift, F = the ``chosen`` rows that are ``free``, and the identity for those that are not.

    Parameters
    ----------
    indptr, indices, data, columns : (m + 1,), (k,), (k,), int
        The rows of A in compressed sparse row form, and how many columns it has.
    chosen : (c,)
        Numbers of rows, ascending.
    free : (m,)
        Which of the rows of A are in F.
    shift : float
        Added to the diagonal.
    start, entry : (c + 1,), (e,)
        The triangle that ``gram_pattern`` found for the rows.
    out : (e,)
        Its numbers.
    """
    dense = np.zeros(columns)
    for k in range(chosen.size):
        row, diagonal = chosen[k], start[k + 1] - 1
        if not free[row]:
            for q in range(start[k], diagonal):
                out[q] = 0.0
            out[diagonal] = 1.0
            continue
        for p in range(indptr[row], indptr[row + 1]):
            dense[indices[p]] = data[p]
        for q in range(start[k], start[k + 1]):
            other = chosen[entry[q]]
            total = 0.0
            if free[other]:
                for p in range(indptr[other], indptr[other + 1]):
                    total += data[p] * dense[indices[p]]
            out[q] = total
        out[diagonal] += shift
        for p in range(indptr[row], indptr[row + 1]):
            dense[indices[p]] = 0.0
