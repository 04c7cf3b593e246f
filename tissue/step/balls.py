"""The sweep over the hard balls (C1), one pair after the other."""

from __future__ import annotations

import math

from dincl.compiled import inner
from tissue.step.images import nearest, periods
from tissue.step.lists import HALF_SKIN, MOST_STRAYS, find_strays, make_lists
from tissue.step.space_board import ALL, CORRECTIONS, FOUND, THROWN, SpaceBoard
from tissue.step.strays import has_strayed_before, list_strays

# What ``SpaceBoard.far`` says of a nucleus: near the place where it was listed, seen to go far, meeting all others.
NEAR_BY, GONE, MEETS_ALL = range(3)


@inner
def separate_balls(board: SpaceBoard, n: int, wide: SpaceBoard, rows: int) -> None:
    """|X_i - X_j| >= R_i + R_j (C1) for all pairs in the order i, then j < i, differences as of the nearest image.

    Overlapping balls are pushed apart, each by half of the overlap. Where a nucleus was pushed so far that others than
    those listed may have met it, the sweep begins again, and it meets all: so the result is that of all pairs.
    """
    if find_strays(wide, rows, n) > MOST_STRAYS:
        make_lists(board, n)
    list_strays(board, n, wide, rows)
    for i in range(n):
        board.before_x[i], board.before_y[i], board.before_z[i] = board.x[i], board.y[i], board.z[i]
        board.far[i] = GONE if board.state[ALL] == 1 else NEAR_BY
    corrections, gone = 0, board.state[ALL] == 1
    if not gone and board.state[FOUND] == 0:
        corrections, gone = _sweep_listed(board, n)
    elif not gone:
        board.state[THROWN] = 0
        corrections, gone = _sweep_with_more(board, n)
    while gone:
        _begin_again(board, n)
        corrections, gone = _sweep_with_more(board, n)
    board.counts[CORRECTIONS] += corrections


@inner
def _begin_again(board: SpaceBoard, n: int) -> None:
    """All nuclei are where they were before the sweep; those that went far meet all others."""
    thrown = 0
    for i in range(n):
        board.x[i], board.y[i], board.z[i] = board.before_x[i], board.before_y[i], board.before_z[i]
        if board.far[i] != NEAR_BY:
            board.far[i], board.thrown[thrown] = MEETS_ALL, i
            thrown += 1
    board.state[THROWN] = thrown


@inner
def _sweep_listed(board: SpaceBoard, n: int) -> tuple[int, bool]:
    """Sweep over the pairs that are listed: how many were corrected, and whether a nucleus went far."""
    hard, row, corrections, gone = board.hard, board.hard_row, 0, False
    for i in range(n):
        for k in range(row[i], row[i + 1]):
            if _part(board, i, hard[k]):
                corrections += 1
                gone = _went_far(board, i) or gone
                gone = _went_far(board, hard[k]) or gone
    return corrections, gone


@inner
def _sweep_with_more(board: SpaceBoard, n: int) -> tuple[int, bool]:
    """The same over the pairs that are listed, those of strays, and all of nuclei that meet all, in the same order."""
    hard, row, thrown, corrections, gone = board.hard, board.hard_row, board.thrown, 0, False
    begin = 0
    for i in range(n):
        k, number, j, end = row[i], 0, -1, begin
        while end < board.state[FOUND] and board.found[end, 0] == i:
            end += 1
        while True:
            if board.far[i] == MEETS_ALL:
                j += 1
            else:
                listed = hard[k] if k < row[i + 1] else n
                stray = board.found[begin, 1] if begin < end else n
                far = thrown[number] if number < board.state[THROWN] else n
                j = min(listed, stray, far)
                k, begin, number = k + (listed == j), begin + (stray == j), number + (far == j)
            if j >= i:
                break
            if _part(board, i, j):
                corrections += 1
                gone = _went_far(board, i) or gone
                gone = _went_far(board, j) or gone
        begin = end
    return corrections, gone


@inner
def _part(board: SpaceBoard, i: int, j: int) -> bool:
    """Part nuclei i and j if they overlap: whether they did."""
    x, y, z, radius = board.x, board.y, board.z, board.radius
    length_x, by_x, length_z, by_z = periods(board)
    dx, dy, dz = nearest(x[i] - x[j], length_x, by_x), y[i] - y[j], nearest(z[i] - z[j], length_z, by_z)
    square, reach = dx * dx + dy * dy + dz * dz, radius[i] + radius[j]
    if square < reach * reach:
        part = 0.5 * (reach / math.sqrt(square) - 1.0)
        x[i], y[i], z[i] = x[i] + part * dx, y[i] + part * dy, z[i] + part * dz
        x[j], y[j], z[j] = x[j] - part * dx, y[j] - part * dy, z[j] - part * dz
        return True
    return False


@inner
def _went_far(board: SpaceBoard, i: int) -> bool:
    """Whether nucleus i has gone so far that it may meet others than those listed, but does not meet all yet.

    That is from where it was when the lists were made; strays from where they were before the sweep.
    """
    if board.far[i] == MEETS_ALL:
        return False
    dx, dy, dz = board.x[i] - board.made_x[i], board.y[i] - board.made_y[i], board.z[i] - board.made_z[i]
    if has_strayed_before(board, i):
        dx, dy, dz = board.x[i] - board.before_x[i], board.y[i] - board.before_y[i], board.z[i] - board.before_z[i]
    if dx * dx + dy * dy + dz * dz <= HALF_SKIN * HALF_SKIN:
        return False
    board.far[i] = GONE
    return True
