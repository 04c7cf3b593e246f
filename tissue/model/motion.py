"""The displacement of a substep by the forces: explicit Euler, Z - (h / mu) grad W(Z)."""

from __future__ import annotations

from typing import Any

from dincl.compiled import inner
from dincl.compiled.lanes import fma, load, store, twice_rsqrt
from tissue.kernels.board import Board
from tissue.model.bending import turned
from tissue.model.springs import stretched

Lane = Any  # a double, or eight
Plane = tuple[Lane, Lane]
Spring = tuple[Lane, Lane]


@inner
def pulls(u: Plane, v: Plane, ax: Spring, bx: Spring, bending: Lane) -> tuple[Plane, Plane, Plane]:
    """Displacements of A and of B by the springs and the bending energy of a cell; that of X is minus their sum.

    u = A - X, v = B - X; a spring is (k, l), see ``Board``. Third is v / |v|, the direction of a basal point that moves
    by itself (4.1).
    """
    (ux, uy), (vx, vy) = u, v
    by_u, by_v = 0.5 * twice_rsqrt(fma(ux, ux, uy * uy)), 0.5 * twice_rsqrt(fma(vx, vx, vy * vy))
    along_u, along_v, across = turned(u, v, by_u, by_v, bending)
    along_u, along_v = stretched(ax[0], ax[1], by_u, along_u), stretched(bx[0], bx[1], by_v, along_v)
    a = fma(along_u, ux, across * vx), fma(along_u, uy, across * vy)
    b = fma(along_v, vx, across * ux), fma(along_v, vy, across * uy)
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
