"""The substeps of position based dynamics between two updates of the rules (Method 3.7, (3.34)).

Written once, and compiled twice: for one tissue, with a double for each cell, and for eight, with eight.
"""

from __future__ import annotations

from threading import Lock
from typing import Any

from dincl.compiled import c_function, inner, signature
from dincl.compiled.lanes import WIDTH
from tissue.kernels.board import Board, board_at, wide_board_at
from tissue.kernels.normals import shake
from tissue.model.basal_layer import lay, order_basal
from tissue.model.discs import separate
from tissue.model.junctions import pull_junctions, pull_links
from tissue.model.motion import move
from tissue.model.repulsion import push_in_pairs, push_in_rows
from tissue.step.own_forces import call_own, own_at

_SIGNATURE: Any = signature(int, int, int, int)


@inner
def shaken(wide: Board, rows: int, number: int) -> None:
    """The noise of substep ``number``, if it comes in substeps."""
    if wide.deviation > 0.0:
        shake(wide.x, wide.y, wide.id, rows, wide.deviation, wide.noise_key, number)


@inner
def make_substep(board: Board, n: int, wide: Board, rows: int, flat: Board) -> None:
    """A substep of the n cells on the board when their nuclei know how they push: forces, one sweep of projections.

    What a cell does by itself is done for eight at once: ``wide`` is the board in ``rows`` of eight cells, of one
    tissue or of eight; ``flat`` is the board in single numbers.
    """
    pull_junctions(board, n, wide, rows)
    pull_links(flat)
    own = own_at(flat.forces)
    if flat.forces:
        call_own(own.evaluate, own, flat)
    move(wide, rows)
    if flat.forces:
        call_own(own.follow, own, flat)
    separate(board, n)
    order_basal(board, n)
    if board.bent:
        lay(wide, rows)


def _alone(flat: int, wide: int, n: int) -> int:
    """All substeps of one dt for a tissue of n cells, whose board has these addresses; 0."""
    board, in_rows, rows = board_at(flat), wide_board_at(wide), (n + WIDTH - 1) // WIDTH
    for word in range(2):
        for lane in range(WIDTH):
            in_rows.noise_key[word, lane] = board.noise_key[word]
    for number in range(board.substeps):
        shaken(in_rows, rows, number)
        push_in_rows(board, n, in_rows, rows)
        make_substep(board, n, in_rows, rows, board)
    return 0


def _abreast(flat: int, wide: int, n: int) -> int:
    """The same for eight tissues of up to n cells."""
    board = wide_board_at(wide)
    for number in range(board.substeps):
        shaken(board, n, number)
        push_in_pairs(board, n)
        make_substep(board, n, board, n, board_at(flat))
    return 0


# By width, for the life of the process; threads come one at a time.
_COMPILED: dict[int, Any] = {}
_COMPILING = Lock()


def substeps_address(width: int) -> int:
    """The machine code of all substeps of one dt for so many tissues, compiled on first use."""
    with _COMPILING:
        if width not in _COMPILED:
            _COMPILED[width] = c_function(_SIGNATURE, _alone if width == 1 else _abreast)
    address: int = _COMPILED[width].address
    return address
