"""One sweep of projections, as in ``tissue.kernels.sweeps``, for eight replicates at once."""

from __future__ import annotations

from typing import Any

from tissue.kernels._numba import kernel
from tissue.kernels.batch.board import Board
from tissue.kernels.batch.forces import gather, scatter
from tissue.kernels.batch.windows import find_windows
from tissue.kernels.lanes import (
    WIDTH,
    fma,
    load,
    lowest_bit,
    maximum,
    positive_bits,
    spread,
    store,
    twice_rsqrt,
    where_positive,
)
from tissue.kernels.sweeps import push_apart

# Pairs with a larger gap before the sweep are not looked at in it [R_soft].
MARGIN = 0.3


@kernel
def separate(board: Board, n: int) -> None:
    """|X_i - X_j| >= R_i + R_j (C1) for all pairs in the order i, then j < i.

    A replicate in which a nucleus was pushed so far that pairs outside of the windows may have met is swept again from
    the beginning, over all pairs.
    """
    find_windows(board, n, 1.0, 0.5 * MARGIN)
    for place in range(0, WIDTH * n, WIDTH):
        store(board.before_x, place, load(board.x, place))
        store(board.before_y, place, load(board.y, place))
    pushed = _separate_near(board, n)
    again = positive_bits(pushed - 0.25 * MARGIN * MARGIN)
    while again:
        k = lowest_bit(again)
        again &= again - 1
        _separate_all(board, k)


@kernel
def _separate_near(board: Board, n: int) -> Any:
    """Sweep over the windows; the square of the longest way along x that a nucleus was pushed, for each replicate."""
    x, y, radius, before = board.x, board.y, board.radius, board.before_x
    pushed = spread(0.0)
    for i in range(n):
        here = WIDTH * i
        x_i, y_i, radius_i = load(x, here), load(y, here), load(radius, here)
        for j in range(board.low[i], i):
            there = WIDTH * j
            dx, dy, reach = x_i - load(x, there), y_i - load(y, there), radius_i + load(radius, there)
            square = fma(dx, dx, dy * dy)
            overlap = reach * reach - square
            if positive_bits(overlap):
                part = where_positive(overlap, 0.25 * reach * twice_rsqrt(square) - 0.5)
                x_i, y_i = fma(part, dx, x_i), fma(part, dy, y_i)
                x_j = load(x, there) - part * dx
                store(x, there, x_j)
                store(y, there, load(y, there) - part * dy)
                way_i, way_j = x_i - load(before, here), x_j - load(before, there)
                pushed = maximum(pushed, maximum(way_i * way_i, way_j * way_j))
        store(x, here, x_i)
        store(y, here, y_i)
    return pushed


@kernel
def _separate_all(board: Board, k: int) -> None:
    """Sweep over all pairs of replicate k, from where its nuclei were before."""
    x, y, radius = board.x, board.y, board.radius
    end = WIDTH * int(board.cells[k])
    for place in range(k, end, WIDTH):
        x[place], y[place] = board.before_x[place], board.before_y[place]
    for i in range(k, end, WIDTH):
        for j in range(k, i, WIDTH):
            push_apart(x, y, radius, i, j)


@kernel
def order_basal(board: Board, n: int, whole: bool, largest: float) -> None:
    """0 <= b_{k+1} - b_k (C4) for all neighbours from left to right, then b_{k+1} - b_k <= largest (C2) likewise.

    Each sweep is a chain in which one correction waits for the one before: the second follows one neighbour behind the
    first, so that both are under way at once.
    """
    x, size = board.bx, load(board.basal, 0)
    if not whole:
        gather(board.bx, board.basal_at, n, board.layer_x)
        x = board.layer_x
    first, second = load(x, 0), spread(0.0)
    for k in range(n):
        ordered = first
        if k < n - 1:
            ahead = load(x, WIDTH * (k + 1))
            gap = where_positive(size - (k + 1.0), first - ahead)
            half = 0.5 * where_positive(gap, gap)
            ordered, first = first - half, ahead + half
        if k > 0:
            excess = where_positive(size - float(k), ordered - second - largest)
            half = 0.5 * where_positive(excess, excess)
            store(x, WIDTH * (k - 1), second + half)
            ordered = ordered - half
        second = ordered
    store(x, WIDTH * (n - 1), second)
    if not whole:
        scatter(board.layer_x, board.basal_at, n, board.bx)
