"""The displacement of a substep by the forces, as in ``tissue.kernels.forces``, for eight replicates at once."""

from __future__ import annotations

from tissue.kernels import kernel
from tissue.kernels.batch.board import Board
from tissue.kernels.batch.windows import find_windows
from tissue.kernels.forces import pulls
from tissue.kernels.lanes import WIDTH, either, fma, load, maximum, spread, store, twice_rsqrt, where_positive


@kernel
def repulsion(board: Board, n: int) -> int:
    """Push of the soft discs on each nucleus, the sum of (2 / d - 1) (X_i - X_j); how many pairs were looked at.

    Each pair is looked at once, without a branch: one that is beyond the range in a replicate adds exact zeros there.
    """
    x, y, push_x, push_y = board.x, board.y, board.push_x, board.push_y
    find_windows(board, n, 0.0, 1.0)
    pairs = 0
    for i in range(n):
        here = WIDTH * i
        x_i, y_i = load(x, here), load(y, here)
        sum_x, sum_y = spread(0.0), spread(0.0)
        for j in range(board.low[i], i):
            there = WIDTH * j
            dx, dy = load(x, there) - x_i, load(y, there) - y_i
            weight = twice_rsqrt(fma(dx, dx, dy * dy)) - 1.0
            weight = where_positive(weight, weight)
            sum_x, sum_y = fma(weight, dx, sum_x), fma(weight, dy, sum_y)
            store(push_x, there, fma(weight, dx, load(push_x, there)))
            store(push_y, there, fma(weight, dy, load(push_y, there)))
        store(push_x, here, 0.0 - sum_x)
        store(push_y, here, 0.0 - sum_y)
        pairs += i - board.low[i]
    return pairs


@kernel
def junctions(board: Board, n: int) -> None:
    """Displacement of the apical points by their junctions, pulls k (d - eta), for neighbours in the layer.

    Forwards the pull of each junction is kept at its right end; backwards each point gets what its two junctions do.
    """
    inside_before = spread(0.0)
    x_before, y_before, rest_before, k_before = spread(0.0), spread(0.0), spread(0.0), spread(0.0)
    for here in range(0, WIDTH * n, WIDTH):
        inside, x, y = load(board.in_apical, here), load(board.ax, here), load(board.ay, here)
        dx, dy = x - x_before, y - y_before
        k = load(board.k_aa, here)
        strength = k_before + k
        pull = strength - 0.5 * strength * rest_before * twice_rsqrt(fma(dx, dx, dy * dy))
        pull = where_positive(inside * inside_before, pull)
        store(board.drag_x, here, pull * dx)
        store(board.drag_y, here, pull * dy)
        x_before, y_before = either(inside, x, x_before), either(inside, y, y_before)
        rest_before, k_before = either(inside, load(board.rest, here), rest_before), either(inside, k, k_before)
        inside_before = maximum(inside, inside_before)
    ahead_x, ahead_y = spread(0.0), spread(0.0)
    for here in range(WIDTH * (n - 1), -WIDTH, -WIDTH):
        inside, behind_x, behind_y = load(board.in_apical, here), load(board.drag_x, here), load(board.drag_y, here)
        store(board.drag_x, here, where_positive(inside, ahead_x - behind_x))
        store(board.drag_y, here, where_positive(inside, ahead_y - behind_y))
        ahead_x, ahead_y = either(inside, behind_x, ahead_x), either(inside, behind_y, ahead_y)


@kernel
def move(board: Board, n: int, strength: float) -> None:
    """Move the points of each cell by its springs, its bending energy, its junctions and the pushes of soft discs."""
    for place in range(0, WIDTH * n, WIDTH):
        x, y = load(board.x, place), load(board.y, place)
        ax, ay = load(board.ax, place), load(board.ay, place)
        bx, by = load(board.bx, place), load(board.by, place)
        of_ax = load(board.k_ax, place), load(board.l_ax, place)
        of_bx = load(board.k_bx, place), load(board.l_bx, place)
        a, b, ahead = pulls((ax - x, ay - y), (bx - x, by - y), of_ax, of_bx, load(board.k_axb, place))
        runs = load(board.runs, place)
        store(board.x, place, fma(strength, load(board.push_x, place), x - (a[0] + b[0])))
        store(board.y, place, fma(strength, load(board.push_y, place), y - (a[1] + b[1])))
        store(board.ax, place, ax + a[0] + load(board.drag_x, place))
        store(board.ay, place, ay + a[1] + load(board.drag_y, place))
        store(board.bx, place, fma(runs, ahead[0], fma(load(board.bx_moves, place), b[0], bx)))
        store(board.by, place, fma(runs, ahead[1], fma(load(board.by_moves, place), b[1], by)))
