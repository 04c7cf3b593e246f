"""The displacement of a substep by the forces: explicit Euler, Z - (h / mu) grad W(Z)."""

from __future__ import annotations

from typing import Any

from tissue.kernels._numba import kernel
from tissue.kernels.lanes import WIDTH, fma, load, spread, store, twice_rsqrt, where_positive
from tissue.kernels.scratch import SOFT_PAIRS, Scratch
from tissue.model.cells import CellLayers, Cells
from tissue.model.numbers import Numbers

Lane = Any  # a value of type Lanes
Plane = tuple[Lane, Lane]
Spring = tuple[Lane, Lane]


@kernel
def prepare(
    cells: Cells, n: int, layers: CellLayers, apical: int, numbers: Numbers, scale: float, scratch: Scratch
) -> None:
    """Coefficients that stay the same until the rules change again; ``scale`` = h / mu.

    The spring W = alpha (d - l)^2 / l^p, l = 1 + eta, moves X by -k (1 - l / d) (X - A), k = 2 alpha scale / l^p; a
    junction has k = scale junction_factor (alpha_i + alpha_j) / 2.
    """
    squared = numbers.power == 2
    for i in range(n):
        l_ax, l_bx = 1.0 + cells.rest_ax[i], 1.0 + cells.rest_bx[i]
        scratch.l_ax[i], scratch.l_bx[i] = l_ax, l_bx
        scratch.k_ax[i] = 2.0 * scale * cells.stiff_ax[i] / (l_ax * l_ax if squared else l_ax)
        scratch.k_bx[i] = 2.0 * scale * cells.stiff_bx[i] / (l_bx * l_bx if squared else l_bx)
        scratch.k_axb[i] = scale * cells.stiff_axb[i]
    for k in range(apical - 1):
        i, j = layers.apical[k], layers.apical[k + 1]
        scratch.rest[k] = cells.rest_aa[i]
        scratch.k_aa[k] = scale * numbers.junction_factor * (0.5 * (cells.stiff_aa[i] + cells.stiff_aa[j]))


@kernel
def repulsion(cells: Cells, n: int, strength: float, scratch: Scratch) -> None:
    """Push of the soft discs on each nucleus, k (2 - d) along the line of centres, for the sorted nuclei.

    A block of nuclei meets all nuclei of its window one after the other: no list of pairs, no branch. A pair beyond the
    range adds nothing, for 2 / d - 1 <= 0, nor does a nucleus with itself. Without strength no pair is looked at.
    """
    if strength == 0.0:
        scratch.push_x[:n] = 0.0
        scratch.push_y[:n] = 0.0
        return
    for s in range(n):
        scratch.sorted_x[s] = cells.x[scratch.order[s]]
        scratch.sorted_y[s] = cells.y[scratch.order[s]]
    pairs = 0
    for block in range((n + WIDTH - 1) // WIDTH):
        start, end = block * WIDTH, block * WIDTH + WIDTH
        low, high = scratch.low[block], scratch.high[block]
        pairs += high - low
        x, y = load(scratch.sorted_x, start), load(scratch.sorted_y, start)
        push_x, push_y = spread(0.0), spread(0.0)
        for part in range(3):  # before the block, in it, after it: only in it a nucleus meets itself
            begin = (low, start, end)[part]
            stop = (min(start, high), min(end, n), high)[part]
            for s in range(begin, stop):
                dx, dy = x - scratch.sorted_x[s], y - scratch.sorted_y[s]
                square = fma(dx, dx, dy * dy)
                weight = twice_rsqrt(square) - 1.0
                weight = where_positive(weight, weight)
                if part == 1:
                    weight = where_positive(square, weight)
                push_x, push_y = fma(weight, dx, push_x), fma(weight, dy, push_y)
        store(scratch.push_x, start, strength * push_x)
        store(scratch.push_y, start, strength * push_y)
    scratch.counts[SOFT_PAIRS] += pairs * WIDTH


@kernel
def junctions(cells: Cells, layers: CellLayers, apical: int, scratch: Scratch) -> None:
    """Pull k (d - eta) of the junction behind each point of the apical layer towards the next, for the layer."""
    for k in range(apical):
        i = layers.apical[k]
        scratch.layer_x[k] = cells.ax[i]
        scratch.layer_y[k] = cells.ay[i]
    for k in range(0, apical - 1, WIDTH):
        dx = load(scratch.layer_x, k + 1) - load(scratch.layer_x, k)
        dy = load(scratch.layer_y, k + 1) - load(scratch.layer_y, k)
        strength = load(scratch.k_aa, k)
        pull = strength - 0.5 * strength * load(scratch.rest, k) * twice_rsqrt(fma(dx, dx, dy * dy))
        store(scratch.pull_x, k, pull * dx)
        store(scratch.pull_y, k, pull * dy)


@kernel
def pulls(u: Plane, v: Plane, ax: Spring, bx: Spring, bending: Lane) -> tuple[Plane, Plane, Plane]:
    """Displacements of A and of B by the springs and the bending energy of eight cells; that of X is minus their sum.

    Third is v / |v|, the direction of a basal point that moves by itself (4.1).

    With u = A - X, v = B - X, c the cosine between them, and W = alpha (c + 1):
    -dW/dA = alpha (c u / |u|^2 - v / (|u| |v|)), likewise for B. A spring is (k, l), see ``prepare``.
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


@kernel
def move_by_springs(cells: Cells, n: int, scratch: Scratch) -> None:
    """Move the three points of each cell by its two springs and by its bending energy, in place."""
    for i in range(0, n, WIDTH):
        x, y = load(cells.x, i), load(cells.y, i)
        ax, ay, bx, by = load(cells.ax, i), load(cells.ay, i), load(cells.bx, i), load(cells.by, i)
        of_ax = load(scratch.k_ax, i), load(scratch.l_ax, i)
        of_bx = load(scratch.k_bx, i), load(scratch.l_bx, i)
        a, b, ahead = pulls((ax - x, ay - y), (bx - x, by - y), of_ax, of_bx, load(scratch.k_axb, i))
        runs = load(scratch.runs, i)
        store(cells.x, i, x - (a[0] + b[0]))
        store(cells.y, i, y - (a[1] + b[1]))
        store(cells.ax, i, ax + a[0])
        store(cells.ay, i, ay + a[1])
        store(cells.bx, i, fma(runs, ahead[0], fma(load(scratch.bx_moves, i), b[0], bx)))
        store(cells.by, i, fma(runs, ahead[1], fma(load(scratch.by_moves, i), b[1], by)))


@kernel
def move_by_neighbours(cells: Cells, n: int, layers: CellLayers, apical: int, scratch: Scratch) -> None:
    """Add the pushes between nuclei and the pulls of the junctions to the positions."""
    for s in range(n):
        cells.x[scratch.order[s]] += scratch.push_x[s]
        cells.y[scratch.order[s]] += scratch.push_y[s]
    behind_x, behind_y = 0.0, 0.0
    for k in range(apical):
        i = layers.apical[k]
        pull_x, pull_y = (scratch.pull_x[k], scratch.pull_y[k]) if k < apical - 1 else (0.0, 0.0)
        cells.ax[i] += pull_x - behind_x
        cells.ay[i] += pull_y - behind_y
        behind_x, behind_y = pull_x, pull_y
