"""The soft repulsion of nuclei (3.13): discs of radius R_soft = 1 push each other apart where they overlap.

    W = k/2 (2 - d)^2  for d < 2, else 0

It is printed with a minus sign, which would attract. Types may have a radius r and a strength k of their own: then two
nuclei have R = r_i + r_j in place of 2, and (k_i + k_j)/2 (2/R)^p in place of k, with the power p of the springs. So
both are as in the pair energies alpha (R - d)^2/R^p of all variants.
"""

from __future__ import annotations

from dincl.compiled import inner
from tissue.kernels.lanes import (
    WIDTH,
    fma,
    load,
    load_wide,
    maximum,
    spread,
    store,
    twice_rsqrt,
    where_positive,
)
from tissue.kernels.layout import Lane, Plane
from tissue.kernels.near import BLOCK, find_boxes, find_near_rows, list_around, list_before, next_window
from tissue.kernels.workspace import Workspace


@inner
def push_in_rows(work: Workspace, n: int, wide: Workspace, rows: int) -> None:
    """Push of the soft discs on each nucleus of one tissue, the sum of (2 / d - 1) (X_i - X_j) over j.

    Where soft discs differ it has the strength of each pair. Eight nuclei in a row meet all that are near one of them,
    one after the other. Without strength no pair is looked at.
    """
    pairs, repels = 0, work.repulsion[0] != 0.0
    if repels:
        find_near_rows(work, n, work.soft_end)
    for row in range(rows):
        push = spread(wide.x, 0.0), spread(wide.x, 0.0)
        for k in range(list_around(work, row, n) if repels else 0):
            begin, end = work.begin[k], min(work.end[k], n)
            push = _push_row(work, wide, row, begin, end, push)
            pairs += WIDTH * (end - begin)
        store(wide.push_x, row, push[0])
        store(wide.push_y, row, push[1])
    work.pairs[0] += pairs // 2  # each twice


@inner
def _push_row(work: Workspace, wide: Workspace, row: int, begin: int, end: int, push: Plane) -> Plane:
    """Add what cells ``begin`` to ``end`` do to a row, without a branch.

    One that is beyond the range adds exact zeros, as a nucleus does to itself.
    """
    x_i, y_i, (push_x, push_y) = load(wide.x, row), load(wide.y, row), push
    for j in range(begin, end):
        dx, dy = x_i - load_wide(work.x, j), y_i - load_wide(work.y, j)
        square = fma(dx, dx, dy * dy)
        if work.mixed:
            cutoff = load(wide.soft, row) + load_wide(work.soft, j)
            k = load(wide.stiff_xx, row) + load_wide(work.stiff_xx, j)
            weight = where_positive(square, repelling_within(square, cutoff, k, work.mixed))
        else:
            weight = where_positive(square, repelling(square))
        push_x, push_y = fma(weight, dx, push_x), fma(weight, dy, push_y)
    return push_x, push_y


@inner
def push_in_pairs(work: Workspace, n: int) -> None:
    """Push in eight tissues, where each pair is looked at once; sums are added up in the same order. All of them have
    strength, or none.
    """
    repels = work.repulsion[0, 0] != 0.0
    pairs, first, ahead, boxes = 0, 0, spread(work.x, -1e300), work.bent > 0
    if boxes and repels:
        find_boxes(work, n, BLOCK, 0.0, work.soft_end)
    for i in range(n):
        push = spread(work.x, 0.0), spread(work.x, 0.0)
        if not repels:
            pass
        elif boxes:
            for k in range(list_before(work, i)):
                push = _push_pairs(work, i, work.begin[k], min(work.end[k], i), push)
                pairs += max(0, min(work.end[k], i) - work.begin[k])
        else:
            first, ahead = next_window(work, i, first, ahead, 0.0, work.soft_end)
            push = _push_pairs(work, i, first, i, push)
            pairs += i - first
        store(work.push_x, i, 0.0 - push[0])
        store(work.push_y, i, 0.0 - push[1])
    work.pairs[0] += pairs


@inner
def _push_pairs(work: Workspace, i: int, begin: int, end: int, push: Plane) -> Plane:
    """Add what nucleus i does to those from ``begin`` to ``end``, and collect what they do to it, with other sign."""
    push_x, push_y, x_i, y_i = work.push_x, work.push_y, load(work.x, i), load(work.y, i)
    sum_x, sum_y = push
    for j in range(begin, end):
        dx, dy = load(work.x, j) - x_i, load(work.y, j) - y_i
        square = fma(dx, dx, dy * dy)
        if work.mixed:
            cutoff, k = load(work.soft, i) + load(work.soft, j), load(work.stiff_xx, i) + load(work.stiff_xx, j)
            weight = repelling_within(square, cutoff, k, work.mixed)
        else:
            weight = repelling(square)
        sum_x, sum_y = fma(weight, dx, sum_x), fma(weight, dy, sum_y)
        store(push_x, j, fma(weight, dx, load(push_x, j)))
        store(push_y, j, fma(weight, dy, load(push_y, j)))
    return sum_x, sum_y


@inner
def repelling(square: Lane) -> Lane:
    """2 / d - 1 where two soft discs overlap, else 0, from d^2."""
    return maximum(twice_rsqrt(square) - 1.0, 0.0)


@inner
def repelling_within(square: Lane, cutoff: Lane, both: Lane, power: int) -> Lane:
    """Compute k (R/d - 1) where two soft discs overlap, else 0, from d^2, R and k_i + k_j; with the power of the
    springs.
    """
    share = 2.0 / cutoff
    k = 0.5 * both * share
    if power == 2:
        k = k * share
    return k * maximum(0.5 * cutoff * twice_rsqrt(square) - 1.0, 0.0)
