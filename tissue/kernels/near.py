"""Which cells may be near each other, found anew for each substep. Neighbours in the tissue are so in the arrays, too.

On a straight layer nuclei are nearly sorted along x: the cells that may be near one make a window of the array. Where
the layer bends they need not be: blocks of a few cells in a row are compared by the boxes around their discs. Windows
save a sixth of the time of a substep there, and boxes all but a few pairs here.
"""

from __future__ import annotations

from typing import Any

from dincl.compiled import inner
from tissue.kernels.lanes import WIDTH, load, maximum, positive_bits, spread, store
from tissue.kernels.workspace import Workspace
from tissue.state.cells import Floats

# Cells in a block: smaller ones are compared more often, larger ones are near each other more often.
BLOCK = 4


@inner
def list_before(work: Workspace, i: int) -> int:
    """Find the cells before cell i near it, with boxes: how many ranges begin[k] to end[k] hold them and others.

    To be asked for in the order of the cells, behind ``find_boxes`` of blocks of BLOCK cells.
    """
    if i % BLOCK == 0:
        work.ranges[0] = _list(work, i // BLOCK, i // BLOCK + 1, BLOCK)
    ranges: int = work.ranges[0]
    return ranges


@inner
def find_near_rows(work: Workspace, n: int, extra: float) -> None:
    """Prepare ``list_around`` for discs of this radius: it misses no pair that overlaps."""
    first, last, entries = work.first, work.last, n
    if work.bent:
        find_boxes(work, n, WIDTH, 0.0, extra)
        entries = (n + WIDTH - 1) // WIDTH
    else:
        ahead, j = spread(work.x, -1e300), 0
        for i in range(n):
            j, ahead = next_window(work, i, j, ahead, 0.0, extra)
            first[i] = j
    # last[p]: behind the last cell or block whose window has p or one before it, at least behind p itself.
    for p in range(entries):
        last[p] = p + 1
        last[first[p]] = p + 1
    for p in range(1, entries):
        last[p] = max(last[p], last[p - 1])


@inner
def list_around(work: Workspace, row: int, n: int) -> int:
    """Find the cells near one of the eight cells of a row: how many ranges hold them."""
    if work.bent:
        return _list(work, row, work.last[row], WIDTH)
    end = min(row * WIDTH + WIDTH, n)
    begin = work.first[row * WIDTH]
    for i in range(row * WIDTH + 1, end):
        begin = min(begin, work.first[i])
    work.begin[0], work.end[0] = begin, work.last[end - 1]
    return 1


@inner
def _list(work: Workspace, p: int, blocks: int, size: int) -> int:
    """List the cells of the blocks that are near block p, as ranges; how many."""
    k = 0
    for q in range(work.first[p], blocks):
        if work.first[q] <= p and are_near(work, p, q):
            if k == 0 or work.end[k - 1] != q * size:
                work.begin[k] = q * size
                k += 1
            work.end[k - 1] = q * size + size
    return k


@inner
def next_window(work: Workspace, i: int, j: int, ahead: Any, share: float, extra: float) -> tuple[int, Any]:
    """Find the first cell j <= i such that, in some tissue, the discs 0 to j reach as far as to disc i.

    Discs have the radii r_i = share R_i + extra. With the rightmost end F_j of the discs 0 to j, a cell j with
    F_j <= x_i - r_i is too far to the left, and all before it: so each pair whose discs overlap is in the windows. One
    cell out of order makes windows longer, never wrong. ``j`` and ``ahead``, F_i, are those of the cell before, 0 and
    -1e300 for the first one.
    """
    x, extent = load(work.x, i), share * load(work.radius, i) + extra
    ahead = maximum(ahead, x + extent)
    store(work.front, i, ahead)
    return _first_beyond(work.front, x - extent, j, i), ahead


@inner
def _first_beyond(front: Floats, left: Any, j: int, most: int) -> int:
    """Return the first place whose ``front`` is beyond ``left`` in some tissue, ``most`` if none before is; from a
    guess j.
    """
    while j > 0 and positive_bits(load(front, j - 1) - left):
        j -= 1
    while j < most and not positive_bits(load(front, j) - left):
        j += 1
    return j


@inner
def find_boxes(work: Workspace, n: int, size: int, share: float, extra: float) -> None:
    """Boxes around the discs of each block of ``size`` cells, of the radii share R_i + extra.

    first[p] is a block before which, in all tissues, no disc reaches as far to the right as a disc of block p begins:
    of a ring this saves half of the comparisons, of an open arc most.
    """
    ahead, q = spread(work.x, -1e300), 0
    for p in range((n + size - 1) // size):
        # Ends on the left and below have the other sign.
        right, left = spread(work.x, -1e300), spread(work.x, -1e300)
        top, bottom = right, right
        for i in range(p * size, min(p * size + size, n)):
            x, y, extent = load(work.x, i), load(work.y, i), share * load(work.radius, i) + extra
            right, left = maximum(x + extent, right), maximum(extent - x, left)
            top, bottom = maximum(y + extent, top), maximum(extent - y, bottom)
        store(work.right, p, right)
        store(work.left, p, left)
        store(work.top, p, top)
        store(work.bottom, p, bottom)
        ahead = maximum(ahead, right)
        store(work.front, p, ahead)
        q = _first_beyond(work.front, 0.0 - left, q, p)
        work.first[p] = q


@inner
def are_near(work: Workspace, p: int, q: int) -> int:
    """Return whether the boxes of two blocks overlap in some tissue: not 0."""
    along_x = maximum(0.0 - load(work.left, p) - load(work.right, q), 0.0 - load(work.left, q) - load(work.right, p))
    along_y = maximum(0.0 - load(work.bottom, p) - load(work.top, q), 0.0 - load(work.bottom, q) - load(work.top, p))
    near: int = positive_bits(0.0 - maximum(along_x, along_y))
    return near
