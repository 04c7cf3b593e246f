"""Neighbour lists: nuclei sorted along the tissue, a window for each eight of them, and near ones that may touch.

The lists hold as long as no nucleus moved by more than SKIN / 2 from where it was listed.
"""

from __future__ import annotations

from tissue.kernels._numba import kernel
from tissue.kernels.lanes import WIDTH, load, lowest_bit, positive_bits
from tissue.kernels.scratch import CLOSE_PAIRS, FAR, LISTS, MOVED, NEAR, STALE, Scratch
from tissue.model.cells import Cells, Floats, Integers

# Longer lists against fewer of them [R_soft].
SKIN = 0.8
# Soft discs of radius 1 repel each other up to here.
RANGE = 2.0
# A nucleus that is farther out is lost, before it comes near the marks at the end of the sorted arrays [R_soft].
LOST = FAR / 2


@kernel
def make_lists(cells: Cells, n: int, scratch: Scratch) -> bool:
    """Sort the nuclei, find windows and near ones; False if one is lost, or has more near ones than room."""
    x, y, radius, order = cells.x, cells.y, cells.radius, scratch.order
    for i in range(n):
        if not abs(x[i]) < LOST:  # nor if it is NaN
            return False
    key, sorted_y, sorted_radius = scratch.key, scratch.sorted_y, scratch.sorted_radius
    _sort(x, n, order)
    widest = 0.0
    for s in range(n):
        i = order[s]
        key[s], sorted_y[s], sorted_radius[s] = x[i], y[i], radius[i]
        scratch.listed_x[i], scratch.listed_y[i] = x[i], y[i]
        scratch.near_count[i] = 0
        widest = max(widest, radius[i])
    for s in range(n, n + WIDTH):  # what fills up the last block is far from everything
        key[s] = scratch.sorted_x[s] = FAR * (1 + s)
        sorted_y[s] = sorted_radius[s] = 0.0
    _windows(key, n, scratch.low, scratch.high)
    scratch.widest[0] = widest
    scratch.flags[STALE] = 0
    scratch.flags[MOVED] = 0
    scratch.counts[LISTS] += 1
    return _list_near(n, widest, scratch)


@kernel
def _sort(x: Floats, n: int, order: Integers) -> None:
    """Insertion sort: linear in n where the order of the last time, or of the tissue, is nearly right."""
    for s in range(1, n):
        moving = order[s]
        key = x[moving]
        k = s
        while k > 0 and x[order[k - 1]] > key:
            order[k] = order[k - 1]
            k -= 1
        order[k] = moving


@kernel
def _windows(key: Floats, n: int, low: Integers, high: Integers) -> None:
    """For each block the sorted nuclei that may come within RANGE of one of its own."""
    left, right = 0, 0
    for block in range((n + WIDTH - 1) // WIDTH):
        first = key[block * WIDTH]
        last = key[min(block * WIDTH + WIDTH, n) - 1]
        while first - key[left] > RANGE + SKIN:
            left += 1
        while right < n and key[right] - last <= RANGE + SKIN:
            right += 1
        low[block] = left
        high[block] = right


@kernel
def _list_near(n: int, widest: float, scratch: Scratch) -> bool:
    """List all pairs with a gap of at most SKIN: each sorted nucleus meets the eight behind it at once."""
    order, key, sorted_y, sorted_radius = scratch.order, scratch.key, scratch.sorted_y, scratch.sorted_radius
    pairs, room = 0, True
    for s in range(n):
        x, y, radius = key[s], sorted_y[s], sorted_radius[s] + SKIN
        begin = s + 1
        while key[begin] - x <= radius + widest:
            dx, dy, reach = load(key, begin) - x, load(sorted_y, begin) - y, load(sorted_radius, begin) + radius
            found = positive_bits(reach * reach - dx * dx - dy * dy)
            while found:
                r = begin + lowest_bit(found)
                found &= found - 1
                pairs += 1
                room = note(scratch.near, scratch.near_count, order[s], order[r]) and room
            begin += WIDTH
    scratch.counts[CLOSE_PAIRS] += pairs
    return room


@kernel
def note(near: Integers, near_count: Integers, i: int, j: int) -> bool:
    """Put the smaller index into the row of the larger, in order and once; False if the row has no room."""
    row, new = max(i, j), min(i, j)
    begin = row * NEAR
    k = begin + near_count[row]
    while k > begin and near[k - 1] >= new:
        k -= 1
    if k < begin + near_count[row] and near[k] == new:
        return True
    if near_count[row] == NEAR:
        return False
    for move in range(begin + near_count[row], k, -1):
        near[move] = near[move - 1]
    near[k] = new
    near_count[row] += 1
    return True


@kernel
def list_again(cells: Cells, i: int, n: int, scratch: Scratch) -> bool:
    """List what is near nucleus i where it is now, without making all lists anew; False if there is no room.

    Pairs are listed by where both were listed, so that half a skin is left to each. Nuclei listed again are not in
    their sorted place: they are looked at one by one. The windows do not know of the move: the lists are stale
    once the sweep is over.
    """
    x, y = cells.x[i], cells.y[i]
    radius, listed_x, listed_y = cells.radius, scratch.listed_x, scratch.listed_y
    listed_x[i], listed_y[i] = x, y
    reach = radius[i] + scratch.widest[0] + SKIN
    room, known = True, False
    moved = scratch.flags[MOVED]
    for k in range(moved):
        known = known or scratch.moved[k] == i
        room = _note_if_near(scratch, radius, i, scratch.moved[k]) and room
    s = _first_not_below(scratch.key, n, x - reach)
    while s < n and scratch.key[s] <= x + reach:
        room = _note_if_near(scratch, radius, i, scratch.order[s]) and room
        s += 1
    if not known:
        scratch.moved[moved] = i
        scratch.flags[MOVED] = moved + 1
    scratch.flags[STALE] = 1
    return room


@kernel
def _note_if_near(scratch: Scratch, radius: Floats, i: int, j: int) -> bool:
    """List the pair if its gap, from where both were listed, is at most SKIN."""
    dx, dy = scratch.listed_x[i] - scratch.listed_x[j], scratch.listed_y[i] - scratch.listed_y[j]
    reach = radius[i] + radius[j] + SKIN
    if i == j or dx * dx + dy * dy > reach * reach:
        return True
    return note(scratch.near, scratch.near_count, i, j)


@kernel
def _first_not_below(key: Floats, n: int, value: float) -> int:
    """The first place whose key is >= value, by bisection."""
    low, high = 0, n
    while low < high:
        middle = (low + high) // 2
        if key[middle] < value:
            low = middle + 1
        else:
            high = middle
    return low
