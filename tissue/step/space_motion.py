"""The displacement of a substep by the forces: explicit Euler, Z - (h / mu) grad W(Z)."""

from __future__ import annotations

from typing import Any

from dincl.compiled import inner
from dincl.compiled.lanes import fma, load, store, twice_rsqrt
from tissue.model.springs import stretched
from tissue.state.surface import PLANE, SPHERE
from tissue.step.space_board import SpaceBoard

Lane = Any  # a double, or eight
Arrow = tuple[Lane, Lane, Lane]
Spring = tuple[Lane, Lane]


@inner
def dot(u: Arrow, v: Arrow) -> Lane:
    """u . v."""
    return fma(u[0], v[0], fma(u[1], v[1], u[2] * v[2]))


@inner
def scaled(u: Arrow, p: Lane, v: Arrow, q: Lane) -> Arrow:
    """p u + q v."""
    return fma(p, u[0], q * v[0]), fma(p, u[1], q * v[1]), fma(p, u[2], q * v[2])


@inner
def pulls_on_ends(u: Arrow, v: Arrow, ax: Spring, bx: Spring, bending: Lane) -> tuple[Arrow, Arrow, Arrow]:
    """Displacements of A and of B by the springs and the bending energy of a cell; that of X is minus their sum.

    u = A - X, v = B - X; a spring is (k, l). Third is v / |v|, the direction of a basal point that moves by itself
    (4.1). The bending displaces A by alpha (cos u / |u|^2 - v / (|u| |v|)), and B likewise.
    """
    by_u, by_v = 0.5 * twice_rsqrt(dot(u, u)), 0.5 * twice_rsqrt(dot(v, v))
    across = bending * by_u * by_v
    turn = across * dot(u, v)
    along_u, along_v = (
        stretched(ax[0], ax[1], by_u, turn * by_u * by_u),
        stretched(bx[0], bx[1], by_v, turn * by_v * by_v),
    )
    return (
        scaled(u, along_u, v, 0.0 - across),
        scaled(v, along_v, u, 0.0 - across),
        (by_v * v[0], by_v * v[1], by_v * v[2]),
    )


@inner
def tangential(board: SpaceBoard, held: Lane, at: Arrow, force: Arrow) -> Arrow:
    """The part of a displacement along the surface where it holds the point, else all of it."""
    bends = board.surface.bends
    if bends == PLANE:
        return force[0], fma(0.0 - held, force[1], force[1]), force[2]
    x, y, z = at
    if bends != SPHERE:
        z = 0.0 * z
    inverse = 0.5 * twice_rsqrt(dot((x, y, z), (x, y, z)))
    out = 0.0 - held * inverse * inverse * dot((x, y, z), force)
    return fma(out, x, force[0]), fma(out, y, force[1]), fma(out, z, force[2])


@inner
def move_points(board: SpaceBoard, rows: int) -> None:
    """Move the points of each cell by its springs, its bending energy, its junctions and the pushes of soft balls.

    The board is in rows. Cells are whole: their own points need no nearest image.
    """
    strength = board.repulsion
    for i in range(rows):
        x = load(board.x, i), load(board.y, i), load(board.z, i)
        a = load(board.ax, i), load(board.ay, i), load(board.az, i)
        b = load(board.bx, i), load(board.by, i), load(board.bz, i)
        of_ax, of_bx = (load(board.k_ax, i), load(board.l_ax, i)), (load(board.k_bx, i), load(board.l_bx, i))
        u, v = (a[0] - x[0], a[1] - x[1], a[2] - x[2]), (b[0] - x[0], b[1] - x[1], b[2] - x[2])
        on_a, on_b, ahead = pulls_on_ends(u, v, of_ax, of_bx, load(board.k_axb, i))
        store(board.x, i, fma(strength, load(board.push_x, i), x[0] - (on_a[0] + on_b[0])))
        store(board.y, i, fma(strength, load(board.push_y, i), x[1] - (on_a[1] + on_b[1])))
        store(board.z, i, fma(strength, load(board.push_z, i), x[2] - (on_a[2] + on_b[2])))
        store(board.ax, i, a[0] + on_a[0] + load(board.drag_x, i))
        store(board.ay, i, a[1] + on_a[1] + load(board.drag_y, i))
        store(board.az, i, a[2] + on_a[2] + load(board.drag_z, i))
        moves, runs = load(board.b_moves, i), load(board.runs, i)
        on_b = tangential(board, load(board.held, i), b, on_b)
        store(board.bx, i, fma(runs, ahead[0], fma(moves, on_b[0], b[0])))
        store(board.by, i, fma(runs, ahead[1], fma(moves, on_b[1], b[1])))
        store(board.bz, i, fma(runs, ahead[2], fma(moves, on_b[2], b[2])))
