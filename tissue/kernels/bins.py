"""Nuclei sorted into bins: each near another one is in the same bin or in one beside it.

The bins of an axis come again and again, the m-th is the first: with a period they divide it, without one a bin holds
what is far apart, which costs time but misses nothing. So there are never many more bins than cells, however far a
nucleus has gone.
"""

from __future__ import annotations

from dincl.compiled import inner
from tissue.kernels.lanes import floored
from tissue.kernels.surface_workspace import MANY, SurfaceWorkspace
from tissue.state.cells import Floats, Integers

# How much wider than the cutoff a bin is, of rounding: coordinates are below 1e6.
SLACK = 1e-9
MOST_BINS = 1 << 20

Three = tuple[int, int, int]


@inner
def sort_in_bins(work: SurfaceWorkspace, n: int, cutoff: float) -> Three:
    """Sort n nuclei by counting: whoever is nearer than ``cutoff`` is in bins beside each other. How many on each axis.

    Bins go on along y first, then along z; in a bin the cells keep their order.
    """
    cutoff *= 1.0 + SLACK
    along_x, along_z = work.along_x.length, work.along_z.length
    many_x, many_y = how_many(work.x, n, along_x, cutoff), how_many(work.y, n, 0.0, cutoff)
    many_z = how_many(work.z, n, along_z, cutoff)
    while many_x * many_y * many_z > max(2 * n, 1):
        largest = max(many_x, many_y, many_z)
        if many_x == largest:
            many_x = (many_x + 1) // 2
        elif many_y == largest:
            many_y = (many_y + 1) // 2
        else:
            many_z = (many_z + 1) // 2
    for i in range(n):
        work.bin[i] = 0
    _add_axis(work.bin, work.x, n, many_x, along_x / many_x if along_x > 0.0 else cutoff)
    _add_axis(work.bin, work.z, n, many_z, along_z / many_z if along_z > 0.0 else cutoff)
    _add_axis(work.bin, work.y, n, many_y, cutoff)
    _count(work, n, many_x * many_y * many_z)
    return many_x, many_y, many_z


@inner
def how_many(at: Floats, n: int, length: float, cutoff: float) -> int:
    """Return how many bins of this width an axis takes: those that fit into the period, or as far as there are
    nuclei.
    """
    if length > 0.0:
        return max(1, int(min(length / cutoff, MOST_BINS)))
    low, high = 1e300, -1e300
    for i in range(n):
        low, high = min(low, at[i]), max(high, at[i])
    return int(min((high - low) / cutoff, MOST_BINS)) + 2 if high >= low else 1


@inner
def _add_axis(bins: Integers, at: Floats, n: int, many: int, width: float) -> None:
    """Add the next digit of the number of a bin; coordinates that are no numbers are in the first bin."""
    inverse, whole, share = 1.0 / width, float(many), 1.0 / many
    for i in range(n):
        digit = floored(at[i] * inverse)
        digit -= whole * floored((digit + 0.5) * share)
        bins[i] = many * bins[i] + (int(digit) if 0.0 <= digit < whole else 0)


@inner
def _count(work: SurfaceWorkspace, n: int, bins: int) -> None:
    """Sort by counting: ``order``, ``start`` and what lies at each place."""
    start = work.start
    for b in range(bins + 1):
        start[b] = 0
    for i in range(n):
        start[work.bin[i]] += 1
    total = 0
    for b in range(bins):
        start[b], total = total, total + start[b]
    for i in range(n):
        place = start[work.bin[i]]
        start[work.bin[i]] += 1
        work.order[place] = i
        work.place_x[place], work.place_y[place], work.place_z[place] = work.x[i], work.y[i], work.z[i]
        work.place_radius[place] = work.radius[i]
    for b in range(bins, 0, -1):
        start[b] = start[b - 1]
    start[0] = 0


@inner
def find_beside(work: SurfaceWorkspace, b: int) -> int:
    """List the places of bin b and of those beside it, as far as they come before it: how many ranges.

    They are begin[k] to end[k].
    """
    many_x, many_y, many_z = work.state[MANY], work.state[MANY + 1], work.state[MANY + 2]
    in_x, in_z, in_y = b // (many_y * many_z), b // many_y % many_z, b % many_y
    k = 0
    for step_x in range(min(many_x, 3)):
        at_x = _beside(in_x, step_x, many_x)
        for step_z in range(min(many_z, 3)):
            column = many_z * at_x + _beside(in_z, step_z, many_z)
            for step_y in range(min(many_y, 3)):
                other = many_y * column + _beside(in_y, step_y, many_y)
                if other <= b and work.start[other] < work.start[other + 1]:
                    if k == 0 or work.end[k - 1] != work.start[other]:
                        work.begin[k] = work.start[other]
                        k += 1
                    work.end[k - 1] = work.start[other + 1]
    return k


@inner
def _beside(b: int, step: int, many: int) -> int:
    """Return the bin before this one on its axis, itself, the one behind; of less than three bins each once."""
    other = b + step - (1 if many > 2 else 0)
    if other < 0:
        return other + many
    return other - many if other >= many else other
