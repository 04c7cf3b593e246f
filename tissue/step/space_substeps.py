"""The substeps of position based dynamics in three dimensions between two updates of the rules (Method 3.7, (3.34))."""

from __future__ import annotations

from threading import Lock
from typing import Any

from dincl.compiled import c_function, inner, signature
from dincl.compiled.lanes import WIDTH
from tissue.step.balls import separate_balls
from tissue.step.basal import hold_together, keep_order, put_on_surface
from tissue.step.lists import refresh_lists
from tissue.step.soft import push_nuclei
from tissue.step.space_board import FRESH, SUBSTEPS, SpaceBoard, space_board_at, wide_space_board_at
from tissue.step.space_junctions import pull_along_edges
from tissue.step.space_motion import move_points
from tissue.step.space_noise import shake_nuclei
from tissue.step.strays import push_strays

_SIGNATURE: Any = signature(int, int, int, int)


@inner
def make_space_substep(board: SpaceBoard, n: int, wide: SpaceBoard, rows: int, number: int) -> None:
    """A substep of the n cells on the board: noise, forces, one sweep of projections.

    ``wide`` is the same board in ``rows`` of eight cells, ``board`` in single numbers.
    """
    shake_nuclei(wide, rows, number)
    refresh_lists(board, n, wide, rows)
    push_nuclei(board, n)
    push_strays(board, n, wide, rows)
    pull_along_edges(board, n)
    move_points(wide, rows)
    separate_balls(board, n, wide, rows)
    keep_order(board)
    hold_together(board)
    put_on_surface(wide, rows)


def _substeps(flat: int, wide: int, n: int) -> int:
    """All substeps of one dt for a tissue of n cells, whose board has these addresses; 0.

    The lists are made anew: what a step does is a function of what is on the board.
    """
    board, in_rows, rows = space_board_at(flat), wide_space_board_at(wide), (n + WIDTH - 1) // WIDTH
    for word in range(2):
        for lane in range(WIDTH):
            in_rows.noise_key[word, lane] = board.noise_key[word]
    board.state[FRESH] = 0
    for number in range(board.substeps):
        make_space_substep(board, n, in_rows, rows, number)
    board.counts[SUBSTEPS] += board.substeps
    return 0


# For the life of the process; threads come one at a time.
_COMPILED: list[Any] = []
_COMPILING = Lock()


def space_substeps_address() -> int:
    """The machine code of all substeps of one dt, compiled on first use.

    It takes the addresses of the board, flat and wide, and the number of cells, as that of ``tissue.step.substeps``.
    """
    with _COMPILING:
        if not _COMPILED:
            _COMPILED.append(c_function(_SIGNATURE, _substeps))
    address: int = _COMPILED[0].address
    return address
