"""The sparse factor L D L^T of the Gram matrix of many rows, in which any subset of the rows can be switched off.

Rows are eliminated in an order of minimum degree; a row that is switched off keeps its place in the pattern. Lerner,
Düring and Wyart (arXiv 1111.7225) advance packings of hard particles from contact to contact with the same matrix.
"""

from typing import Any, NamedTuple

import numpy as np

from dincl.compiled import inner
from dincl.compiled.arrays import Floats, Offsets
from dincl.rows.table import RowTable

# Fewer rows than these are factorised as fast by their envelope. Measured: runs of piles of 20, 30, 60 and 100 discs
# take 0.92, 0.85, 0.75 and 0.67 of the time with this factor.
SPARSE_FROM = 32
# Capacity of the factor, entries for each row. A pile of 1,000 discs at rest needs 14, 1,000 balls in a cubic lattice
# need 73, and 200 when each touches twelve others.
FILL = 256
# An analysis also serves fewer rows: this part of them, and this many, may be switched off.
SPARE, FEW = 0.1, 32
BITS = 62  # of a word are used, so that all words are numbers >= 0


class SparseFactor(NamedTuple):
    """The factor for ``number[0]`` analysed rows, of which ``number[1]`` are used; row ``row[k]`` is eliminated at k.

    Column k of L is ``value[start[k]:start[k + 1]]`` in the rows ``entry``. Row k has entries in the columns
    ``column[line[k]:line[k + 1]]``, and these are at ``where`` in ``value``.
    """

    number: Offsets
    row: Offsets  # (most + 1,)
    place: Offsets  # (m,): the place of a row in the order of elimination, or -1
    used: Offsets  # (most + 1,): 1 for rows that are not switched off
    start: Offsets  # (most + 1,)
    entry: Offsets
    value: Floats
    line: Offsets  # (most + 1,)
    column: Offsets
    where: Offsets
    gram: Offsets  # (most + 1,): row k shares coordinates with ``neighbour[gram[k]:gram[k + 1]]``, which are < k
    neighbour: Offsets
    inverse: Floats  # (most,): 1 / D, 0 for a row that is not used
    right: Floats  # (most,): a right-hand side by place, solved in place
    work: Floats  # (most,): all zeros
    dense: Floats  # (n,): all zeros
    bits: Offsets  # (most, words): the graph of rows that share coordinates, during the analysis
    degree: Offsets  # (most + 1,)
    left: Offsets  # (most + 1,)
    first: Offsets  # (n,): the first node of each coordinate; a node holds a row and the next node
    node: Offsets
    following: Offsets


def sparse_factor(most: int, n: int, m: int, entries: int) -> SparseFactor:
    """Allocate a factor for ``most`` of m rows of n coordinates, which together have at most ``entries`` entries."""
    fill = FILL * most
    numbers = {"number": 2, "first": n, "node": entries, "following": entries}
    numbers |= dict.fromkeys(("entry", "column", "where", "neighbour"), fill)
    numbers |= dict.fromkeys(("row", "used", "start", "line", "gram", "degree", "left"), most + 1)
    floats = {"value": fill, "inverse": most, "right": most, "work": most, "dense": n}
    arrays: dict[str, Any] = {name: np.zeros(size, dtype=np.int64) for name, size in numbers.items()}
    arrays |= {name: np.zeros(size) for name, size in floats.items()}
    bits = np.zeros((most, most // BITS + 1), dtype=np.int64)
    return SparseFactor(place=np.full(m, -1), bits=bits, **arrays)


@inner
def refactor(rows: RowTable, gradient: Floats, factor: SparseFactor, least: float) -> int:
    """Factorise for the rows in use; a row whose pivot is not above ``least`` depends on others and is switched off.

    Returns how many were switched off. Up-looking, as in QDLDL (Stellato et al. 2020): row k of L is found by solving
    with the rows above it.
    """
    work, value, inverse, entry, start = factor.work, factor.value, factor.inverse, factor.entry, factor.start
    column, where, line, dense, used = factor.column, factor.where, factor.line, factor.dense, factor.used
    row, begins, neighbour = factor.row, factor.gram, factor.neighbour
    first, ends, place = rows.start, rows.stop, rows.column
    dropped, count = 0, 0
    for k in range(factor.number[0]):
        inverse[k] = 0.0
        if used[k] == 0:
            for p in range(line[k], line[k + 1]):
                value[where[p]] = 0.0
            continue
        pivot, r = 0.0, row[k]
        for p in range(first[r], ends[r]):
            dense[place[p]] += gradient[p]
            pivot += gradient[p] * gradient[p]
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
    factor.number[1] = count
    return dropped


@inner
def switch_off(factor: SparseFactor) -> None:
    """Use no row."""
    for k in range(factor.number[0]):
        factor.used[k] = 0
    factor.number[1] = 0


@inner
def solve_sparse(factor: SparseFactor) -> None:
    """Solve L D L^T y = right for the rows in use; y is zero for others."""
    right, value, entry, start, inverse = factor.right, factor.value, factor.entry, factor.start, factor.inverse
    count = factor.number[0]
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


@inner
def covers(listed: Offsets, count: int, factor: SparseFactor) -> bool:
    """Whether the listed rows are analysed, and not too many others."""
    covered = factor.number[0] <= (1.0 + SPARE) * count + 2 * FEW
    for k in range(count):
        covered = covered and factor.place[listed[k]] >= 0
    return bool(covered)


@inner
def analyse(rows: RowTable, listed: Offsets, count: int, factor: SparseFactor) -> bool:
    """Order ``count`` listed rows and find the pattern of their factor; False if it exceeds the capacity."""
    for k in range(factor.number[0]):
        factor.place[factor.row[k]] = -1
    factor.number[0] = factor.number[1] = 0
    if count > factor.inverse.size:
        return False
    build_graph(rows, listed, count, factor)
    order(listed, count, factor)
    factor.number[0] = count
    if find_pattern(listed, factor) and find_neighbours(rows, listed, factor):
        return True
    for k in range(count):
        factor.place[listed[k]] = -1
    factor.number[0] = 0
    return False


@inner
def build_graph(rows: RowTable, listed: Offsets, count: int, factor: SparseFactor) -> None:
    """List the rows of each coordinate, and set for each row the bits of the rows with which it shares one."""
    bits, first, nodes = factor.bits, factor.first, 0
    first[:] = -1
    bits[:count, : count // BITS + 1] = 0
    for k in range(count):
        r = listed[k]
        for p in range(rows.start[r], rows.stop[r]):
            node = first[rows.column[p]]
            while node >= 0:
                other = factor.node[node]
                if other != k:
                    bits[k, other // BITS] |= 1 << (other % BITS)
                    bits[other, k // BITS] |= 1 << (k % BITS)
                node = factor.following[node]
            factor.node[nodes], factor.following[nodes] = k, first[rows.column[p]]
            first[rows.column[p]] = nodes
            nodes += 1


@inner
def ones(word: int) -> int:
    """Count the bits of a word >= 0."""
    word = word - ((word >> 1) & 0x5555555555555555)
    word = (word & 0x3333333333333333) + ((word >> 2) & 0x3333333333333333)
    word = (word + (word >> 4)) & 0x0F0F0F0F0F0F0F0F
    return (word * 0x0101010101010101) >> 56


@inner
def order(listed: Offsets, count: int, factor: SparseFactor) -> None:
    """Eliminate the row with the fewest neighbours repeatedly; its neighbours become neighbours of each other.

    The bits of an eliminated row stay as they are: they are its column of the factor.
    """
    bits, degree, left, words = factor.bits, factor.degree, factor.left, count // BITS + 1
    for k in range(count):
        degree[k], left[k] = 0, k
        for w in range(words):
            degree[k] += ones(bits[k, w])
    alive, bound, at = count, 0, 0
    for k in range(count):
        # The search ends at a row whose degree is at most the last one: hardly any degree is smaller.
        at = at if at < alive else 0
        for q in range(alive):
            if degree[left[at]] <= bound:
                break
            if degree[left[q]] < degree[left[at]]:
                at = q
        chosen = left[at]
        alive -= 1
        left[at], left[alive] = left[alive], chosen
        factor.row[k], factor.place[listed[chosen]] = listed[chosen], k
        bound = degree[chosen]
        for w in range(words):
            rest = bits[chosen, w]
            while rest != 0:
                low = rest & -rest
                rest ^= low
                other, total = w * BITS + ones(low - 1), 0
                for v in range(words):
                    bits[other, v] |= bits[chosen, v]
                bits[other, w] ^= low
                bits[other, chosen // BITS] ^= 1 << (chosen % BITS)
                for v in range(words):
                    total += ones(bits[other, v])
                degree[other] = total


@inner
def find_pattern(listed: Offsets, factor: SparseFactor) -> bool:
    """Find the entries of L by rows and by columns, both ascending; False if they exceed the capacity."""
    line, start, entry, column, filled = factor.line, factor.start, factor.entry, factor.column, factor.degree
    count, total = factor.number[0], 0
    line[: count + 1] = filled[:count] = 0
    for k in range(count):
        start[k] = total
        for w in range(count // BITS + 1):
            rest = factor.bits[factor.left[count - 1 - k], w]
            while rest != 0:
                low = rest & -rest
                rest ^= low
                if total == entry.size:
                    return False
                entry[total] = factor.place[listed[w * BITS + ones(low - 1)]]
                line[entry[total] + 1] += 1
                total += 1
    start[count] = total
    for k in range(count):
        line[k + 1] += line[k]
    for k in range(count):
        for s in range(start[k], start[k + 1]):
            column[line[entry[s]] + filled[entry[s]]] = k
            filled[entry[s]] += 1
    # Going through the rows of L sorts its columns.
    for k in range(count):
        filled[k] = start[k]
    for k in range(count):
        for p in range(line[k], line[k + 1]):
            factor.where[p], entry[filled[column[p]]] = filled[column[p]], k
            filled[column[p]] += 1
    return True


@inner
def find_neighbours(rows: RowTable, listed: Offsets, factor: SparseFactor) -> bool:
    """List for each place the earlier places with which it shares coordinates; False if they exceed the capacity."""
    met, total = factor.degree, 0
    met[: factor.number[0]] = -1
    for k in range(factor.number[0]):
        r, factor.gram[k] = factor.row[k], total
        for p in range(rows.start[r], rows.stop[r]):
            node = factor.first[rows.column[p]]
            while node >= 0:
                other = factor.place[listed[factor.node[node]]]
                if other < k and met[other] != k:
                    if total == factor.neighbour.size:
                        return False
                    met[other], factor.neighbour[total] = k, other
                    total += 1
                node = factor.following[node]
    factor.gram[factor.number[0]] = total
    return True
