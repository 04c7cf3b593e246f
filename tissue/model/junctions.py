"""The junctions of neighbours in the apical layer (3.11), and of those that have left it together.

W = k/2 (d - eta)^2,  k = junction_factor (alpha_i + alpha_j) / 2
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from dincl.compiled import inner
from tissue.kernels.lanes import either, fma, load, spread, store, twice_rsqrt, where_positive
from tissue.kernels.layers import at_ends
from tissue.kernels.surface_workspace import JUNCTIONS, SurfaceWorkspace, nearest, periods
from tissue.kernels.workspace import Workspace
from tissue.state.cells import CellLayers, Cells, Integers


def pairs(cells: Cells, layers: CellLayers, closed: bool) -> tuple[Integers, Integers]:
    """Return the cells i and j that junctions join, eta being that of i: in the layer, in a tube its ends, and in
    chains.
    """
    apical, chained = layers.apical, np.flatnonzero(cells.chain)
    ring = closed and len(apical) > 2
    chained = chained[np.argsort(cells.chain[chained], kind="stable")]
    linked = cells.chain[chained[:-1]] == cells.chain[chained[1:]]
    i = (apical[:-1], apical[-1:] if ring else apical[:0], chained[:-1][linked])
    j = (apical[1:], apical[:1] if ring else apical[:0], chained[1:][linked])
    return np.concatenate(i), np.concatenate(j)


@inner
def pulling(square: Any, rest: Any, k: Any) -> Any:
    """Compute k (1 - eta / d) from d^2: the displacement of an end of a junction over the arrow to the other end."""
    return k - 0.5 * k * rest * twice_rsqrt(square)


@inner
def pull_junctions(work: Workspace, n: int, wide: Workspace, rows: int) -> None:
    """Displacement of the apical points by their junctions, pulls k (d - eta), for neighbours in the layer.

    Each cell of the layer finds the one before it, then how their junction pulls it, then what the next one does. In a
    ring the last one is before the first.
    """
    inside_at, ax, ay, drag_x, drag_y = work.in_apical, work.ax, work.ay, work.drag_x, work.drag_y
    x, y = spread(ax, 0.0), spread(ax, 0.0)
    if work.curve.ring > 0.0:
        x, y = at_ends(inside_at, ax, n)[1], at_ends(inside_at, ay, n)[1]
    for i in range(n):
        inside = load(inside_at, i)
        store(drag_x, i, x)
        store(drag_y, i, y)
        x, y = either(inside, load(ax, i), x), either(inside, load(ay, i), y)
    for i in range(rows):
        dx, dy, k = load(wide.ax, i) - load(wide.drag_x, i), load(wide.ay, i) - load(wide.drag_y, i), load(wide.k_aa, i)
        pull = where_positive(load(wide.joined, i), pulling(fma(dx, dx, dy * dy), load(wide.rest, i), k))
        store(wide.drag_x, i, pull * dx)
        store(wide.drag_y, i, pull * dy)
    x, y = spread(ax, 0.0), spread(ax, 0.0)
    if work.curve.ring > 0.0:
        x, y = at_ends(inside_at, drag_x, n)[0], at_ends(inside_at, drag_y, n)[0]
    for i in range(n - 1, -1, -1):
        inside, back_x, back_y = load(inside_at, i), load(drag_x, i), load(drag_y, i)
        store(drag_x, i, where_positive(inside, x - back_x))
        store(drag_y, i, where_positive(inside, y - back_y))
        x, y = either(inside, back_x, x), either(inside, back_y, y)


@inner
def pull_links(work: Workspace) -> None:
    """Add to the displacements of the apical points what the junctions of chains do, pulls k (d - eta).

    The workspace is seen flat.
    """
    ax, ay, drag_x, drag_y, links = work.ax, work.ay, work.drag_x, work.drag_y, work.links
    for number in range(links[0]):
        i, j = links[1 + 2 * number], links[2 + 2 * number]
        dx, dy = ax[i] - ax[j], ay[i] - ay[j]
        d = math.sqrt(dx * dx + dy * dy)
        if d > 0.0:
            pull = work.k_aa[i] * (1.0 - work.rest[i] / d)
            drag_x[i] -= pull * dx
            drag_y[i] -= pull * dy
            drag_x[j] += pull * dx
            drag_y[j] += pull * dy


@inner
def pull_along_edges(work: SurfaceWorkspace, n: int) -> None:
    """Displacement of the apical points of n cells by their junctions, pulls k (d - eta), one edge after the other.

    A junction without length has no direction, and does nothing.
    """
    ax, ay, az = work.ax, work.ay, work.az
    drag_x, drag_y, drag_z, ends = work.drag_x, work.drag_y, work.drag_z, work.junctions
    length_x, by_x, length_z, by_z = periods(work)
    for i in range(n):
        drag_x[i] = drag_y[i] = drag_z[i] = 0.0
    for edge in range(work.sizes[JUNCTIONS]):
        i, j, k = ends[edge, 0], ends[edge, 1], work.k_aa[edge]
        dx, dy, dz = nearest(ax[j] - ax[i], length_x, by_x), ay[j] - ay[i], nearest(az[j] - az[i], length_z, by_z)
        square = fma(dx, dx, fma(dy, dy, dz * dz))
        pull = where_positive(square, pulling(square, work.rest[edge], k))
        drag_x[i], drag_y[i], drag_z[i] = (
            fma(pull, dx, drag_x[i]),
            fma(pull, dy, drag_y[i]),
            fma(pull, dz, drag_z[i]),
        )
        drag_x[j], drag_y[j], drag_z[j] = (
            fma(-pull, dx, drag_x[j]),
            fma(-pull, dy, drag_y[j]),
            fma(-pull, dz, drag_z[j]),
        )
