"""One sweep of projections, as in ``tissue.kernels.sweeps``, for eight replicates at once."""

from __future__ import annotations

from typing import Any

from tissue.kernels import kernel
from tissue.kernels.batch.board import Board
from tissue.kernels.batch.windows import find_windows
from tissue.kernels.lanes import (
    WIDTH,
    either,
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
def order_basal(board: Board, n: int, largest: float) -> None:
    """0 <= b_{k+1} - b_k (C4) for all neighbours from left to right, then b_{k+1} - b_k <= largest (C2) likewise.

    Each sweep is a chain in which one correction waits for the one before: the second follows one neighbour behind the
    first, so that both are under way at once. So at each point of the layer the end of the last but one before it is
    known, and kept there, until it is brought back to its own place from right to left.
    """
    x, inside_at, ends = board.bx, board.in_basal, board.ends
    first, second, one, two = spread(0.0), spread(0.0), spread(0.0), spread(0.0)  # one, two: so many are before
    for here in range(0, WIDTH * n, WIDTH):
        inside, ahead = load(inside_at, here), load(x, here)
        gap = where_positive(inside * one, first - ahead)
        half = 0.5 * where_positive(gap, gap)
        ordered = first - half
        end, behind = _shortened(second, ordered, inside * two, largest)
        store(ends, here, end)
        first, second = either(inside, ahead + half, first), either(inside, behind, second)
        one, two = maximum(inside, one), either(inside, one, two)
    end_before, end = _shortened(second, first, two, largest)
    for here in range(WIDTH * (n - 1), -WIDTH, -WIDTH):
        inside = load(inside_at, here)
        store(x, here, either(inside, end, load(x, here)))
        end, end_before = either(inside, end_before, end), either(inside, load(ends, here), end_before)


@kernel
def _shortened(left: Any, right: Any, joined: Any, largest: float) -> tuple[Any, Any]:
    """Two neighbours after their correction for (C2), where they are joined."""
    excess = where_positive(joined, right - left - largest)
    half = 0.5 * where_positive(excess, excess)
    return left + half, right - half
