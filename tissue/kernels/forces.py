"""The displacement of a substep by the forces: explicit Euler, Z - (h / mu) grad W(Z)."""

from __future__ import annotations

from typing import Any

from dincl.compile import inner
from tissue.kernels.board import Board
from tissue.kernels.lanes import (
    WIDTH,
    either,
    fma,
    load,
    load_wide,
    maximum,
    spread,
    store,
    twice_rsqrt,
    where_positive,
)
from tissue.kernels.near import find_near, find_near_rows, list_around, list_before, window_around
from tissue.kernels.ring import at_ends

# Radius of the soft discs, a little more than 1: a pair at the end of the range, of which rounding decides
# whether it repels, is looked at in every company.
SOFT_END = 1.0 + 1e-9

Lane = Any  # a double, or eight
Plane = tuple[Lane, Lane]
Spring = tuple[Lane, Lane]


@inner
def push_in_rows(board: Board, n: int, wide: Board, rows: int) -> None:
    """Push of the soft discs on each nucleus of one tissue, the sum of (2 / d - 1) (X_i - X_j) over j.

    Eight nuclei in a row meet all that are near one of them, one after the other. Without strength no pair is looked
    at.
    """
    push, pairs = (spread(wide.x, 0.0), spread(wide.x, 0.0)), 0
    if board.repulsion != 0.0:
        find_near_rows(board, n, 0.0, SOFT_END)
    for row in range(rows):
        total = push
        if board.repulsion == 0.0:
            pass
        elif board.bent:
            for k in range(list_around(board, row, rows)):
                total = _push_row(board, wide, row, board.begin[k], min(board.end[k], n), total)
                pairs += WIDTH * (min(board.end[k], n) - board.begin[k])
        else:
            begin, end = window_around(board, row, n)
            total = _push_row(board, wide, row, begin, end, total)
            pairs += WIDTH * (end - begin)
        store(wide.push_x, row, total[0])
        store(wide.push_y, row, total[1])
    board.pairs[0] += pairs // 2  # each twice


@inner
def _push_row(board: Board, wide: Board, row: int, begin: int, end: int, push: Plane) -> Plane:
    """Add what cells ``begin`` to ``end`` do to a row, without a branch.

    One that is beyond the range adds exact zeros, as a nucleus does to itself.
    """
    x_i, y_i, (push_x, push_y) = load(wide.x, row), load(wide.y, row), push
    for j in range(begin, end):
        dx, dy = x_i - load_wide(board.x, j), y_i - load_wide(board.y, j)
        square = fma(dx, dx, dy * dy)
        weight = where_positive(square, repelling(square))
        push_x, push_y = fma(weight, dx, push_x), fma(weight, dy, push_y)
    return push_x, push_y


@inner
def push_in_pairs(board: Board, n: int) -> None:
    """The same in eight tissues, where each pair is looked at once. The sums are added up in the same order."""
    none, pairs = spread(board.x, 0.0), 0
    if board.repulsion != 0.0:
        find_near(board, n, 0.0, SOFT_END)
    for i in range(n):
        sum_x, sum_y = none, none
        if board.repulsion == 0.0:
            pass
        elif board.bent:
            for k in range(list_before(board, i)):
                sum_x, sum_y = _push_pairs(board, i, board.begin[k], min(board.end[k], i), (sum_x, sum_y))
                pairs += max(0, min(board.end[k], i) - board.begin[k])
        else:
            sum_x, sum_y = _push_pairs(board, i, board.first[i], i, (sum_x, sum_y))
            pairs += i - board.first[i]
        store(board.push_x, i, 0.0 - sum_x)
        store(board.push_y, i, 0.0 - sum_y)
    board.pairs[0] += pairs


@inner
def _push_pairs(board: Board, i: int, begin: int, end: int, push: Plane) -> Plane:
    """Add what nucleus i does to those from ``begin`` to ``end``, and collect what they do to it, with other sign."""
    push_x, push_y, x_i, y_i = board.push_x, board.push_y, load(board.x, i), load(board.y, i)
    sum_x, sum_y = push
    for j in range(begin, end):
        dx, dy = load(board.x, j) - x_i, load(board.y, j) - y_i
        weight = repelling(fma(dx, dx, dy * dy))
        sum_x, sum_y = fma(weight, dx, sum_x), fma(weight, dy, sum_y)
        store(push_x, j, fma(weight, dx, load(push_x, j)))
        store(push_y, j, fma(weight, dy, load(push_y, j)))
    return sum_x, sum_y


@inner
def repelling(square: Lane) -> Lane:
    """2 / d - 1 where two soft discs overlap, else 0, from d^2."""
    return maximum(twice_rsqrt(square) - 1.0, 0.0)


@inner
def junctions(board: Board, n: int, wide: Board, rows: int) -> None:
    """Displacement of the apical points by their junctions, pulls k (d - eta), for neighbours in the layer.

    Each cell of the layer finds the one before it, then how their junction pulls it, then what the next one does. In a
    ring the last one is before the first.
    """
    inside_at, ax, ay, drag_x, drag_y = board.in_apical, board.ax, board.ay, board.drag_x, board.drag_y
    x, y = spread(ax, 0.0), spread(ax, 0.0)
    if board.curve.ring > 0.0:
        x, y = at_ends(inside_at, ax, n)[1], at_ends(inside_at, ay, n)[1]
    for i in range(n):
        inside = load(inside_at, i)
        store(drag_x, i, x)
        store(drag_y, i, y)
        x, y = either(inside, load(ax, i), x), either(inside, load(ay, i), y)
    for i in range(rows):
        dx, dy, k = load(wide.ax, i) - load(wide.drag_x, i), load(wide.ay, i) - load(wide.drag_y, i), load(wide.k_aa, i)
        pull = k - 0.5 * k * load(wide.rest, i) * twice_rsqrt(fma(dx, dx, dy * dy))
        pull = where_positive(load(wide.joined, i), pull)
        store(wide.drag_x, i, pull * dx)
        store(wide.drag_y, i, pull * dy)
    x, y = spread(ax, 0.0), spread(ax, 0.0)
    if board.curve.ring > 0.0:
        x, y = at_ends(inside_at, drag_x, n)[0], at_ends(inside_at, drag_y, n)[0]
    for i in range(n - 1, -1, -1):
        inside, back_x, back_y = load(inside_at, i), load(drag_x, i), load(drag_y, i)
        store(drag_x, i, where_positive(inside, x - back_x))
        store(drag_y, i, where_positive(inside, y - back_y))
        x, y = either(inside, back_x, x), either(inside, back_y, y)


@inner
def pulls(u: Plane, v: Plane, ax: Spring, bx: Spring, bending: Lane) -> tuple[Plane, Plane, Plane]:
    """Displacements of A and of B by the springs and the bending energy of a cell; that of X is minus their sum.

    Third is v / |v|, the direction of a basal point that moves by itself (4.1).

    With u = A - X, v = B - X, c the cosine between them, and W = alpha (c + 1):
    -dW/dA = alpha (c u / |u|^2 - v / (|u| |v|)), likewise for B. A spring is (k, l), see ``Board``.
    """
    (ux, uy), (vx, vy) = u, v
    by_u, by_v = 0.5 * twice_rsqrt(fma(ux, ux, uy * uy)), 0.5 * twice_rsqrt(fma(vx, vx, vy * vy))
    bend = bending * by_u * by_v
    turn = bend * fma(ux, vx, uy * vy)
    along_u = fma(ax[0], fma(ax[1], by_u, -1.0), turn * by_u * by_u)
    along_v = fma(bx[0], fma(bx[1], by_v, -1.0), turn * by_v * by_v)
    back = 0.0 - bend
    a = fma(along_u, ux, back * vx), fma(along_u, uy, back * vy)
    b = fma(along_v, vx, back * ux), fma(along_v, vy, back * uy)
    return a, b, (by_v * vx, by_v * vy)


@inner
def move(board: Board, rows: int) -> None:
    """Move the points of each cell by its springs, its bending energy, its junctions and the pushes of soft discs.

    Where the layer bends, it moves a basal point that it holds by the part of its force that is along the curve.
    """
    strength = board.repulsion
    for i in range(rows):
        x, y = load(board.x, i), load(board.y, i)
        ax, ay = load(board.ax, i), load(board.ay, i)
        bx, by = load(board.bx, i), load(board.by, i)
        of_ax, of_bx = (load(board.k_ax, i), load(board.l_ax, i)), (load(board.k_bx, i), load(board.l_bx, i))
        a, b, ahead = pulls((ax - x, ay - y), (bx - x, by - y), of_ax, of_bx, load(board.k_axb, i))
        if board.bent:
            along = fma(b[0], load(board.tangent_x, i), b[1] * load(board.tangent_y, i))
            store(board.along, i, fma(load(board.in_basal, i), along, load(board.along, i)))
        runs = load(board.runs, i)
        store(board.x, i, fma(strength, load(board.push_x, i), x - (a[0] + b[0])))
        store(board.y, i, fma(strength, load(board.push_y, i), y - (a[1] + b[1])))
        store(board.ax, i, ax + a[0] + load(board.drag_x, i))
        store(board.ay, i, ay + a[1] + load(board.drag_y, i))
        store(board.bx, i, fma(runs, ahead[0], fma(load(board.bx_moves, i), b[0], bx)))
        store(board.by, i, fma(runs, ahead[1], fma(load(board.by_moves, i), b[1], by)))
