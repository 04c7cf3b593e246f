"""The basal points in space: neighbours at most d^max-basal apart (C2), on the surface (C3)."""

from __future__ import annotations

import math

from dincl.compiled import inner
from tissue.kernels.lanes import either, fma, load, root, store
from tissue.kernels.surface_workspace import NEIGHBOURS, SurfaceWorkspace, nearest, periods
from tissue.state.running import BASAL_CORRECTIONS
from tissue.state.surface import PLANE, SPHERE


@inner
def hold_together(work: SurfaceWorkspace) -> None:
    """|B_i - B_j| <= d^max-basal (C2) for basal neighbours, one edge after the other, each by half of the excess."""
    x, y, z, ends, most, corrections = work.bx, work.by, work.bz, work.neighbours, work.max_basal_distance, 0
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
