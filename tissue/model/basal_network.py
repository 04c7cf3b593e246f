"""The basal points: those of a row in order (C4), neighbours at most max_basal apart (C2), on the surface (C3)."""

from __future__ import annotations

import math

from dincl.compiled import inner
from dincl.compiled.lanes import either, fma, load, root, store
from tissue.kernels.surface_workspace import BASAL_CORRECTIONS, NEIGHBOURS, ORDERED, SurfaceWorkspace, nearest, periods
from tissue.state.surface import PLANE, SPHERE

# How far apart basal points of a row are put that have passed each other [R_soft]: points that coincide have no order.
LEAST_GAP = 1e-6


@inner
def keep_order(work: SurfaceWorkspace) -> None:
    """Put neighbours B_i, B_j of a row around a cylinder in order (C4), each moved by half of the gap.

    Forward is the direction side (-y, x). Sheets have no order.
    """
    x, y, ends, side, corrections = work.bx, work.by, work.neighbours, work.surface.side, 0
    for edge in range(work.sizes[NEIGHBOURS] if work.sizes[ORDERED] > 0 else 0):
        i, j = ends[edge, 0], ends[edge, 1]
        if side * (x[i] * y[j] - y[i] * x[j]) < 0.0:
            mx, my = 0.5 * (x[i] + x[j]), 0.5 * (y[i] + y[j])
            part = 0.5 * LEAST_GAP * side / math.sqrt(mx * mx + my * my)
            x[i], y[i] = mx + part * my, my - part * mx
            x[j], y[j] = mx - part * my, my + part * mx
            corrections += 1
    work.counts[BASAL_CORRECTIONS] += corrections


@inner
def hold_together(work: SurfaceWorkspace) -> None:
    """|B_i - B_j| <= max_basal (C2) for the basal neighbours, one edge after the other, each by half of the excess."""
    x, y, z, ends, most, corrections = work.bx, work.by, work.bz, work.neighbours, work.max_basal, 0
    length_x, by_x, length_z, by_z = periods(work)
    for edge in range(work.sizes[NEIGHBOURS]):
        i, j = ends[edge, 0], ends[edge, 1]
        dx, dy, dz = nearest(x[j] - x[i], length_x, by_x), y[j] - y[i], nearest(z[j] - z[i], length_z, by_z)
        square = dx * dx + dy * dy + dz * dz
        if square > most * most:
            part = 0.5 * (1.0 - most / math.sqrt(square))
            x[i], y[i], z[i] = x[i] + part * dx, y[i] + part * dy, z[i] + part * dz
            x[j], y[j], z[j] = x[j] - part * dx, y[j] - part * dy, z[j] - part * dz
            corrections += 1
    work.counts[BASAL_CORRECTIONS] += corrections


@inner
def put_on_surface(work: SurfaceWorkspace, rows: int) -> None:
    """Bring the basal points that the surface holds to its nearest point: the workspace is in rows."""
    bends, radius = work.surface.bends, work.surface.radius
    for i in range(rows):
        held, x, y, z = load(work.held, i), load(work.bx, i), load(work.by, i), load(work.bz, i)
        if bends == PLANE:
            store(work.by, i, either(held, 0.0, y))
        else:
            square = fma(x, x, y * y)
            if bends == SPHERE:
                square = fma(z, z, square)
            share = radius / root(square)
            store(work.bx, i, either(held, share * x, x))
            store(work.by, i, either(held, share * y, y))
            if bends == SPHERE:
                store(work.bz, i, either(held, share * z, z))
