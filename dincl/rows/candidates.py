"""Candidate rows: a list of the rows that can be violated near a point, reused while particles and sets move little."""

from typing import NamedTuple

import numpy as np

from dincl.compiled import inner
from dincl.compiled.arrays import Floats, Offsets, Table
from dincl.rows.table import CALLBACK, DISTANCE, RowTable, Sets, arrow_of, compare_sets, value_of


class CandidateRows(NamedTuple):
    """The candidates ``row[:number[0]]``, found in search number ``number[1]``; ``number[2]`` are pairs kept apart.

    ``chosen``, ``head`` and ``link`` are workspace: some of the rows, and lists of those that begin at one coordinate.
    """

    row: Offsets
    key: Floats
    number: Offsets
    reference: Floats  # (n,): the point of the search
    shift: Table  # (families, d): the displacements of the sets in the search
    time: Floats  # (1,): the time of the search
    radius: Floats  # (1,): the search radius
    chosen: Offsets  # (m,)
    head: Offsets  # (n,)
    link: Offsets  # (m,)
    search: int  # the address of the function that puts the candidates into the table; 0 if it holds all rows


def no_candidates(m: int, n: int, families: int, d: int, search: int = 0) -> CandidateRows:
    """Make an empty list for at most m rows."""
    row, number = np.zeros(m, dtype=np.int64), np.zeros(3, dtype=np.int64)
    shift, time, radius = np.zeros((families, d)), np.zeros(1), np.full(1, -1.0)
    chosen, head, link = (np.zeros(size, dtype=np.int64) for size in (m, n, m))
    return CandidateRows(row, np.zeros(m), number, np.zeros(n), shift, time, radius, chosen, head, link, search)


@inner
def find_candidates(rows: RowTable, sets: Sets, t: float, x: Floats, radius: float, near: CandidateRows) -> None:
    """List the rows that can be violated after each particle moved at most ``radius``, in their order."""
    count, pairs, d = 0, 0, sets.shift.shape[1]
    for r in range(rows.row.size):
        row = rows.row[r]
        margin = row.lipschitz * radius
        if row.kind == DISTANCE and row.sign > 0.0 and row.j >= 0:
            square, least = 0.0, row.length + margin
            for k in range(d):
                arrow = x[row.i * d + k] - x[row.j * d + k] if row.plain != 0 else arrow_of(rows, sets, r, x, k)
                square += arrow * arrow
            close = square <= least * least
        else:
            close = row.kind == CALLBACK or value_of(rows, sets, r, x) <= margin
        if close:
            near.row[count] = r
            count += 1
            pairs += row.kind == DISTANCE and row.sign > 0.0 and row.j >= 0
    near.number[0] = count
    near.number[2] = pairs
    note_search(sets, t, x, radius, near)


@inner
def note_search(sets: Sets, t: float, x: Floats, radius: float, near: CandidateRows) -> None:
    """Note the time, the point, the displacements and the radius of a search."""
    d = sets.shift.shape[1]
    near.number[1] += 1
    near.time[0] = sets.since[0] = t
    near.radius[0] = radius
    for k in range(x.size):
        near.reference[k] = x[k]
    for f in range(sets.shift.shape[0]):
        for k in range(d):
            near.shift[f, k] = sets.shift[f, k]
        sets.change[f] = 0.0


@inner
def sort_candidates(rows: RowTable, x: Floats, d: int, near: CandidateRows) -> None:
    """Sort the candidates along the axis along which the particles extend farthest, by Shell's sort."""
    axis, widest = 0, -1.0
    for k in range(d):
        low, high = x[k], x[k]
        for p in range(k, x.size, d):
            low, high = min(low, x[p]), max(high, x[p])
        if high - low > widest:
            axis, widest = k, high - low
    count = near.number[0]
    for p in range(count):
        r, near.key[p] = near.row[p], 0.0
        if rows.stop[r] > rows.start[r]:
            first, last = rows.column[rows.start[r]] // d, rows.column[rows.stop[r] - 1] // d
            near.key[p] = x[first * d + axis] + x[last * d + axis]
    step = 1
    while step < count // 3:
        step = 3 * step + 1
    while step > 0:
        for p in range(step, count):
            key, r, q = near.key[p], near.row[p], p
            while q >= step and near.key[q - step] > key:
                near.key[q], near.row[q] = near.key[q - step], near.row[q - step]
                q -= step
            near.key[q], near.row[q] = key, r
        step //= 3


@inner
def distance_from_search(sets: Sets, x: Floats, near: CandidateRows) -> float:
    """Compute the largest move of a particle plus the largest change of a set since the search."""
    d, moved, carried, changed = sets.shift.shape[1], 0.0, 0.0, 0.0
    compare_sets(sets, x)
    for i in range(x.size // d):
        square = 0.0
        for k in range(d):
            square += (x[i * d + k] - near.reference[i * d + k]) ** 2
        moved = max(moved, square)
    for f in range(sets.shift.shape[0]):
        square = 0.0
        for k in range(d):
            square += (sets.shift[f, k] - near.shift[f, k]) ** 2
        carried, changed = max(carried, square), max(changed, sets.change[f])
    return float(np.sqrt(moved) + max(np.sqrt(carried), changed))
