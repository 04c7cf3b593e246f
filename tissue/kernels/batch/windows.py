"""Which cells may be near a cell, found anew for each substep: nuclei are nearly sorted along the tissue."""

from __future__ import annotations

from tissue.kernels import kernel
from tissue.kernels.batch.board import Board
from tissue.kernels.lanes import WIDTH, load, maximum, positive_bits, spread, store


@kernel
def find_windows(board: Board, n: int, share: float, extra: float) -> None:
    """low[i]: the first cell j <= i such that, in some replicate, the discs 0 to j reach as far as to disc i.

    The discs have the radii r_i = share R_i + extra. With the rightmost end F_j of the discs 0 to j, a cell j with
    F_j <= x_i - r_i is too far to the left, and all before it: so each pair whose discs overlap is in the windows. One
    cell out of order makes windows longer, never wrong.
    """
    x, radius, front, low = board.x, board.radius, board.front, board.low
    ahead = spread(-1e300)
    j = 0
    for i in range(n):
        here = WIDTH * i
        x_i = load(x, here)
        reach = share * load(radius, here) + extra
        ahead = maximum(ahead, x_i + reach)
        store(front, here, ahead)
        left = x_i - reach
        while j > 0 and positive_bits(load(front, WIDTH * (j - 1)) - left):
            j -= 1
        while j < i and not positive_bits(load(front, WIDTH * j) - left):
            j += 1
        low[i] = j
