"""The sparse factor L D L^T of the Gram matrix of many rows, for which any subset of them can be switched off.

Rows are eliminated in an order of least fill (``sparse_order``), which depends on the rows alone. It is kept while
rows of the same list are switched on and off: such a row is left out of the numbers, and stays in the pattern.
Lerner, Düring and Wyart (arXiv 1111.7225) advance packings of hard particles from contact to contact with the same
matrix of contacts.
"""

from typing import NamedTuple

import numpy as np

from dincl.compiled import inner
from dincl.compiled.arrays import Floats, Offsets
from dincl.rows.table import RowTable

# Fewer rows than these are factorised as fast by their envelope, and give the same bits as ever.
# Measured: runs of piles of 20, 30, 60 and 100 discs take 0.92, 0.85, 0.75 and 0.67 of the time with this factor.
SPARSE_FROM = 32
# Entries of the factor for which there is room, for each row. A pile of 1,000 discs at rest needs 14, 1,000 balls in a
# cubic lattice need 73, and 200 when each touches twelve others.
FILL = 256
# Bits of a word that are used, so that all words are numbers >= 0.
BITS = 62


class SparseGram(NamedTuple):
    """The factor for ``number[0]`` analysed rows; place k in the order of elimination is that of row ``row[k]``.

    The factor is kept by columns: ``value[start[k]:start[k + 1]]`` in the places ``entry``, ascending. Each row of it
    lists its columns, and where in ``value`` its entry is. ``number[1]`` rows are used.
    """

    number: Offsets
    row: Offsets  # (most,)
    place: Offsets  # (m,): the place of a row, or -1
    used: Offsets  # (most,): 1 for rows that are not switched off
    start: Offsets  # (most + 1,)
    entry: Offsets
    value: Floats
    line: Offsets  # (most + 1,): where the columns of each row begin
    column: Offsets
    where: Offsets
    gram: Offsets  # (most + 1,): where the earlier places begin that a row shares coordinates with
    neighbour: Offsets
    inverse: Floats  # (most,): 1 / D, 0 for a row that is not used
    right: Floats  # (most,): a right-hand side by place, solved in place
    work: Floats  # (most,): all zeros
    dense: Floats  # (n,): all zeros
    bits: Offsets  # (most, words): room for the analysis
    degree: Offsets  # (most,)
    left: Offsets  # (most,)
    first: Offsets  # (n,): the first node of each coordinate, and for each node its row and the next one
    node: Offsets
    following: Offsets


def room_for_gram(most: int, n: int, m: int, entries: int) -> SparseGram:
    """Room for ``most`` of m rows of n coordinates, whose entries are together at most ``entries``."""
    fill = min(most * (most + 1) // 2, FILL * most)
    many = {name: np.zeros(fill, dtype=np.int64) for name in ("entry", "column", "where", "neighbour")}
    names = ("row", "used", "start", "line", "gram", "degree", "left")
    lists = {name: np.zeros(most + 1, dtype=np.int64) for name in names}
    return SparseGram(
        number=np.zeros(2, dtype=np.int64),
        place=np.full(m, -1),
        value=np.zeros(fill),
        inverse=np.zeros(most),
        right=np.zeros(most),
        work=np.zeros(most),
        dense=np.zeros(n),
        bits=np.zeros((most, most // BITS + 1), dtype=np.int64),
        first=np.zeros(n, dtype=np.int64),
        node=np.zeros(entries, dtype=np.int64),
        following=np.zeros(entries, dtype=np.int64),
        **lists,
        **many,
    )


@inner
def refactor(rows: RowTable, gradient: Floats, gram: SparseGram, least: float) -> int:
    """Factorise for the rows in use; a row whose pivot is not above ``least`` depends on others and is switched off.

    Returns how many were switched off. Up-looking, as in QDLDL (Stellato et al. 2020): row k of L is found by solving
    with the rows above it.
    """
    work, value, inverse, entry, start = gram.work, gram.value, gram.inverse, gram.entry, gram.start
    column, where, line, dense, used, row = gram.column, gram.where, gram.line, gram.dense, gram.used, gram.row
    begins, neighbour, first, ends, place = gram.gram, gram.neighbour, rows.start, rows.stop, rows.column
    dropped, count = 0, 0
    for k in range(gram.number[0]):
        inverse[k] = 0.0
        if used[k] == 0:
            for p in range(line[k], line[k + 1]):
                value[where[p]] = 0.0
            continue
        pivot, r = 0.0, row[k]
        for p in range(first[r], ends[r]):
            dense[place[p]] += gradient[p]
        for p in range(first[r], ends[r]):
            pivot += gradient[p] * dense[place[p]]
        for q in range(begins[k], begins[k + 1]):
            if used[neighbour[q]] != 0:
                other, total = row[neighbour[q]], 0.0
                for p in range(first[other], ends[other]):
                    total += gradient[p] * dense[place[p]]
                work[neighbour[q]] = total
        for p in range(first[r], ends[r]):
            dense[place[p]] = 0.0
        for p in range(line[k], line[k + 1]):
            j, last = column[p], where[p]
            entry_of_row = work[j]
            work[j] = 0.0
            if entry_of_row != 0.0:
                for s in range(start[j], last):
                    work[entry[s]] -= value[s] * entry_of_row
            value[last] = entry_of_row * inverse[j]
            pivot -= entry_of_row * value[last]
        if pivot > least:
            inverse[k] = 1.0 / pivot
            count += 1
        else:
            used[k] = 0
            dropped += 1
            for p in range(line[k], line[k + 1]):
                value[where[p]] = 0.0
    gram.number[1] = count
    return dropped


@inner
def solve_sparse(gram: SparseGram) -> None:
    """Solve L D L^T y = right for the rows in use; y is zero for others."""
    right, value, entry, start, inverse = gram.right, gram.value, gram.entry, gram.start, gram.inverse
    count = gram.number[0]
    for k in range(count):
        found = right[k]
        if found != 0.0:
            for s in range(start[k], start[k + 1]):
                right[entry[s]] -= value[s] * found
    for k in range(count - 1, -1, -1):
        found = right[k] * inverse[k]
        for s in range(start[k], start[k + 1]):
            found -= value[s] * right[entry[s]]
        right[k] = found
