"""The order in which rows are eliminated, least degree first, and where their factor has entries."""

from dincl.compiled import inner
from dincl.compiled.arrays import Offsets
from dincl.rows.table import RowTable
from dincl.solvers.sparse_factor import BITS, SparseGram

# An analysis serves also for fewer rows: this part of them, and this many, may be switched off.
SPARE, FEW = 0.1, 32


@inner
def covers(listed: Offsets, count: int, gram: SparseGram) -> bool:
    """Whether the listed rows are analysed, and not too many others."""
    covered = gram.number[0] <= (1.0 + SPARE) * count + 2 * FEW
    for k in range(count):
        covered = covered and gram.place[listed[k]] >= 0
    return bool(covered)


@inner
def analyse(rows: RowTable, listed: Offsets, count: int, gram: SparseGram) -> bool:
    """Order ``count`` listed rows and find the pattern of their factor; False if there is no room for it."""
    for k in range(gram.number[0]):
        gram.place[gram.row[k]] = -1
    gram.number[0] = gram.number[1] = 0
    if count > gram.inverse.size:
        return False
    link(rows, listed, count, gram)
    order(listed, count, gram)
    gram.number[0] = count
    if find_pattern(listed, gram) and find_neighbours(rows, listed, gram):
        return True
    for k in range(count):
        gram.place[listed[k]] = -1
    gram.number[0] = 0
    return False


@inner
def link(rows: RowTable, listed: Offsets, count: int, gram: SparseGram) -> None:
    """List the rows of each coordinate, and set for each row the bits of the rows with which it shares one."""
    bits, first, nodes = gram.bits, gram.first, 0
    for column in range(first.size):
        first[column] = -1
    for k in range(count):
        for w in range(count // BITS + 1):
            bits[k, w] = 0
    for k in range(count):
        r = listed[k]
        for p in range(rows.start[r], rows.stop[r]):
            node = first[rows.column[p]]
            while node >= 0:
                other = gram.node[node]
                if other != k:
                    bits[k, other // BITS] |= 1 << (other % BITS)
                    bits[other, k // BITS] |= 1 << (k % BITS)
                node = gram.following[node]
            gram.node[nodes], gram.following[nodes] = k, first[rows.column[p]]
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
def order(listed: Offsets, count: int, gram: SparseGram) -> None:
    """Eliminate the row with the fewest neighbours again and again; its neighbours become neighbours of each other.

    The bits of an eliminated row stay as they are: they are its column of the factor.
    """
    bits, degree, left, words = gram.bits, gram.degree, gram.left, count // BITS + 1
    for k in range(count):
        degree[k], left[k] = 0, k
        for w in range(words):
            degree[k] += ones(bits[k, w])
    alive, bound, at = count, 0, 0
    for k in range(count):
        at = least_degree(gram, alive, at, bound)
        chosen = left[at]
        alive -= 1
        left[at], left[alive] = left[alive], chosen
        gram.row[k], gram.place[listed[chosen]] = listed[chosen], k
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
def least_degree(gram: SparseGram, alive: int, at: int, bound: int) -> int:
    """Where among the rows that are left one has least degree; ``bound`` is what none can be below."""
    left, degree = gram.left, gram.degree
    best = at if at < alive else 0
    for q in range(alive):
        if degree[left[best]] <= bound:
            break
        if degree[left[q]] < degree[left[best]]:
            best = q
    return best


@inner
def find_pattern(listed: Offsets, gram: SparseGram) -> bool:
    """Find where the factor has entries, by its rows and by its columns, both ascending; False if there is no room."""
    count, line, start, filled = gram.number[0], gram.line, gram.start, gram.degree
    for k in range(count + 1):
        line[k] = start[k] = 0
    for fill in range(2):
        for k in range(count):
            for w in range(count // BITS + 1):
                rest = gram.bits[gram.left[count - 1 - k], w]
                while rest != 0:
                    low = rest & -rest
                    rest ^= low
                    later = gram.place[listed[w * BITS + ones(low - 1)]]
                    if fill == 0:
                        line[later + 1] += 1
                        start[k + 1] += 1
                    else:
                        gram.column[line[later] + filled[later]] = k
                        filled[later] += 1
        if fill == 0:
            for k in range(count):
                line[k + 1] += line[k]
                start[k + 1] += start[k]
                filled[k] = 0
            if start[count] > gram.value.size:
                return False
    for k in range(count):
        filled[k] = start[k]
    for k in range(count):
        for p in range(line[k], line[k + 1]):
            j = gram.column[p]
            gram.where[p], gram.entry[filled[j]] = filled[j], k
            filled[j] += 1
    return True


@inner
def find_neighbours(rows: RowTable, listed: Offsets, gram: SparseGram) -> bool:
    """List for each place the earlier ones with which it shares coordinates; False if there is no room."""
    met, total = gram.degree, 0
    for k in range(gram.number[0]):
        met[k] = -1
    for k in range(gram.number[0]):
        r, gram.gram[k] = gram.row[k], total
        for p in range(rows.start[r], rows.stop[r]):
            node = gram.first[rows.column[p]]
            while node >= 0:
                other = gram.place[listed[gram.node[node]]]
                if other < k and met[other] != k:
                    if total == gram.neighbour.size:
                        return False
                    met[other], gram.neighbour[total] = k, other
                    total += 1
                node = gram.following[node]
    gram.gram[gram.number[0]] = total
    return True
