"""One dt in space: all substeps are made, networks follow the points, cells exchange neighbours."""

from __future__ import annotations

from typing import Any, NamedTuple

from dincl.compiled import c_function, reader, signature, struct_type
from tissue.kernels.numbers import numbers_at
from tissue.kernels.rules import call_substeps
from tissue.network.exchange import relax
from tissue.network.follow import STUCK, follow
from tissue.state.store import store_at
from tissue.step.space_board import space_board_at
from tissue.step.space_copies import copy_from_board, copy_to_board

_SIGNATURE: Any = signature(int, int, int, int)


class SpaceDesk(NamedTuple):
    """What one dt in space takes besides the tissue."""

    flat: int  # where the board is, in single numbers and in rows
    wide: int
    numbers: int  # where the numbers are
    substeps: int  # where their machine code is
    scale: float  # h / mu


_EXAMPLE = SpaceDesk(0, 0, 0, 0, 0.0)
DESK = struct_type(_EXAMPLE)
desk_at = reader(_EXAMPLE)


def step_in_space(at: int, tissue: int, _: int) -> int:
    """All substeps of one dt for the tissue at an address, with the desk at another; how many cells it has.

    ``torn`` of the tissue is set if a network cannot follow its points.
    """
    desk, store = desk_at(at), store_at(tissue)
    board = space_board_at(desk.flat)
    numbers = numbers_at(desk.numbers)
    n = copy_to_board(store, board, numbers, desk.scale)
    call_substeps(desk.substeps, desk.flat, desk.wide, n)
    copy_from_board(board, store)
    cells, space, how = store.cells, store.space, store.space.exchange
    done = follow(space.surface, space.apical, cells.ax, cells.ay, cells.az, how.new_rest)
    if done != STUCK:
        relax(space.surface, space.apical, cells.ax, cells.ay, cells.az, how.margin, how.reach, how.new_rest)
        done = follow(space.surface, space.basal, cells.bx, cells.by, cells.bz, how.new_rest)
    if done != STUCK:
        relax(space.surface, space.basal, cells.bx, cells.by, cells.bz, how.margin, how.reach, how.new_rest)
    space.torn[0] = done == STUCK
    return int(n)


_COMPILED: list[Any] = []


def step_address() -> int:
    """The machine code of ``step_in_space``, compiled on first use."""
    if not _COMPILED:
        _COMPILED.append(c_function(_SIGNATURE, step_in_space))
    address: int = _COMPILED[0].address
    return address
