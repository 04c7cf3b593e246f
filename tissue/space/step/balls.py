"""The sweep over the hard balls (C1), one pair after the other."""

from __future__ import annotations

import math

from dincl.compile import inner
from tissue.space.step.board import ALL, CORRECTIONS, FRESH, SpaceBoard
from tissue.space.step.images import nearest, periods
from tissue.space.step.lists import MARGIN, have_strayed, largest_radius, list_pairs, make_lists

# How far a nucleus may be pushed until a pair that is not listed may have met, less some rounding: part of the margin.
SHARE = 0.499
# How often the margin of the listed pairs is doubled, until each nucleus meets each.
DOUBLINGS = 2


@inner
def separate_balls(board: SpaceBoard, n: int, wide: SpaceBoard, rows: int) -> None:
    """|X_i - X_j| >= R_i + R_j (C1) for all pairs in the order i, then j < i, differences as of the nearest image.

    Overlapping balls are pushed apart, each by half of the overlap. Where a nucleus was pushed so far that others than
    those listed may have met it, the sweep begins again, with a longer list.
    """
    if board.state[FRESH] == 0 or have_strayed(wide, rows):
        make_lists(board, n)
    for i in range(n):
        board.before_x[i], board.before_y[i], board.before_z[i] = board.x[i], board.y[i], board.z[i]
    farthest, corrections = _sweep(board, n)
    if farthest > (SHARE * MARGIN) ** 2 and board.state[ALL] == 0:
        corrections = _sweep_again(board, n)
    board.counts[CORRECTIONS] += corrections


@inner
def _sweep_again(board: SpaceBoard, n: int) -> int:
    """The same sweep with longer and longer lists, until none is too short: how many pairs were corrected."""
    margin = MARGIN
    for doubling in range(DOUBLINGS + 1):
        margin *= 2.0
        for i in range(n):
            board.x[i], board.y[i], board.z[i] = board.before_x[i], board.before_y[i], board.before_z[i]
            board.made_x[i], board.made_y[i], board.made_z[i] = board.x[i], board.y[i], board.z[i]
        if doubling < DOUBLINGS:
            list_pairs(board, n, 2.0 * largest_radius(board, n) + margin, margin)
        else:
            board.state[FRESH], board.state[ALL] = 0, 1
        farthest, corrections = _sweep(board, n)
        if farthest <= (SHARE * margin) ** 2 or board.state[ALL] == 1:
            break
    return corrections


@inner
def _sweep(board: SpaceBoard, n: int) -> tuple[float, int]:
    """Sweep; the square of the longest way of a nucleus since the list was made, and how many pairs were corrected."""
    x, y, z, radius, hard, row = board.x, board.y, board.z, board.radius, board.hard, board.hard_row
    length_x, by_x, length_z, by_z = periods(board)
    farthest, corrections, listed = 0.0, 0, board.state[ALL] == 0
    for i in range(n):
        begin, end = (row[i], row[i + 1]) if listed else (0, i)
        for k in range(begin, end):
            j = hard[k] if listed else k
            dx, dy, dz = nearest(x[i] - x[j], length_x, by_x), y[i] - y[j], nearest(z[i] - z[j], length_z, by_z)
            square, reach = dx * dx + dy * dy + dz * dz, radius[i] + radius[j]
            if square < reach * reach:
                part = 0.5 * (reach / math.sqrt(square) - 1.0)
                x[i], y[i], z[i] = x[i] + part * dx, y[i] + part * dy, z[i] + part * dz
                x[j], y[j], z[j] = x[j] - part * dx, y[j] - part * dy, z[j] - part * dz
                farthest = max(farthest, _way(board, i), _way(board, j))
                corrections += 1
    return farthest, corrections


@inner
def _way(board: SpaceBoard, i: int) -> float:
    """The square of how far nucleus i has gone since the list was made."""
    dx, dy, dz = board.x[i] - board.made_x[i], board.y[i] - board.made_y[i], board.z[i] - board.made_z[i]
    square: float = dx * dx + dy * dy + dz * dz
    return square
