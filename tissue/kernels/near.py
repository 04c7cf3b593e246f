"""Which cells may be near each other, found anew for each substep. Neighbours in the tissue are so in the arrays, too.

On a straight layer nuclei are nearly sorted along x: the cells that may be near one make a window of the array. Where
the layer bends they need not be: blocks of a few cells in a row are compared by the boxes around their discs.
"""

from __future__ import annotations

from typing import Any

from dincl.compiled import inner
from dincl.compiled.lanes import WIDTH, load, maximum, positive_bits, spread, store
from tissue.kernels.workspace import Workspace
from tissue.state.cells import Floats

# Cells in a block: smaller ones are compared more often, larger ones are near each other more often.
BLOCK = 4


@inner
def find_near(work: Workspace, n: int, share: float, extra: float) -> bool:
    """Prepare ``list_ranges`` for discs of the radii r_i = share R_i + extra: it misses no pair that overlaps.

    Returns
    -------
    bool
        Whether there are boxes, and ``list_before`` is to be asked; else there is one range, from first[i] to i.
    """
    boxes = work.bent > 0
    if boxes:
        find_boxes(work, n, BLOCK, share, extra)
    else:
        find_windows(work, n, share, extra)
    return boxes


@inner
def list_before(work: Workspace, i: int) -> int:
    """Find the cells before cell i near it, with boxes: how many ranges begin[k] to end[k] hold them and others.

    To be asked for in the order of the cells.
    """
    if i % BLOCK == 0:
        work.ranges[0] = _list(work, i // BLOCK, i // BLOCK + 1, BLOCK)
    ranges: int = work.ranges[0]
    return ranges


@inner
def list_ranges(work: Workspace, i: int, boxes: bool) -> int:
    """Find the cells near cell i, with boxes or without, where speed does not matter: how many ranges hold them."""
    if boxes:
        return list_before(work, i)
    work.begin[0], work.end[0] = work.first[i], i
    return 1


@inner
def find_near_rows(work: Workspace, n: int, share: float, extra: float) -> bool:
    """Prepare ``list_around`` or ``window_around`` likewise; whether there are boxes."""
    boxes = work.bent > 0
    if boxes:
        find_boxes(work, n, WIDTH, share, extra)
        _find_ends(work, (n + WIDTH - 1) // WIDTH)
    else:
        find_windows(work, n, share, extra)
    return boxes


@inner
def list_around(work: Workspace, row: int) -> int:
    """Find the cells near one of the eight cells of a row, with boxes: the number of their ranges."""
    return _list(work, row, work.last[row], WIDTH)


@inner
def window_around(work: Workspace, row: int, n: int, end: int) -> tuple[int, int]:
    """Find the cells near one of the eight cells of a row, without boxes: their one range.

    ``end`` is the end of the range of the row before, 0 for the first one.
    """
    begin = work.first[row * WIDTH]
    for i in range(row * WIDTH, min(row * WIDTH + WIDTH, n)):
        begin, end = min(begin, work.first[i]), max(end, work.last[i])
    return begin, end


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
def find_windows(work: Workspace, n: int, share: float, extra: float) -> None:
    """Find first[i] by ``next_window``, and last[i]: the end of the last window that begins with cell i."""
    ahead, j = spread(work.x, -1e300), 0
    for i in range(n):
        j, ahead = next_window(work, i, j, ahead, share, extra)
        work.first[i], work.last[i] = j, i + 1
        work.last[j] = i + 1


@inner
def next_window(work: Workspace, i: int, j: int, ahead: Any, share: float, extra: float) -> tuple[int, Any]:
    """Find the first cell j <= i such that, in some tissue, the discs 0 to j reach as far as to disc i.

    With the rightmost end F_j of the discs 0 to j, a cell j with F_j <= x_i - r_i is too far to the left, and all
    before it: so each pair whose discs overlap is in the windows. One cell out of order makes windows longer, never
    wrong. ``j`` and ``ahead``, F_i, are those of the cell before, 0 and -1e300 for the first one.
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
def _find_ends(work: Workspace, n: int) -> None:
    """last[i]: behind the last cell, or block, whose window has i or one before it, at least behind i itself."""
    first, last = work.first, work.last
    for i in range(n):
        last[i] = i + 1
        last[first[i]] = i + 1
    for i in range(1, n):
        last[i] = max(last[i], last[i - 1])


@inner
def find_boxes(work: Workspace, n: int, size: int, share: float, extra: float) -> None:
    """Boxes around the discs of each block of ``size`` cells.

    first[p] is a block before which, in all tissues, no disc reaches as far to the right as a disc of block p begins:
    of a ring this saves half of the comparisons, of an open arc most.
    """
    ahead, q = spread(work.x, -1e300), 0
    for p in range((n + size - 1) // size):
        _surround(work, p, p * size, min(p * size + size, n), share, extra)
        ahead = maximum(ahead, load(work.right, p))
        store(work.front, p, ahead)
        q = _first_beyond(work.front, 0.0 - load(work.left, p), q, p)
        work.first[p] = q


@inner
def _surround(work: Workspace, p: int, begin: int, end: int, share: float, extra: float) -> None:
    """Set the box of block p: its right and upper ends, and its left and lower ends with the other sign."""
    right, left = spread(work.x, -1e300), spread(work.x, -1e300)
    top, bottom = right, right
    for i in range(begin, end):
        x, y, extent = load(work.x, i), load(work.y, i), share * load(work.radius, i) + extra
        right, left = maximum(x + extent, right), maximum(extent - x, left)
        top, bottom = maximum(y + extent, top), maximum(extent - y, bottom)
    store(work.right, p, right)
    store(work.left, p, left)
    store(work.top, p, top)
    store(work.bottom, p, bottom)


@inner
def are_near(work: Workspace, p: int, q: int) -> int:
    """Return whether the boxes of two blocks overlap in some tissue: not 0."""
    along_x = maximum(0.0 - load(work.left, p) - load(work.right, q), 0.0 - load(work.left, q) - load(work.right, p))
    along_y = maximum(0.0 - load(work.bottom, p) - load(work.top, q), 0.0 - load(work.bottom, q) - load(work.top, p))
    near: int = positive_bits(0.0 - maximum(along_x, along_y))
    return near
