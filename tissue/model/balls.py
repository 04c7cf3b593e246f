"""The sweep over the hard balls (C1), one pair after the other."""

from __future__ import annotations

import math

from dincl.compiled import inner
from tissue.kernels import kernel
from tissue.kernels.lanes import WIDTH
from tissue.kernels.pair_lists import make_lists, refresh_lists
from tissue.kernels.surface_workspace import (
    ALL,
    SurfaceWorkspace,
    nearest,
    periods,
    surface_workspace_at,
    wide_surface_workspace_at,
)
from tissue.kernels.workspace import LOST
from tissue.state.running import CORRECTIONS


@inner
def separate_balls(work: SurfaceWorkspace, n: int, wide: SurfaceWorkspace, rows: int) -> None:
    """|X_i - X_j| >= R_i + R_j (C1) for the pairs that may meet, in the order i, then j < i, to the nearest image.

    Overlapping balls are pushed apart, each by half of the overlap. A nucleus that the sweep itself pushes by more than
    half of the skin may meet others than those listed: the next sweep parts them.
    """
    refresh_lists(work, n, wide, rows)
    hard, row, corrections, listed = work.hard, work.hard_row, 0, work.state[ALL] == 0
    for i in range(n):
        begin, end = (row[i], row[i + 1]) if listed else (0, i)
        for k in range(begin, end):
            corrections += _part(work, i, hard[k] if listed else k)
    work.counts[CORRECTIONS] += corrections


@inner
def _part(work: SurfaceWorkspace, i: int, j: int) -> int:
    """Part nuclei i and j if they overlap; return 1 if they did, else 0."""
    x, y, z, radius = work.x, work.y, work.z, work.radius
    length_x, by_x, length_z, by_z = periods(work)
    dx, dy, dz = nearest(x[i] - x[j], length_x, by_x), y[i] - y[j], nearest(z[i] - z[j], length_z, by_z)
    square, contact = dx * dx + dy * dy + dz * dz, radius[i] + radius[j]
    if square < contact * contact:
        part = 0.5 * (contact / math.sqrt(square) - 1.0)
        x[i], y[i], z[i] = x[i] + part * dx, y[i] + part * dy, z[i] + part * dz
        x[j], y[j], z[j] = x[j] - part * dx, y[j] - part * dy, z[j] - part * dz
        return 1
    return 0


@kernel
def separate_all_balls(flat: int, wide: int, n: int, touching: float, most: int) -> int:
    """Sweep until no overlap is larger than ``touching``: how many sweeps that took, -1 if ``most`` were too few."""
    work, in_rows, rows = surface_workspace_at(flat), wide_surface_workspace_at(wide), (n + WIDTH - 1) // WIDTH
    for made in range(most):
        for i in range(n):
            if not abs(work.x[i]) + abs(work.y[i]) + abs(work.z[i]) < LOST:  # nor if it is NaN
                return -1
        if largest_overlap_of_balls(work, n) <= touching:
            return made
        separate_balls(work, n, in_rows, rows)
    return -1


@inner
def largest_overlap_of_balls(work: SurfaceWorkspace, n: int) -> float:
    """Compute max R_i + R_j - |X_i - X_j|, 0 if no balls overlap."""
    make_lists(work, n)
    length_x, by_x, length_z, by_z = periods(work)
    largest, listed = 0.0, work.state[ALL] == 0
    for i in range(n):
        begin, end = (work.hard_row[i], work.hard_row[i + 1]) if listed else (0, i)
        for k in range(begin, end):
            j = work.hard[k] if listed else k
            dx, dy = nearest(work.x[i] - work.x[j], length_x, by_x), work.y[i] - work.y[j]
            dz = nearest(work.z[i] - work.z[j], length_z, by_z)
            square = dx * dx + dy * dy + dz * dz
            largest = max(largest, work.radius[i] + work.radius[j] - math.sqrt(square))
    return largest
