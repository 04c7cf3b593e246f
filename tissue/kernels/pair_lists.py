"""Lists of the pairs of nuclei that may act on each other, which hold until one has gone too far (Verlet, 1967).

A pair is listed if it is nearer than the range and a skin. As long as both nuclei have moved by less than half of the
skin since, a pair that is not listed is beyond the range.
"""

from __future__ import annotations

from dincl.compiled import inner
from tissue.kernels.bins import find_beside, sort_in_bins
from tissue.kernels.lanes import WIDTH, fma, load, load_from, lowest_bit, positive_bits, where_positive
from tissue.kernels.surface_workspace import (
    ALL,
    FOUND,
    FRESH,
    LISTS,
    MANY,
    QUAD_WIDTH,
    WHOLE,
    SurfaceWorkspace,
    nearest,
    periods,
)
from tissue.kernels.workspace import SOFT


@inner
def add_hard(work: SurfaceWorkspace, i: int, j: int) -> None:
    """Add the pair of cells i and j to those found, if there is room."""
    number = work.state[FOUND]
    if number == len(work.found):
        work.state[ALL] = 1
    else:
        work.found[number, 0], work.found[number, 1] = max(i, j), min(i, j)
        work.hard_row[max(i, j)] += 1
        work.state[FOUND] = number + 1


@inner
def end_hard(work: SurfaceWorkspace, n: int) -> None:
    """Sort the pairs that are found: by counting, then those of a cell, which are few, by insertion."""
    row, hard, total = work.hard_row, work.hard, 0
    for i in range(n + 1):
        row[i], total = total, total + row[i]
    for number in range(work.state[FOUND]):
        i = work.found[number, 0]
        hard[row[i]] = work.found[number, 1]
        row[i] += 1
    for i in range(n, 0, -1):
        row[i] = row[i - 1]
    row[0] = 0
    for i in range(n):
        for k in range(row[i] + 1, row[i + 1]):
            j, at = hard[k], k
            while at > row[i] and hard[at - 1] > j:
                hard[at] = hard[at - 1]
                at -= 1
            hard[at] = j


# Thicker ones make longer lists, thinner ones more of them [R_soft].
SKIN = 0.4
# How far a nucleus may move, less some rounding.
HALF_SKIN = 0.499 * SKIN
# A margin that finds none.
NO_BALLS = -1e300
# load_eight(a, k): entries k to k + 7 of a flat array.
load_eight = load_from(WIDTH)


@inner
def refresh_lists(work: SurfaceWorkspace, n: int, wide: SurfaceWorkspace, rows: int) -> None:
    """Make the lists anew if a nucleus has moved by half of the skin since they were made."""
    if work.state[FRESH] == 0 or _has_gone_far(wide, rows, n):
        make_lists(work, n)


@inner
def _has_gone_far(work: SurfaceWorkspace, rows: int, n: int) -> bool:
    """Return whether a nucleus has moved by half of the skin since the lists were made; the workspace is in rows."""
    x, y, z, made_x, made_y, made_z = work.x, work.y, work.z, work.made_x, work.made_y, work.made_z
    for i in range(rows):
        dx, dy = load(x, i) - load(made_x, i), load(y, i) - load(made_y, i)
        dz = load(z, i) - load(made_z, i)
        far = positive_bits(fma(dx, dx, fma(dy, dy, dz * dz)) - HALF_SKIN * HALF_SKIN)
        if n - WIDTH * i < WIDTH:
            far &= (1 << (n - WIDTH * i)) - 1
        if far:
            return True
    return False


@inner
def make_lists(work: SurfaceWorkspace, n: int) -> None:
    """Both lists, from where the nuclei are now."""
    largest = 0.0
    for i in range(n):
        largest = max(largest, work.radius[i])
    soft, hard = SOFT + SKIN, 2.0 * largest + SKIN
    work.cutoff[0] = max(soft, hard) if work.repulsion[0] != 0.0 else hard
    list_pairs(work, n, work.cutoff[0])
    for i in range(n):
        work.made_x[i], work.made_y[i], work.made_z[i] = work.x[i], work.y[i], work.z[i]
    work.state[FRESH] = 1


@inner
def list_pairs(work: SurfaceWorkspace, n: int, cutoff: float) -> None:
    """List the nuclei that are nearer than ``cutoff``, and of these the hard balls whose gap is below the skin.

    Rows that may find no room are left out: they are found when they are asked for.
    """
    work.state[FRESH] = 0
    work.state[MANY], work.state[MANY + 1], work.state[MANY + 2] = sort_in_bins(work, n, cutoff)
    work.state[FOUND] = work.state[ALL] = 0
    for i in range(n + 1):
        work.hard_row[i] = 0
    whole, end, room = 0, 0, len(work.listed) - n - QUAD_WIDTH
    for b in range(work.state[MANY] * work.state[MANY + 1] * work.state[MANY + 2]):
        if work.start[b] < work.start[b + 1]:
            ranges = find_beside(work, b)
            for p in range(work.start[b], work.start[b + 1]):
                fits = end + p <= room - QUAD_WIDTH
                into = end if fits else room
                last = _list_row(work, p, ranges, cutoff, into, SKIN)
                if fits:
                    work.row[p], work.row_end[p], whole = into, last, p + 1
                    end = fill_up(work, last, n)
    work.state[WHOLE] = whole
    work.counts[LISTS] += 1
    end_hard(work, n)


@inner
def row_of(work: SurfaceWorkspace, p: int, n: int) -> tuple[int, int]:
    """Return where the soft pairs of place p begin and end among those listed."""
    if p < work.state[WHOLE]:
        return work.row[p], work.row_end[p]
    into = len(work.listed) - n - QUAD_WIDTH
    end = _list_row(work, p, find_beside(work, work.bin[work.order[p]]), work.cutoff[0], into, NO_BALLS)
    fill_up(work, end, n)
    return into, end


@inner
def fill_up(work: SurfaceWorkspace, end: int, n: int) -> int:
    """Fill a row that ends there up to fours by the place behind the last: where the next one begins."""
    while end % QUAD_WIDTH != 0:
        work.listed[end] = n
        end += 1
    return end


@inner
def _list_row(work: SurfaceWorkspace, p: int, ranges: int, cutoff: float, into: int, margin: float) -> int:
    """List the places before p that are nearer than ``cutoff``, from ``into`` on: where they end.

    Of these find the hard balls whose gap is below the margin.
    """
    x, y, z, radius, listed = work.place_x, work.place_y, work.place_z, work.place_radius, work.listed
    length_x, by_x, length_z, by_z = periods(work)
    for k in range(ranges):
        end = min(work.end[k], p)
        for q in range(work.begin[k], end, WIDTH):
            dx, dy = nearest(load_eight(x, q) - x[p], length_x, by_x), load_eight(y, q) - y[p]
            dz = nearest(load_eight(z, q) - z[p], length_z, by_z)
            square = fma(dx, dx, fma(dy, dy, dz * dz))
            near = positive_bits(cutoff * cutoff - square)
            if end - q < WIDTH:
                near &= (1 << (end - q)) - 1
            if near:
                balls = load_eight(radius, q) + (radius[p] + margin)
                touch = near & positive_bits(where_positive(balls, balls * balls) - square)
                for lane in range(WIDTH):
                    listed[into] = q + lane
                    into += near >> lane & 1
                while touch:
                    add_hard(work, work.order[p], work.order[q + lowest_bit(touch)])
                    touch &= touch - 1
    return into
