"""The sweep over the hard discs (C1), one pair after the other."""

from __future__ import annotations

import math
from typing import Any

from dincl.compiled import inner
from tissue.kernels import kernel
from tissue.kernels.lanes import load, maximum, positive_bits, root, spread, store, where_positive
from tissue.kernels.layout import Plane
from tissue.kernels.near import BLOCK, find_boxes, list_before, next_window
from tissue.kernels.workspace import LOST, Workspace, workspace_at

# Pairs with a larger gap before the sweep are not looked at in it at first [R_soft].
MARGIN = 0.3
# How far a nucleus may be pushed until such a pair may have met, as a share of the margin: a half, less some rounding.
HALF = 0.499
# By how much the margin grows where a nucleus was pushed farther, and beyond which all pairs are looked at.
WIDER, WIDEST = 4.0, 1e3


@inner
def separate(work: Workspace, n: int) -> None:
    """|X_i - X_j| >= R_i + R_j (C1) for all pairs in the order i, then j < i.

    Overlapping discs are pushed apart, each by half of the overlap. Where a nucleus was pushed so far that others than
    those near it may have met it, the sweep begins again with a larger margin. A pair that does not overlap changes
    nothing, so the result is that of all pairs.
    """
    margin = MARGIN
    pushed, corrections = _push_apart(work, n, margin)
    while positive_bits(pushed - HALF * margin * (HALF * margin)):
        margin = margin * WIDER if margin < WIDEST else math.inf
        for i in range(n):
            store(work.x, i, load(work.before_x, i))
            store(work.y, i, load(work.before_y, i))
        pushed, corrections = _push_apart(work, n, margin)
    store(work.counts, 0, load(work.counts, 0) + corrections)


@inner
def _push_apart(work: Workspace, n: int, margin: float) -> tuple[Any, Any]:
    """Sweep over all pairs with gaps below a margin; the square of the longest way of a nucleus, and the corrections.

    A nucleus is moved by none before its own turn, so where it was before the sweep, and which cells may be near it, is
    found then.
    """
    done = spread(work.x, 0.0), spread(work.x, 0.0)
    boxes, ahead, first = work.bent > 0 and margin < math.inf, spread(work.x, -1e300), 0
    if boxes:
        find_boxes(work, n, BLOCK, 1.0, 0.5 * margin)
    for i in range(n):
        at = load(work.x, i), load(work.y, i)
        store(work.before_x, i, at[0])
        store(work.before_y, i, at[1])
        if boxes:
            for k in range(list_before(work, i)):
                at, done = _separate_from(work, i, work.begin[k], min(work.end[k], i), at, done)
        else:
            first, ahead = next_window(work, i, first, ahead, 1.0, 0.5 * margin)
            at, done = _separate_from(work, i, first, i, at, done)
        store(work.x, i, at[0])
        store(work.y, i, at[1])
    return done


@inner
def _separate_from(work: Workspace, i: int, begin: int, end: int, at: Plane, done: Plane) -> tuple[Plane, Plane]:
    """Part nucleus i from those from ``begin`` to ``end``: where it is then; ``done`` as of ``_push_apart``."""
    x, y, radius, (x_i, y_i), (pushed, corrections) = work.x, work.y, work.radius, at, done
    radius_i, one = load(radius, i), spread(x, 1.0)
    for j in range(begin, end):
        dx, dy, contact = x_i - load(x, j), y_i - load(y, j), radius_i + load(radius, j)
        square = dx * dx + dy * dy
        overlap = contact * contact - square
        if positive_bits(overlap):
            part = where_positive(overlap, 0.5 * (contact / root(square) - 1.0))
            x_i, y_i = x_i + part * dx, y_i + part * dy
            x_j, y_j = load(x, j) - part * dx, load(y, j) - part * dy
            store(x, j, x_j)
            store(y, j, y_j)
            way_i = _square(x_i - load(work.before_x, i), y_i - load(work.before_y, i))
            way_j = _square(x_j - load(work.before_x, j), y_j - load(work.before_y, j))
            pushed = maximum(pushed, maximum(way_i, way_j))
            corrections = corrections + where_positive(overlap, one)
    return (x_i, y_i), (pushed, corrections)


@inner
def _square(x: Any, y: Any) -> Any:
    return x * x + y * y


@kernel
def separate_all(flat: int, wide: int, n: int, touching: float, most: int) -> int:
    """Sweep until no overlap is larger than ``touching``: how many sweeps that took, -1 if ``most`` were too few.

    ``flat`` and ``wide`` are addresses of a workspace. Nuclei that lie in one point cannot be separated either.
    """
    work = workspace_at(flat)
    for made in range(most):
        for i in range(n):
            if not abs(work.x[i]) + abs(work.y[i]) < LOST:  # nor if it is NaN
                return -1
        if largest_overlap(work, n) <= touching:
            return made
        separate(work, n)
    return -1


@inner
def largest_overlap(work: Workspace, n: int) -> float:
    """Compute max R_i + R_j - |X_i - X_j| of one tissue, 0 if no discs overlap."""
    x, y, radius, largest = work.x, work.y, work.radius, 0.0
    find_boxes(work, n, BLOCK, 1.0, 0.0)
    for i in range(n):
        for k in range(list_before(work, i)):
            for j in range(work.begin[k], min(work.end[k], i)):
                largest = max(largest, radius[i] + radius[j] - math.hypot(x[i] - x[j], y[i] - y[j]))
    return largest
