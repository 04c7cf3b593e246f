"""Close pairs of discs of any radii, anywhere: a hierarchy of hashed grids, cell sizes doubling from level to level."""

import math

import numpy as np
from numpy.typing import NDArray

from dincl.compiled import allocating, inner, kernel
from dincl.compiled.arrays import Axes, Floats, Indices, Offsets
from dincl.neighbours.grid import GRID_AXES, PAIRS_PER_DISC, grown, is_close, rows_of_pairs, sort_by_cell

Keys = NDArray[np.uint64]

# A radius may exceed that of its level by this factor, so that equal radii share a level, ...
RADIUS_MARGIN = 1.0 + 2.0**-20
# ... and cells exceed twice that radius by more, so that rounding cannot move close discs two cells apart, ...
CELL_MARGIN = 1.0 + 2.0**-12
# ... as long as no disc is so many cells from the origin. Beyond, cell sizes are powers of two and nothing is rounded.
ROUNDED_CELLS = 2.0**38
# More levels than the range of floats can fill.
LEVELS = 2100
# From 2^53 on all floats are integers; numbering them by their bits leaves no room for overflow.
INTEGERS_END = 2.0**53
INTEGERS_END_BITS = 0x4340000000000000
# The key of a cell is the sum of its numbers along the axes, each times one of these (mod 2^64). Keys of neighbouring
# cells differ, since no combination of the factors with weights -2 ... 2 vanishes; cells farther apart may share a
# key, which costs a comparison of their discs and nothing else.
AXIS_FACTORS = np.array([0x9E3779B97F4A7C15, 0xBF58476D1CE4E5B9, 0x94D049BB133111EB], np.uint64)
LEVEL_FACTOR = np.uint64(0xD6E8FEB86659FD93)
HASH_FACTOR = np.uint64(0xFF51AFD7ED558CCD)
HALF_WORD = np.uint64(32)
EMPTY = -1


@inner
def _smallest_cell(x: Floats, smallest: float) -> float:
    """Compute the edge of the cells of level 0."""
    edge, farthest = 2.0 * CELL_MARGIN * smallest, 0.0
    for i in range(x.shape[0]):
        for k in range(x.shape[1]):
            farthest = max(farthest, abs(x[i, k]))
    if farthest < ROUNDED_CELLS * edge:
        return edge
    return math.ldexp(1.0, math.frexp(edge)[1])


@allocating
def _levels_of(radius: Floats, smallest: float) -> tuple[Indices, Offsets]:
    """Find level l of each disc, the least with radius <= 2^l times the smallest, and the levels in use, ascending."""
    level = np.empty(radius.size, np.int32)
    used = np.zeros(LEVELS, np.bool_)
    for i in range(radius.size):
        level[i] = min(max(math.frexp(radius[i] / (smallest * RADIUS_MARGIN))[1], 0), LEVELS - 1)
        used[level[i]] = True
    found, count = np.empty(LEVELS, np.int64), 0
    for number in range(LEVELS):
        if used[number]:
            found[count] = number
            count += 1
    return level, found[:count]


@inner
def _number_of(cells: float) -> int:
    """Return floor(cells); beyond 2^53 another monotone numbering, without overflow or floats that share a number."""
    value = np.floor(cells)
    if abs(value) < INTEGERS_END:
        return int(value)
    beyond = int(np.float64(abs(value)).view(np.int64)) - INTEGERS_END_BITS
    number = int(INTEGERS_END) + beyond
    return number if value > 0.0 else -number


@inner
def _key_of(x: Floats, i: int, edge: float, level: int, axes: Axes) -> np.uint64:
    """Compute the key of the cell that holds X_i in the grid of a level."""
    scale = math.ldexp(1.0, -level)
    key = np.uint64(0)
    for k in range(min(len(axes), GRID_AXES)):
        key += np.uint64(_number_of(x[i, k] / edge * scale)) * AXIS_FACTORS[k]
    return key


@inner
def _slot_of(key: np.uint64, level: int, keys: Keys, levels: Indices) -> np.int64:
    """Find the slot of the open-addressing table with this key and level, or the empty slot where they belong."""
    mixed = key ^ (np.uint64(level) * LEVEL_FACTOR)
    mixed = (mixed ^ (mixed >> HALF_WORD)) * HASH_FACTOR
    slot = np.int64(mixed >> HALF_WORD) & (keys.size - 1)
    while levels[slot] != EMPTY and (keys[slot] != key or levels[slot] != level):
        slot = (slot + 1) & (keys.size - 1)
    return slot


@allocating
def _fill_table(x: Floats, edge: float, level: Indices, axes: Axes) -> tuple[Keys, Indices, Indices]:
    """Enter the cells of all discs; return keys and levels of the table, and the slot of each disc."""
    size = 4
    while size < 2 * x.shape[0]:
        size *= 2
    keys = np.zeros(size, np.uint64)
    levels = np.empty(size, np.int32)
    for k in range(size):
        levels[k] = EMPTY
    slots = np.empty(x.shape[0], np.int32)
    for i in range(x.shape[0]):
        key = _key_of(x, i, edge, level[i], axes)
        slot = _slot_of(key, level[i], keys, levels)
        keys[slot], levels[slot], slots[i] = key, level[i], slot
    return keys, levels, slots


@allocating
def _steps_to_neighbours(axes: Axes) -> Keys:
    """Compute the differences of keys between a cell and all its neighbours and itself, which is in the middle."""
    used = min(len(axes), GRID_AXES)
    steps = np.zeros(3**used, np.uint64)
    for number in range(steps.size):
        digits = number
        for k in range(used):
            steps[number] += np.uint64(digits % 3) * AXIS_FACTORS[k] - AXIS_FACTORS[k]
            digits //= 3
    return steps


@kernel
def hierarchy_pairs(x: Floats, radius: Floats, axes: Axes) -> tuple[Offsets, Indices]:
    """Find close pairs by scanning, for each disc, the grids of its own and of every coarser level.

    Arguments and result as in ``neighbour_pairs``, n >= 1. Cost n times the number of levels, plus the pairs.
    """
    n, smallest = x.shape[0], radius[0]
    for i in range(n):
        smallest = min(smallest, radius[i])
    level, levels_used = _levels_of(radius, smallest)
    edge = _smallest_cell(x, smallest)
    keys, levels, slots = _fill_table(x, edge, level, axes)
    first, disc, x_sorted, radius_sorted = sort_by_cell(slots, keys.size, x, radius, axes)
    steps = _steps_to_neighbours(axes)
    pairs = np.empty((PAIRS_PER_DISC * n, 2), np.int32)
    count = 0
    for p in range(n):
        i = disc[p]
        for scanned in levels_used:
            if scanned < level[i]:
                continue
            key = _key_of(x_sorted, p, edge, scanned, axes)
            # In its own level a disc scans half of the cells around it; the other half scan it.
            for number in range(steps.size // 2 if scanned == level[i] else 0, steps.size):
                slot = _slot_of(key + steps[number], scanned, keys, levels)
                begin, end = first[slot], first[slot + 1]
                if slot == slots[i]:
                    begin = p + 1
                if count + (end - begin) > pairs.shape[0]:
                    pairs = grown(pairs, count, end - begin)
                for q in range(begin, end):
                    pairs[count, 0], pairs[count, 1] = i, disc[q]
                    count += is_close(x_sorted, radius_sorted, p, q, axes)
    return rows_of_pairs(pairs[:count], n)
