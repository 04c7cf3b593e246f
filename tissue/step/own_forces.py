"""Forces of users in a substep: evaluated before the others move the points, followed after them.

So a substep is explicit Euler of the sum, Z - (h / mu) grad (W + W_own)(Z). Both parts are called by their addresses:
a run without such forces neither compiles nor contains them. They go tissue by tissue, in numbers, not in lanes: the
bits are the same alone and in company.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from dincl.compiled import call, inner, reader, signature, struct_type
from tissue.kernels.board import FLAT, Board
from tissue.kernels.numbers import NUMBERS, numbers_at
from tissue.state.cells import Floats, Forces, Integers
from tissue.state.store import CELLS, STORE, Store, store_at
from tissue.step.copies import put_back


class OwnForces(NamedTuple):
    """What those that act on tissues side by side are."""

    push: Integers  # (forces,): where their machine code is, in the order of their names
    strength: Floats  # (forces,)
    stores: Integers  # (1,) or (WIDTH,): where the tissues are
    numbers: int  # where the numbers of the run are
    scale: float  # h / mu
    evaluate: int  # the machine code of the functions below
    follow: int


_EXAMPLE = OwnForces(np.zeros(1, np.int64), np.zeros(1), np.zeros(1, np.int64), 0, 0.0, 0, 0)
OWN = struct_type(_EXAMPLE)
own_at = reader(_EXAMPLE)
# push(store, on, strength, numbers) and energy(store, strength, numbers) of a force; a part of a substep.
PUSH: Any = signature(None, STORE, struct_type(Forces(*np.zeros((6, 1)))), float, NUMBERS)
ENERGY: Any = signature(float, STORE, float, NUMBERS)
PART: Any = signature(None, OWN, FLAT)
# Calls of these functions by their addresses, with the arguments above.
call_push, call_energy, call_own = call(PUSH), call(ENERGY), call(PART)


@inner
def clear(store: Store) -> None:
    """No force on any point."""
    on = store.on
    for forces in (on.x, on.y, on.ax, on.ay, on.bx, on.by):
        for i in range(store.sizes[CELLS]):
            forces[i] = 0.0


def evaluate(own: OwnForces, board: Board) -> None:
    """The sum of the forces where the points of each tissue on the board, seen flat, are now: ``Store.on``."""
    for k in range(len(board.cells)):
        if board.cells[k] > 0:
            store = store_at(own.stores[k])
            put_back(board, store, k)
            clear(store)
            for number in range(len(own.push)):
                call_push(own.push[number], store, store.on, own.strength[number], numbers_at(own.numbers))


def follow(own: OwnForces, board: Board) -> None:
    """Move the points of each tissue by (h / mu) times these forces, a basal point as the others do, see ``move``."""
    width, scale = len(board.cells), own.scale
    for k in range(width):
        on = store_at(own.stores[k]).on
        for points, force in ((board.x, on.x), (board.y, on.y), (board.ax, on.ax), (board.ay, on.ay)):
            for i in range(board.cells[k]):
                points[width * i + k] += scale * force[i]
        if board.bent:
            for i in range(board.cells[k]):
                place = width * i + k
                along = scale * on.bx[i] * board.tangent_x[place] + scale * on.by[i] * board.tangent_y[place]
                board.along[place] += board.in_basal[place] * along
        for points, force, moves in ((board.bx, on.bx, board.bx_moves), (board.by, on.by, board.by_moves)):
            for i in range(board.cells[k]):
                points[width * i + k] += moves[width * i + k] * (scale * force[i])
