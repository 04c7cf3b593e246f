"""One sweep of projections, constraint by constraint: what makes a prediction feasible in position based dynamics."""

from __future__ import annotations

import math

from tissue.kernels._numba import kernel
from tissue.kernels.neighbours import SKIN, list_again, make_lists
from tissue.kernels.scratch import BASAL_CORRECTIONS, CORRECTIONS, NEAR, STALE, Scratch
from tissue.model.cells import CellLayers, Cells, Floats


@kernel
def separate(cells: Cells, n: int, scratch: Scratch) -> bool:
    """|X_i - X_j| >= R_i + R_j (C1) for all pairs in the order i, then j < i; False if the lists have no room.

    Overlapping discs are pushed apart, each by half of the overlap. What a push takes out of the surroundings for which
    it was listed is listed again at once, so that no contact is overlooked.
    """
    x, y, radius, near, near_count = cells.x, cells.y, cells.radius, scratch.near, scratch.near_count
    listed_x, listed_y = scratch.listed_x, scratch.listed_y
    corrections, room = 0, True
    for i in range(n):
        k = i * NEAR
        while k < i * NEAR + near_count[i]:
            j = near[k]
            k += 1
            if push_apart(x, y, radius, i, j):
                corrections += 1
                i_left = _left(x[i] - listed_x[i], y[i] - listed_y[i])
                if i_left or _left(x[j] - listed_x[j], y[j] - listed_y[j]):
                    room = list_again(cells, i if i_left else j, n, scratch) and room
                    if i_left and _left(x[j] - listed_x[j], y[j] - listed_y[j]):
                        room = list_again(cells, j, n, scratch) and room
                    k = i * NEAR  # the row may have grown in front: go on behind j
                    while k < i * NEAR + near_count[i] and near[k] <= j:
                        k += 1
    scratch.counts[CORRECTIONS] += corrections
    return room


@kernel
def push_apart(x: Floats, y: Floats, radius: Floats, i: int, j: int) -> bool:
    """Move two discs that overlap apart, each by half of the overlap; whether they did."""
    dx, dy, reach = x[i] - x[j], y[i] - y[j], radius[i] + radius[j]
    square = dx * dx + dy * dy
    if not square < reach * reach:
        return False
    part = 0.5 * (reach / math.sqrt(square) - 1.0)
    x[i] += part * dx
    y[i] += part * dy
    x[j] -= part * dx
    y[j] -= part * dy
    return True


@kernel
def _left(dx: float, dy: float) -> bool:
    """Whether a nucleus that moved by (dx, dy) since it was listed left the surroundings for which its list holds."""
    return dx * dx + dy * dy > 0.25 * SKIN * SKIN


@kernel
def refresh(cells: Cells, n: int, scratch: Scratch) -> bool:
    """Make the lists again if they are stale or any nucleus left; False if they have no room."""
    x, y, listed_x, listed_y = cells.x, cells.y, scratch.listed_x, scratch.listed_y
    left = scratch.flags[STALE]
    for i in range(n):
        left += _left(x[i] - listed_x[i], y[i] - listed_y[i])
    return left == 0 or make_lists(cells, n, scratch)


@kernel
def order_basal(cells: Cells, layers: CellLayers, basal: int, largest: float, scratch: Scratch) -> None:
    """0 <= b_{k+1} - b_k (C4) for all neighbours from left to right, then b_{k+1} - b_k <= largest (C2) likewise."""
    x, layer = cells.bx, layers.basal
    corrections = 0
    for k in range(basal - 1):
        i, j = layer[k], layer[k + 1]
        gap = x[j] - x[i]
        if gap < 0.0:
            x[i] += 0.5 * gap
            x[j] -= 0.5 * gap
            corrections += 1
    for k in range(basal - 1):
        i, j = layer[k], layer[k + 1]
        excess = x[j] - x[i] - largest
        if excess > 0.0:
            x[i] += 0.5 * excess
            x[j] -= 0.5 * excess
            corrections += 1
    scratch.counts[BASAL_CORRECTIONS] += corrections


@kernel
def largest_overlap(cells: Cells, n: int, scratch: Scratch) -> float:
    """max R_i + R_j - |X_i - X_j| over the listed pairs, 0 if none overlap."""
    largest = 0.0
    for i in range(n):
        for k in range(i * NEAR, i * NEAR + scratch.near_count[i]):
            j = scratch.near[k]
            distance = math.hypot(cells.x[i] - cells.x[j], cells.y[i] - cells.y[j])
            largest = max(largest, cells.radius[i] + cells.radius[j] - distance)
    return largest


@kernel
def part(cells: Cells, n: int, touching: float, most: int, scratch: Scratch) -> int:
    """Sweep until no overlap is larger than ``touching``: how many sweeps that took, -1 if ``most`` were too few."""
    for made in range(most):
        if not make_lists(cells, n, scratch):
            return -1
        if largest_overlap(cells, n, scratch) <= touching:
            return made
        separate(cells, n, scratch)
    return -1
