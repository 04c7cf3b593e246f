"""The displacement of a substep by the forces, as in ``tissue.kernels.forces``, for eight replicates at once."""

from __future__ import annotations

from tissue.cells import Floats, Integers
from tissue.kernels._numba import kernel
from tissue.kernels.batch.board import Board
from tissue.kernels.batch.windows import find_windows
from tissue.kernels.forces import pulls
from tissue.kernels.lanes import WIDTH, fma, load, spread, store, twice_rsqrt, where_positive


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
def junctions(board: Board, n: int, whole: bool, strength: float) -> None:
    """Displacement of the apical points by their junctions, pulls k (d - eta); ``whole``: all are in the layer."""
    x, y, moved_x, moved_y = board.ax, board.ay, board.drag_x, board.drag_y
    if not whole:
        gather(board.ax, board.apical_at, n, board.layer_x)
        gather(board.ay, board.apical_at, n, board.layer_y)
        x, y, moved_x, moved_y = board.layer_x, board.layer_y, board.layer_x, board.layer_y
    half, size = 0.5 * strength, load(board.apical, 0)
    x_k, y_k = load(x, 0), load(y, 0)
    behind_x, behind_y = spread(0.0), spread(0.0)
    for k in range(n - 1):
        here, next_x, next_y = WIDTH * k, load(x, WIDTH * (k + 1)), load(y, WIDTH * (k + 1))
        dx, dy = next_x - x_k, next_y - y_k
        pull = strength - half * load(board.rest, here) * twice_rsqrt(fma(dx, dx, dy * dy))
        pull = where_positive(size - (k + 1.0), pull)
        store(moved_x, here, pull * dx - behind_x)
        store(moved_y, here, pull * dy - behind_y)
        x_k, y_k, behind_x, behind_y = next_x, next_y, pull * dx, pull * dy
    store(moved_x, WIDTH * (n - 1), 0.0 - behind_x)
    store(moved_y, WIDTH * (n - 1), 0.0 - behind_y)
    if not whole:
        scatter(board.layer_x, board.apical_at, n, board.drag_x)
        scatter(board.layer_y, board.apical_at, n, board.drag_y)


@kernel
def move(board: Board, n: int, strength: float) -> None:
    """Move the points of each cell by its springs, its bending energy, its junctions and the pushes of soft discs."""
    for place in range(0, WIDTH * n, WIDTH):
        x, y = load(board.x, place), load(board.y, place)
        ax, ay = load(board.ax, place), load(board.ay, place)
        bx, by = load(board.bx, place), load(board.by, place)
        of_ax = load(board.k_ax, place), load(board.l_ax, place)
        of_bx = load(board.k_bx, place), load(board.l_bx, place)
        a, b = pulls((ax - x, ay - y), (bx - x, by - y), of_ax, of_bx, load(board.k_axb, place))
        store(board.x, place, fma(strength, load(board.push_x, place), x - (a[0] + b[0])))
        store(board.y, place, fma(strength, load(board.push_y, place), y - (a[1] + b[1])))
        store(board.ax, place, ax + a[0] + load(board.drag_x, place))
        store(board.ay, place, ay + a[1] + load(board.drag_y, place))
        store(board.bx, place, bx + b[0])
        store(board.by, place, fma(load(board.by_moves, place), b[1], by))


@kernel
def gather(values: Floats, at: Integers, n: int, layer: Floats) -> None:
    """The values of a layer in its order."""
    for place in range(WIDTH * n):
        layer[place] = values[at[place]]


@kernel
def scatter(layer: Floats, at: Integers, n: int, values: Floats) -> None:
    """Put the values of a layer back to its cells."""
    for place in range(WIDTH * n):
        values[at[place]] = layer[place]
