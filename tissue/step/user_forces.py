"""Forces of users in a substep: evaluated before the others move the points, followed after them.

So a substep is explicit Euler of the sum, Z - (h / mu) grad (W + W_own)(Z). Both parts are called by their addresses:
a run without such forces neither compiles nor contains them. They go tissue by tissue, in numbers, not in lanes: the
bits are the same alone and in company.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from dincl.compiled import call, inner, reader, signature, struct_type
from tissue.kernels.workspace import WORKSPACE, Workspace
from tissue.state.cells import Floats, Forces, Integers
from tissue.state.numbers import NUMBERS, numbers_at
from tissue.state.running import CELLS, STATE, TissueState, state_at
from tissue.step.copies import put_back


class UserForces(NamedTuple):
    """Forces of users that act on tissues side by side."""

    push: Integers  # (forces,): where their machine code is, in the order of their names
    strength: Floats  # (forces, tissues)
    states: Integers  # (1,) or (WIDTH,): where the tissues are
    numbers: Integers  # likewise the numbers of each
    scale: Floats  # h / mu of each
    evaluate: int  # the machine code of the functions below
    follow: int


_LINE = np.zeros(1, np.int64)
_EXAMPLE = UserForces(_LINE, np.zeros((1, 1)), _LINE, _LINE, np.zeros(1), 0, 0)
USER_FORCES = struct_type(_EXAMPLE)
user_forces_at = reader(_EXAMPLE)
# push(state, on, strength, numbers) and energy(state, strength, numbers) of a force; a part of a substep.
PUSH: Any = signature(None, STATE, struct_type(Forces(*np.zeros((6, 1)))), float, NUMBERS)
ENERGY: Any = signature(float, STATE, float, NUMBERS)
PART: Any = signature(None, USER_FORCES, WORKSPACE)
# Calls of these functions by their addresses, with the arguments above.
call_push, call_energy, call_part = call(PUSH), call(ENERGY), call(PART)


@inner
def clear(state: TissueState) -> None:
    """Set the forces on all points to 0."""
    on = state.on
    for forces in (on.x, on.y, on.ax, on.ay, on.bx, on.by):
        for i in range(state.sizes[CELLS]):
            forces[i] = 0.0


def evaluate_forces(own: UserForces, work: Workspace) -> None:
    """The sum of the forces where the points of each tissue in the workspace, seen flat, are now:
    ``TissueState.on``.
    """
    for k in range(len(work.cells)):
        if work.cells[k] > 0:
            state = state_at(own.states[k])
            put_back(work, state, k)
            clear(state)
            for number in range(len(own.push)):
                call_push(own.push[number], state, state.on, own.strength[number, k], numbers_at(own.numbers[k]))


def follow_forces(own: UserForces, work: Workspace) -> None:
    """Move the points of each tissue by (h / mu) times these forces, a basal point as the others do, see ``move``."""
    width = len(work.cells)
    for k in range(width):
        scale, on = own.scale[k], state_at(own.states[k]).on
        for points, force in ((work.x, on.x), (work.y, on.y), (work.ax, on.ax), (work.ay, on.ay)):
            for i in range(work.cells[k]):
                points[width * i + k] += scale * force[i]
        if work.bent:
            for i in range(work.cells[k]):
                place = width * i + k
                along = scale * on.bx[i] * work.tangent_x[place] + scale * on.by[i] * work.tangent_y[place]
                work.along[place] += work.held[place] * along
        for i in range(work.cells[k]):
            place = width * i + k
            moves = work.moves[place]
            work.bx[place] += moves * (scale * on.bx[i])
            work.by[place] += moves * (1.0 - work.held[place]) * (scale * on.by[i])
