"""The list of the pairs of hard balls that may meet, in the order of their sweep: cell i, then j < i."""

from __future__ import annotations

from dincl.compiled import inner
from tissue.step.space_board import ALL, FOUND, SpaceBoard


@inner
def begin_hard(board: SpaceBoard, n: int) -> None:
    """None is found."""
    board.state[FOUND] = board.state[ALL] = 0
    for i in range(n + 1):
        board.hard_row[i] = 0


@inner
def add_hard(board: SpaceBoard, i: int, j: int) -> None:
    """Cells i and j are found, if there is room."""
    number = board.state[FOUND]
    if number == len(board.found):
        board.state[ALL] = 1
    else:
        board.found[number, 0], board.found[number, 1] = max(i, j), min(i, j)
        board.hard_row[max(i, j)] += 1
        board.state[FOUND] = number + 1


@inner
def end_hard(board: SpaceBoard, n: int) -> None:
    """Sort the pairs that are found: by counting, then those of a cell, which are few, by insertion."""
    row, hard, total = board.hard_row, board.hard, 0
    for i in range(n + 1):
        row[i], total = total, total + row[i]
    for number in range(board.state[FOUND]):
        i = board.found[number, 0]
        hard[row[i]] = board.found[number, 1]
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
