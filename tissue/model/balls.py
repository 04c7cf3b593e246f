"""The sweep over the hard balls (C1), one pair after the other."""

from __future__ import annotations

import math

from dincl.compiled import inner
from dincl.compiled.lanes import WIDTH
from tissue.kernels import kernel
from tissue.kernels.pair_lists import HALF_SKIN, MOST_OUT_OF_RANGE, find_out_of_range, make_lists
from tissue.kernels.surface_workspace import (
    ALL,
    CORRECTIONS,
    DISPLACED,
    FOUND,
    SurfaceWorkspace,
    nearest,
    periods,
    surface_workspace_at,
    wide_surface_workspace_at,
)
from tissue.kernels.workspace import LOST
from tissue.model.out_of_range import list_out_of_range, was_out_of_range

# What ``SurfaceWorkspace.far`` says of a nucleus: near where it was listed, seen to go far, meeting all.
NEAR_BY, GONE, MEETS_ALL = range(3)


@inner
def separate_balls(work: SurfaceWorkspace, n: int, wide: SurfaceWorkspace, rows: int) -> None:
    """|X_i - X_j| >= R_i + R_j (C1) for all pairs in the order i, then j < i, differences as of the nearest image.

    Overlapping balls are pushed apart, each by half of the overlap. Where a nucleus was pushed so far that others than
    those listed may have met it, the sweep begins again, and it meets all: so the result is that of all pairs.
    """
    if find_out_of_range(wide, rows, n) > MOST_OUT_OF_RANGE:
        make_lists(work, n)
    list_out_of_range(work, n, wide, rows)
    for i in range(n):
        work.before_x[i], work.before_y[i], work.before_z[i] = work.x[i], work.y[i], work.z[i]
        work.far[i] = GONE if work.state[ALL] == 1 else NEAR_BY
    corrections, gone = 0, work.state[ALL] == 1
    if not gone and work.state[FOUND] == 0:
        corrections, gone = _sweep_listed(work, n)
    elif not gone:
        work.state[DISPLACED] = 0
        corrections, gone = _sweep_with_more(work, n)
    while gone:
        _begin_again(work, n)
        corrections, gone = _sweep_with_more(work, n)
    work.counts[CORRECTIONS] += corrections


@inner
def _begin_again(work: SurfaceWorkspace, n: int) -> None:
    """Put all nuclei where they were before the sweep; those that went far meet all others from now on."""
    displaced = 0
    for i in range(n):
        work.x[i], work.y[i], work.z[i] = work.before_x[i], work.before_y[i], work.before_z[i]
        if work.far[i] != NEAR_BY:
            work.far[i], work.displaced[displaced] = MEETS_ALL, i
            displaced += 1
    work.state[DISPLACED] = displaced


@inner
def _sweep_listed(work: SurfaceWorkspace, n: int) -> tuple[int, bool]:
    """Sweep over the pairs that are listed: how many were corrected, and whether a nucleus went far."""
    hard, row, corrections, gone = work.hard, work.hard_row, 0, False
    for i in range(n):
        for k in range(row[i], row[i + 1]):
            if _part(work, i, hard[k]):
                corrections += 1
                gone = _went_far(work, i) or gone
                gone = _went_far(work, hard[k]) or gone
    return corrections, gone


@inner
def _sweep_with_more(work: SurfaceWorkspace, n: int) -> tuple[int, bool]:
    """Sweep over the pairs that are listed, those of nuclei out of range, and all of nuclei that meet all, in the order
    of all pairs; the result is as of ``_sweep_listed``.
    """
    hard, row, displaced, corrections, gone = work.hard, work.hard_row, work.displaced, 0, False
    begin = 0
    for i in range(n):
        k, number, j, end = row[i], 0, -1, begin
        while end < work.state[FOUND] and work.found[end, 0] == i:
            end += 1
        while True:
            if work.far[i] == MEETS_ALL:
                j += 1
            else:
                listed = hard[k] if k < row[i + 1] else n
                stray = work.found[begin, 1] if begin < end else n
                far = displaced[number] if number < work.state[DISPLACED] else n
                j = min(listed, stray, far)
                k, begin, number = k + (listed == j), begin + (stray == j), number + (far == j)
            if j >= i:
                break
            if _part(work, i, j):
                corrections += 1
                gone = _went_far(work, i) or gone
                gone = _went_far(work, j) or gone
        begin = end
    return corrections, gone


@inner
def _part(work: SurfaceWorkspace, i: int, j: int) -> bool:
    """Part nuclei i and j if they overlap: whether they did."""
    x, y, z, radius = work.x, work.y, work.z, work.radius
    length_x, by_x, length_z, by_z = periods(work)
    dx, dy, dz = nearest(x[i] - x[j], length_x, by_x), y[i] - y[j], nearest(z[i] - z[j], length_z, by_z)
    square, contact = dx * dx + dy * dy + dz * dz, radius[i] + radius[j]
    if square < contact * contact:
        part = 0.5 * (contact / math.sqrt(square) - 1.0)
        x[i], y[i], z[i] = x[i] + part * dx, y[i] + part * dy, z[i] + part * dz
        x[j], y[j], z[j] = x[j] - part * dx, y[j] - part * dy, z[j] - part * dz
        return True
    return False


@inner
def _went_far(work: SurfaceWorkspace, i: int) -> bool:
    """Return whether nucleus i has gone so far that it may meet others than those listed, but does not meet all yet.

    That is from where it was when the lists were made; nuclei out of range from where they were before the sweep.
    """
    if work.far[i] == MEETS_ALL:
        return False
    dx, dy, dz = work.x[i] - work.made_x[i], work.y[i] - work.made_y[i], work.z[i] - work.made_z[i]
    if was_out_of_range(work, i):
        dx, dy, dz = work.x[i] - work.before_x[i], work.y[i] - work.before_y[i], work.z[i] - work.before_z[i]
    if dx * dx + dy * dy + dz * dz <= HALF_SKIN * HALF_SKIN:
        return False
    work.far[i] = GONE
    return True


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
