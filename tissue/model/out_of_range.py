"""The few nuclei that have gone farther than the lists allow: each is compared with all others, in each substep."""

from __future__ import annotations

from dincl.compiled import inner
from dincl.compiled.lanes import WIDTH, fma, load, lowest_bit, positive_bits
from tissue.kernels.pair_lists import HALF_SKIN, SKIN, find_out_of_range
from tissue.kernels.surface_workspace import ALL, FOUND, OUT_OF_RANGE, PAIRS, SurfaceWorkspace, nearest, periods
from tissue.kernels.workspace import SOFT
from tissue.model.repulsion import repelling


@inner
def push_out_of_range(work: SurfaceWorkspace, n: int, wide: SurfaceWorkspace, rows: int) -> None:
    """Add the pushes of the pairs that are not listed, in the order of the nuclei out of range, for each in
    that of the cells.
    """
    length_x, by_x, length_z, by_z = periods(work)
    x, y, z = wide.x, wide.y, wide.z
    for number in range(work.state[OUT_OF_RANGE] if work.repulsion != 0.0 else 0):
        i = work.out_of_range[number]
        for row in range(rows):
            dx, dy = nearest(load(x, row) - work.x[i], length_x, by_x), load(y, row) - work.y[i]
            dz = nearest(load(z, row) - work.z[i], length_z, by_z)
            near = positive_bits(SOFT * SOFT - fma(dx, dx, fma(dy, dy, dz * dz)))
            while near:
                j = WIDTH * row + lowest_bit(near)
                if j < n and j != i and not _is_listed(work, i, j) and (j < i or not _is_out_of_range(work, j)):
                    _push(work, i, j)
                near &= near - 1
        work.counts[PAIRS] += n - 1


@inner
def _is_listed(work: SurfaceWorkspace, i: int, j: int) -> bool:
    """Return whether two nuclei are a pair of the list: as it is decided where the list is made, to the last bit."""
    length_x, by_x, length_z, by_z = periods(work)
    x, y, z = work.made_x, work.made_y, work.made_z
    dx, dy, dz = nearest(x[i] - x[j], length_x, by_x), y[i] - y[j], nearest(z[i] - z[j], length_z, by_z)
    listed: bool = work.cutoff[0] * work.cutoff[0] - fma(dx, dx, fma(dy, dy, dz * dz)) > 0.0
    return listed


@inner
def _is_out_of_range(work: SurfaceWorkspace, i: int) -> bool:
    """Return whether cell i is among the nuclei out of range."""
    dx, dy, dz = work.x[i] - work.made_x[i], work.y[i] - work.made_y[i], work.z[i] - work.made_z[i]
    strayed: bool = fma(dx, dx, fma(dy, dy, dz * dz)) - HALF_SKIN * HALF_SKIN > 0.0
    return strayed


@inner
def _push(work: SurfaceWorkspace, i: int, j: int) -> None:
    """Push nuclei i and j apart."""
    length_x, by_x, length_z, by_z = periods(work)
    x, y, z = work.x, work.y, work.z
    dx, dy, dz = nearest(x[i] - x[j], length_x, by_x), y[i] - y[j], nearest(z[i] - z[j], length_z, by_z)
    weight = repelling(fma(dx, dx, fma(dy, dy, dz * dz)))
    work.push_x[i], work.push_x[j] = fma(weight, dx, work.push_x[i]), fma(-weight, dx, work.push_x[j])
    work.push_y[i], work.push_y[j] = fma(weight, dy, work.push_y[i]), fma(-weight, dy, work.push_y[j])
    work.push_z[i], work.push_z[j] = fma(weight, dz, work.push_z[i]), fma(-weight, dz, work.push_z[j])


@inner
def list_out_of_range(work: SurfaceWorkspace, n: int, wide: SurfaceWorkspace, rows: int) -> None:
    """List for the sweep over hard balls the pairs of nuclei out of range whose gap is now below two skins, in its
    order.

    Whoever is not listed here or there is not met: since now a nucleus out of range is pushed by half of the skin, and
    another nucleus is within half of the skin of where it was listed. Those that find no room make each nucleus meet
    each.
    """
    length_x, by_x, length_z, by_z = periods(work)
    work.state[FOUND], out_of_range = 0, find_out_of_range(wide, rows, n)
    for number in range(out_of_range):
        i = work.out_of_range[number]
        for row in range(rows):
            dx, dy = nearest(load(wide.x, row) - work.x[i], length_x, by_x), load(wide.y, row) - work.y[i]
            dz = nearest(load(wide.z, row) - work.z[i], length_z, by_z)
            cutoff = load(wide.radius, row) + (work.radius[i] + 2.0 * SKIN)
            near = positive_bits(cutoff * cutoff - fma(dx, dx, fma(dy, dy, dz * dz)))
            while near:
                j = WIDTH * row + lowest_bit(near)
                if j < n and j != i:
                    _insert(work, max(i, j), min(i, j))
                near &= near - 1


@inner
def _insert(work: SurfaceWorkspace, i: int, j: int) -> None:
    """Put the pair where it belongs among those found, unless it is there."""
    found, k = work.found, work.state[FOUND]
    if k == len(found):
        work.state[ALL] = 1
        return
    while k > 0 and (found[k - 1, 0] > i or (found[k - 1, 0] == i and found[k - 1, 1] > j)):
        found[k, 0], found[k, 1] = found[k - 1, 0], found[k - 1, 1]
        k -= 1
    if k > 0 and found[k - 1, 0] == i and found[k - 1, 1] == j:
        for m in range(k, work.state[FOUND]):
            found[m, 0], found[m, 1] = found[m + 1, 0], found[m + 1, 1]
    else:
        found[k, 0], found[k, 1] = i, j
        work.state[FOUND] += 1


@inner
def was_out_of_range(work: SurfaceWorkspace, i: int) -> bool:
    """Return whether cell i was among the nuclei out of range before the sweep."""
    dx, dy = work.before_x[i] - work.made_x[i], work.before_y[i] - work.made_y[i]
    dz = work.before_z[i] - work.made_z[i]
    strayed: bool = fma(dx, dx, fma(dy, dy, dz * dz)) - HALF_SKIN * HALF_SKIN > 0.0
    return strayed
