"""Which cells may be near each other, found anew for each substep. Neighbours in the tissue are so in the arrays, too.

On a straight layer nuclei are nearly sorted along x: the cells that may be near one make a window of the array. Where
the layer bends they need not be: blocks of a few cells in a row are compared by the boxes around their discs.
"""

from __future__ import annotations

from typing import Any

from dincl.compiled import inner
from dincl.compiled.lanes import WIDTH, load, maximum, positive_bits, spread, store
from tissue.kernels.board import Board
from tissue.state.cells import Floats

# Cells in a block: smaller ones are compared more often, larger ones are near each other more often.
BLOCK = 4


@inner
def find_near(board: Board, n: int, share: float, extra: float) -> None:
    """Prepare ``list_before`` for discs of the radii r_i = share R_i + extra: it misses no pair that overlaps."""
    if board.bent:
        find_boxes(board, n, BLOCK, share, extra)
    else:
        find_windows(board, n, share, extra)


@inner
def list_before(board: Board, i: int) -> int:
    """On a bent layer: how many ranges begin[k] to end[k] have the cells before cell i that may be near it, and others.

    To be asked for in the order of the cells. On a straight layer there is one range, from first[i] to i.
    """
    if i % BLOCK == 0:
        board.ranges[0] = _list(board, i // BLOCK, i // BLOCK + 1, BLOCK)
    ranges: int = board.ranges[0]
    return ranges


@inner
def list_ranges(board: Board, i: int) -> int:
    """The same on any layer, for those who do not count nanoseconds."""
    if board.bent:
        return list_before(board, i)
    board.begin[0], board.end[0] = board.first[i], i
    return 1


@inner
def find_near_rows(board: Board, n: int, share: float, extra: float) -> None:
    """Prepare ``list_around`` or ``window_around`` likewise."""
    if board.bent:
        find_boxes(board, n, WIDTH, share, extra)
    else:
        find_windows(board, n, share, extra)
        _find_ends(board, n)


@inner
def list_around(board: Board, row: int, rows: int) -> int:
    """On a bent layer: how many ranges have the cells that may be near one of the eight cells of a row."""
    return _list(board, row, rows, WIDTH)


@inner
def window_around(board: Board, row: int, n: int) -> tuple[int, int]:
    """On a straight layer: the one range of the cells that may be near one of the eight cells of a row."""
    begin, end = board.first[row * WIDTH], min(row * WIDTH + WIDTH, n)
    for i in range(row * WIDTH + 1, end):
        begin = min(begin, board.first[i])
    return begin, board.last[end - 1]


@inner
def _list(board: Board, p: int, blocks: int, size: int) -> int:
    """List the cells of the blocks that are near block p, as ranges; how many."""
    k = 0
    for q in range(board.first[p], blocks):
        if board.first[q] <= p and are_near(board, p, q):
            if k == 0 or board.end[k - 1] != q * size:
                board.begin[k] = q * size
                k += 1
            board.end[k - 1] = q * size + size
    return k


@inner
def find_windows(board: Board, n: int, share: float, extra: float) -> None:
    """first[i]: the first cell j <= i such that, in some tissue, the discs 0 to j reach as far as to disc i.

    With the rightmost end F_j of the discs 0 to j, a cell j with F_j <= x_i - r_i is too far to the left, and all
    before it: so each pair whose discs overlap is in the windows. One cell out of order makes windows longer, never
    wrong.
    """
    x, radius, front = board.x, board.radius, board.front
    ahead = spread(x, -1e300)
    j = 0
    for i in range(n):
        x_i, reach = load(x, i), share * load(radius, i) + extra
        ahead = maximum(ahead, x_i + reach)
        store(front, i, ahead)
        j = _first_beyond(front, x_i - reach, j, i)
        board.first[i] = j


@inner
def _first_beyond(front: Floats, left: Any, j: int, most: int) -> int:
    """The first place whose ``front`` is beyond ``left`` in some tissue, ``most`` if none before is; from a guess j."""
    while j > 0 and positive_bits(load(front, j - 1) - left):
        j -= 1
    while j < most and not positive_bits(load(front, j) - left):
        j += 1
    return j


@inner
def _find_ends(board: Board, n: int) -> None:
    """last[i]: behind the last cell whose window has cell i or one before it, at least behind cell i itself."""
    first, last = board.first, board.last
    for i in range(n):
        last[i] = i + 1
        last[first[i]] = i + 1
    for i in range(1, n):
        last[i] = max(last[i], last[i - 1])


@inner
def find_boxes(board: Board, n: int, size: int, share: float, extra: float) -> None:
    """Boxes around the discs of each block of ``size`` cells.

    first[p] is a block before which, in all tissues, no disc reaches as far to the right as a disc of block p begins:
    of a ring this saves half of the comparisons, of an open arc most.
    """
    ahead, q = spread(board.x, -1e300), 0
    for p in range((n + size - 1) // size):
        _surround(board, p, p * size, min(p * size + size, n), share, extra)
        ahead = maximum(ahead, load(board.right, p))
        store(board.front, p, ahead)
        q = _first_beyond(board.front, 0.0 - load(board.left, p), q, p)
        board.first[p] = q


@inner
def _surround(board: Board, p: int, begin: int, end: int, share: float, extra: float) -> None:
    """The box of block p: its ends to the right and above, and those to the left and below with the other sign."""
    right, left = spread(board.x, -1e300), spread(board.x, -1e300)
    top, bottom = right, right
    for i in range(begin, end):
        x, y, reach = load(board.x, i), load(board.y, i), share * load(board.radius, i) + extra
        right, left = maximum(x + reach, right), maximum(reach - x, left)
        top, bottom = maximum(y + reach, top), maximum(reach - y, bottom)
    store(board.right, p, right)
    store(board.left, p, left)
    store(board.top, p, top)
    store(board.bottom, p, bottom)


@inner
def are_near(board: Board, p: int, q: int) -> int:
    """Whether the boxes of two blocks overlap in some tissue: not 0."""
    along_x = maximum(
        0.0 - load(board.left, p) - load(board.right, q), 0.0 - load(board.left, q) - load(board.right, p)
    )
    along_y = maximum(
        0.0 - load(board.bottom, p) - load(board.top, q), 0.0 - load(board.bottom, q) - load(board.top, p)
    )
    near: int = positive_bits(0.0 - maximum(along_x, along_y))
    return near
