"""Pairs of discs that are close to each other: all (i, j) with |X_i - X_j| <= r_i + r_j for search radii r.

Few discs are compared with all others. Many are sorted into one grid of cells of the size of the largest disc. It is
folded: cell c of an axis is c modulo the number of cells kept for the axis, so that discs may lie anywhere and memory
is linear in their number. Discs of cells that coincide are compared for nothing.
"""

from typing import NamedTuple

import numpy as np

from dincl.compiled import allocating, kernel
from dincl.compiled.arrays import Axes, Floats, Indices, Offsets, axes_of
from dincl.errors import StepFailure
from dincl.neighbours import ALL_PAIRS
from dincl.rows.base import nearest_image
from dincl.status import Status

# The grid spans at most so many axes; distances always use all of them.
GRID_AXES = 3
# Cells for each disc at most; at least 4 along each axis, so that a cell and its neighbours are different ones.
CELLS_PER_DISC, FEWEST_CELLS = 8, 4
# Cells exceed twice the largest radius by this factor, so that rounding cannot move close discs two cells apart, ...
CELL_MARGIN = 1.0 + 2.0**-12
# ... as long as no disc is so many cells from the origin. Beyond, cell sizes are powers of two and nothing is rounded.
ROUNDED_CELLS = 2.0**38
# Capacity of a list of pairs at the start, per disc.
PAIRS_PER_DISC = 4
# A longer list would take more than a gigabyte: discs lie on top of each other, not side by side.
MOST_PAIRS = 50_000_000

Pairs = tuple[Offsets, Offsets]


class TooManyPairs(Exception):
    """More than MOST_PAIRS candidates."""


def neighbour_pairs(x: Floats, radius: Floats, box: Floats | None = None) -> Pairs:
    """List all pairs i > j with |X_i - X_j| <= r_i + r_j: arrays i and j, i ascending, then j.

    The cost is linear in n plus the number of pairs for discs of similar radii, however far apart they are.

    Parameters
    ----------
    x : (n, d), C-contiguous
        Centres [length], any d >= 1. A disc whose centre is not a number has no neighbours.
    radius : (n,)
        Search radii r [length]; between 1e-150 and 1e150 so that squares neither vanish nor overflow.
    box : (d,)
        Periods of the axes, 0 for one that does not repeat, of discs that are near by their nearest images.

    Raises
    ------
    StepFailure
        CROWDED when there are more than MOST_PAIRS candidates.

    Notes
    -----
    Collision detection in linear time: thesis, Remark 2.6.
    """
    if box is not None:
        return periodic_pairs(x, radius, box)
    if x.shape[0] <= ALL_PAIRS:
        return compared_pairs(x, radius)
    try:
        i, j = grid_pairs(x, radius, axes_of(x))
        return i.astype(np.int64), j.astype(np.int64)
    except TooManyPairs:
        detail = f"More than {MOST_PAIRS:,} pairs of particles are close to each other."
        raise StepFailure(Status.CROWDED, detail) from None


def periodic_pairs(x: Floats, radius: Floats, box: Floats) -> Pairs:
    """List the same pairs as ``neighbour_pairs``, of the nearest images, by SciPy's tree of boxes."""
    from scipy.spatial import KDTree

    lengths = np.where(box > 0, box, np.inf)
    wrapped = np.where(box > 0, x - box * np.floor(x / lengths), x)
    wrapped = np.where((box > 0) & (wrapped >= lengths), 0.0, wrapped)  # -1e-20 rounds to a whole period
    largest = 2.0 * float(radius.max(initial=0.0))
    finite = np.asarray(np.isfinite(wrapped).all(axis=1))
    wrapped[~finite] = 0.0
    pairs = KDTree(wrapped, boxsize=box).query_pairs(largest * CELL_MARGIN, output_type="ndarray")
    arrows = nearest_image(x[pairs[:, 0]] - x[pairs[:, 1]], box)
    close = ((arrows**2).sum(axis=1) <= radius[pairs].sum(axis=1) ** 2) & finite[pairs].all(axis=1)
    i, j = pairs[close].max(axis=1), pairs[close].min(axis=1)
    order = np.lexsort((j, i))
    return i[order], j[order]


def compared_pairs(x: Floats, radius: Floats) -> Pairs:
    """List the same pairs as ``neighbour_pairs`` by comparing all n (n - 1) / 2 of them, in NumPy: nothing compiles."""
    square, limit = np.zeros((len(x), len(x))), radius[:, None] + radius
    for column in x.T:
        square += (column[:, None] - column) ** 2
    i, j = np.tril(square <= limit * limit, -1).nonzero()
    return i, j


class Grid(NamedTuple):
    """Discs in the order of their cells, so that those of one cell lie side by side."""

    bits: Offsets  # (3,): 2^bits cells along each axis; unused axes have one
    first: Indices  # (cells + 1,): cell c holds the places first[c] ... first[c + 1] - 1
    cell: Indices  # (n,): the cell of each place, the last axis running fastest
    disc: Indices  # (n,): the disc at each place, ascending in each cell
    x: Floats  # (n, d)
    radius: Floats  # (n,)


@allocating
def sort_into_grid(x: Floats, radius: Floats, axes: Axes) -> Grid:
    """Sort n >= 1 discs into the cells of a grid."""
    n, used, largest, farthest = x.shape[0], min(len(axes), GRID_AXES), 0.0, 0.0
    for i in range(n):
        largest = max(largest, radius[i])
        for k in range(used):
            if abs(x[i, k]) < np.inf:  # false also where it is not a number
                farthest = max(farthest, abs(x[i, k]))
    edge = 2.0 * CELL_MARGIN * largest
    if not farthest < ROUNDED_CELLS * edge:
        edge = 2.0 ** np.ceil(np.log2(edge))
    bits, per_length = cells_along(x, edge, axes), 1.0 / edge
    cell, cells = np.zeros(n, np.int32), 1 << (bits[0] + bits[1] + bits[2])
    for k in range(used):
        count = 2.0 ** bits[k]
        per_count = 1.0 / count
        for i in range(n):
            number = np.floor(x[i, k] * per_length)
            number -= count * np.floor(number * per_count)
            cell[i] = (cell[i] << bits[k]) + (int(number) if 0.0 <= number < count else 0)
    # A counting sort.
    first = np.zeros(cells + 2, np.int32)
    for i in range(n):
        first[cell[i] + 2] += 1
    for c in range(2, cells + 2):
        first[c] += first[c - 1]
    grid = Grid(bits, first[: cells + 1], np.empty_like(cell), np.empty_like(cell), np.empty_like(x), np.empty(n))
    for i in range(n):
        place = first[cell[i] + 1]
        first[cell[i] + 1] = place + 1
        grid.disc[place], grid.cell[place], grid.radius[place] = i, cell[i], radius[i]
        for k in range(len(axes)):
            grid.x[place, k] = x[i, k]
    return grid


@allocating
def cells_along(x: Floats, edge: float, axes: Axes) -> Offsets:
    """Choose the number of cells along each axis, 2^bits: those of the bounding box, or as many as have room."""
    bits, extent, total = np.zeros(GRID_AXES, np.int64), np.zeros(GRID_AXES), 0
    for k in range(min(len(axes), GRID_AXES)):
        lowest, highest = np.inf, -np.inf
        for i in range(x.shape[0]):
            lowest, highest = min(lowest, x[i, k]), max(highest, x[i, k])
        extent[k] = highest - lowest
        while 2.0 ** bits[k] < FEWEST_CELLS or (bits[k] < 30 and 2.0 ** bits[k] * edge < extent[k] + 2.0 * edge):
            bits[k] += 1
        total += bits[k]
    while 2.0**total > CELLS_PER_DISC * x.shape[0] and bits.max() > 2:
        bits[bits.argmax()] -= 1
        total -= 1
    return bits


@kernel
def grid_pairs(x: Floats, radius: Floats, axes: Axes) -> tuple[Indices, Indices]:
    """Find close pairs of n >= 1 discs in the grid; result as of ``neighbour_pairs``."""
    n, used = x.shape[0], min(len(axes), GRID_AXES)
    grid = sort_into_grid(x, radius, axes)
    first, disc, bits, lines = grid.first, grid.disc, grid.bits, lines_ahead(axes)
    count, last = 0, (1 << grid.bits[used - 1]) - 1
    one, other = np.empty(PAIRS_PER_DISC * n, np.int32), np.empty(PAIRS_PER_DISC * n, np.int32)
    for p in range(n):
        here = np.int64(grid.cell[p])
        number = here & last
        for s in range(lines.shape[0]):
            line, shift = np.int64(0), bits[used - 1]
            for k in range(used - 2, -1, -1):
                line += (((here >> shift) + lines[s, k]) & ((1 << bits[k]) - 1)) << shift
                shift += bits[k]
            # Three cells of a line, of which one may be at its other end; in its own line a disc follows the others.
            begin, end = p + 1 if s == 0 else first[line + max(number - 1, 0)], first[line + min(number + 1, last) + 1]
            beyond = 0 if number == last else last
            more = number == last or (number == 0 and s > 0)
            for part in range(2 if more else 1):
                if part > 0:
                    begin, end = first[line + beyond], first[line + beyond + 1]
                room = count + end - begin
                if room > one.size:
                    one, other = grown(one, count, room), grown(other, count, room)
                for q in range(begin, end):
                    # Every candidate is written and only a close one is counted, as above.
                    one[count], other[count] = max(disc[p], disc[q]), min(disc[p], disc[q])
                    square, limit = 0.0, grid.radius[p] + grid.radius[q]
                    for k in range(len(axes)):
                        arrow = grid.x[p, k] - grid.x[q, k]
                        square += arrow * arrow
                    count += square <= limit * limit
    other, one = sort_by(other[:count], one[:count], n)
    return sort_by(one, other, n)


@allocating
def lines_ahead(axes: Axes) -> Offsets:
    """Return the steps from a line of cells along the last axis to itself, first, and to half of the lines around."""
    others = min(len(axes), GRID_AXES) - 1
    steps = np.zeros((3**others // 2 + 1, max(others, 1)), np.int64)
    for s in range(steps.shape[0]):
        digits = 3**others // 2 + s
        for k in range(others - 1, -1, -1):
            steps[s, k] = digits % 3 - 1
            digits //= 3
    return steps


@allocating
def grown(numbers: Indices, count: int, room: int) -> Indices:
    """Copy numbers[:count] into an array of twice this room; TooManyPairs if that is too long."""
    if room > MOST_PAIRS:
        raise TooManyPairs
    copied = np.empty(2 * room, np.int32)
    copied[:count] = numbers[:count]
    return copied


@allocating
def sort_by(key: Indices, value: Indices, n: int) -> tuple[Indices, Indices]:
    """Sort keys, each in 0 .. n - 1, with their values, which keep their order: a counting sort."""
    place, keys, values = np.zeros(n + 1, np.int64), np.empty_like(key), np.empty_like(value)
    for p in range(key.size):
        place[key[p] + 1] += 1
    for i in range(n):
        place[i + 1] += place[i]
    for p in range(key.size):
        q = place[key[p]]
        keys[q], values[q] = key[p], value[p]
        place[key[p]] = q + 1
    return keys, values
