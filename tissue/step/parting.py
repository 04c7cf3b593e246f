"""Overlapping balls of a start are pushed apart, until none overlap."""

from __future__ import annotations

import math

from dincl.compiled import inner
from dincl.compiled.lanes import WIDTH
from tissue.kernels import kernel
from tissue.kernels.board import LOST
from tissue.step.balls import separate_balls
from tissue.step.images import nearest, periods
from tissue.step.lists import make_lists
from tissue.step.space_board import ALL, SpaceBoard, space_board_at, wide_space_board_at


@kernel
def part_balls(flat: int, wide: int, n: int, touching: float, most: int) -> int:
    """Sweep until no overlap is larger than ``touching``: how many sweeps that took, -1 if ``most`` were too few."""
    board, in_rows, rows = space_board_at(flat), wide_space_board_at(wide), (n + WIDTH - 1) // WIDTH
    for made in range(most):
        for i in range(n):
            if not abs(board.x[i]) + abs(board.y[i]) + abs(board.z[i]) < LOST:  # nor if it is NaN
                return -1
        if largest_overlap_of_balls(board, n) <= touching:
            return made
        separate_balls(board, n, in_rows, rows)
    return -1


@inner
def largest_overlap_of_balls(board: SpaceBoard, n: int) -> float:
    """max R_i + R_j - |X_i - X_j|, 0 if no balls overlap."""
    make_lists(board, n)
    length_x, by_x, length_z, by_z = periods(board)
    largest, listed = 0.0, board.state[ALL] == 0
    for i in range(n):
        begin, end = (board.hard_row[i], board.hard_row[i + 1]) if listed else (0, i)
        for k in range(begin, end):
            j = board.hard[k] if listed else k
            dx, dy = nearest(board.x[i] - board.x[j], length_x, by_x), board.y[i] - board.y[j]
            dz = nearest(board.z[i] - board.z[j], length_z, by_z)
            square = dx * dx + dy * dy + dz * dz
            largest = max(largest, board.radius[i] + board.radius[j] - math.sqrt(square))
    return largest
