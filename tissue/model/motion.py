"""The displacement of a substep by the forces: explicit Euler, Z - (h / mu) grad W(Z); in a slice all z are 0."""

from __future__ import annotations

from typing import Any

from dincl.compiled import inner
from tissue.kernels.lanes import fma, load, store, twice_rsqrt
from tissue.kernels.layout import Lane
from tissue.model.springs import stretched
from tissue.state.surface import PLANE, SPHERE

Arrow = tuple[Lane, Lane, Lane]
Spring = tuple[Lane, Lane]


@inner
def lanes_dot(u: Arrow, v: Arrow) -> Lane:
    """Compute u . v."""
    return fma(u[0], v[0], fma(u[1], v[1], u[2] * v[2]))


@inner
def combined(u: Arrow, p: Lane, v: Arrow, q: Lane) -> Arrow:
    """Compute p u + q v."""
    return fma(p, u[0], q * v[0]), fma(p, u[1], q * v[1]), fma(p, u[2], q * v[2])


@inner
def pulls(u: Arrow, v: Arrow, ax: Spring, bx: Spring, bending: Lane) -> tuple[Arrow, Arrow, Arrow]:
    """Compute displacements of A and B by the springs and the bending energy of a cell; that of X is minus their sum.

    u = A - X, v = B - X; a spring is (k, l), see ``Workspace``. Third is v / |v|, the direction of a basal point that
    moves by itself (4.1). With c = u . v / (|u| |v|) the bending energy alpha (c + 1) displaces A by
    alpha (c u / |u|^2 - v / (|u| |v|)), and B likewise.
    """
    by_u, by_v = 0.5 * twice_rsqrt(lanes_dot(u, u)), 0.5 * twice_rsqrt(lanes_dot(v, v))
    across = bending * by_u * by_v
    turn = across * lanes_dot(u, v)
    along_u = stretched(ax[0], ax[1], by_u, turn * by_u * by_u)
    along_v = stretched(bx[0], bx[1], by_v, turn * by_v * by_v)
    on_a, on_b = combined(u, along_u, v, 0.0 - across), combined(v, along_v, u, 0.0 - across)
    return on_a, on_b, (by_v * v[0], by_v * v[1], by_v * v[2])


@inner
def tangential(work: Any, held: Lane, at: Arrow, force: Arrow) -> Arrow:
    """Compute the part of a displacement along the basal layer where it holds the point, else all of it.

    A slice whose layer bends moves these points along it by themselves.
    """
    bends = work.surface.bends
    if bends == PLANE:
        return force[0], fma(0.0 - held, force[1], force[1]), force[2]
    x, y, z = at
    if bends != SPHERE:
        z = 0.0 * z
    inverse = 0.5 * twice_rsqrt(lanes_dot((x, y, z), (x, y, z)))
    out = 0.0 - held * inverse * inverse * lanes_dot((x, y, z), force)
    return fma(out, x, force[0]), fma(out, y, force[1]), fma(out, z, force[2])


@inner
def move(work: Any, rows: int) -> None:
    """Move the points of each cell by its springs, its bending energy, its junctions and the pushes of soft discs.

    The workspace is that of a slice or of a surface, seen in rows. Where the layer of a slice bends, it moves a basal
    point that it holds by the part of its force that is along the curve. Cells are whole: their own points need no
    nearest image.
    """
    strength = load(work.repulsion, 0)
    for i in range(rows):
        x = load(work.x, i), load(work.y, i), load(work.z, i)
        a = load(work.ax, i), load(work.ay, i), load(work.az, i)
        b = load(work.bx, i), load(work.by, i), load(work.bz, i)
        of_ax, of_bx = (load(work.k_ax, i), load(work.l_ax, i)), (load(work.k_bx, i), load(work.l_bx, i))
        u, v = (a[0] - x[0], a[1] - x[1], a[2] - x[2]), (b[0] - x[0], b[1] - x[1], b[2] - x[2])
        on_a, on_b, ahead = pulls(u, v, of_ax, of_bx, load(work.k_axb, i))
        held = load(work.held, i)
        if work.bent:
            along = fma(on_b[0], load(work.tangent_x, i), on_b[1] * load(work.tangent_y, i))
            store(work.along, i, fma(held, along, load(work.along, i)))
        store(work.x, i, fma(strength, load(work.push_x, i), x[0] - (on_a[0] + on_b[0])))
        store(work.y, i, fma(strength, load(work.push_y, i), x[1] - (on_a[1] + on_b[1])))
        store(work.z, i, fma(strength, load(work.push_z, i), x[2] - (on_a[2] + on_b[2])))
        store(work.ax, i, a[0] + on_a[0] + load(work.drag_x, i))
        store(work.ay, i, a[1] + on_a[1] + load(work.drag_y, i))
        store(work.az, i, a[2] + on_a[2] + load(work.drag_z, i))
        moves, runs = load(work.moves, i), load(work.runs, i)
        on_b = tangential(work, held, b, on_b)
        store(work.bx, i, fma(runs, ahead[0], fma(moves, on_b[0], b[0])))
        store(work.by, i, fma(runs, ahead[1], fma(moves, on_b[1], b[1])))
        store(work.bz, i, fma(runs, ahead[2], fma(moves, on_b[2], b[2])))
