"""Which cells may be near a cell, found anew for each substep: nuclei are nearly sorted along the tissue."""

from __future__ import annotations

from dincl.compile import inner
from tissue.kernels.board import Board
from tissue.kernels.lanes import load, maximum, positive_bits, spread, store


@inner
def find_windows(board: Board, n: int, share: float, extra: float) -> int:
    """low[i]: the first cell j <= i such that, in some tissue, the discs 0 to j reach as far as to disc i.

    The discs have the radii r_i = share R_i + extra. With the rightmost end F_j of the discs 0 to j, a cell j with
    F_j <= x_i - r_i is too far to the left, and all before it: so each pair whose discs overlap is in the windows. One
    cell out of order makes windows longer, never wrong. Returns how many pairs are in the windows.
    """
    x, radius, front, low = board.x, board.radius, board.front, board.low
    ahead = spread(x, -1e300)
    j, pairs = 0, 0
    for i in range(n):
        x_i, reach = load(x, i), share * load(radius, i) + extra
        ahead = maximum(ahead, x_i + reach)
        store(front, i, ahead)
        left = x_i - reach
        while j > 0 and positive_bits(load(front, j - 1) - left):
            j -= 1
        while j < i and not positive_bits(load(front, j) - left):
            j += 1
        low[i] = j
        pairs += i - j
    return pairs


@inner
def find_ends(board: Board, n: int) -> None:
    """high[i]: behind the last cell whose window has cell i or one before it, at least behind cell i itself."""
    low, high = board.low, board.high
    for i in range(n):
        high[i] = i + 1
        high[low[i]] = i + 1
    for i in range(1, n):
        high[i] = max(high[i], high[i - 1])
