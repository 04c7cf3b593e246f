"""Forces of users in a substep: evaluated before the others move the points, followed after them.

So a substep is explicit Euler of the sum, Z - (h / mu) grad (W + W_own)(Z). Both parts are called by their addresses:
a run without such forces neither compiles nor contains them. They go tissue by tissue, in numbers, not in lanes: the
bits are the same alone and in company.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from dincl.compiled import call, inner, reader, signature, struct_type
from tissue.kernels.lanes import load, store
from tissue.kernels.surface_workspace import SURFACE_WORKSPACE
from tissue.kernels.workspace import WORKSPACE
from tissue.model.motion import tangential
from tissue.state.cells import Floats, Integers, PointForces
from tissue.state.numbers import NUMBERS, numbers_at
from tissue.state.running import CELLS, STATE, TissueState, state_at
from tissue.step.advance import find_lost
from tissue.step.copies import put_back


class UserForces(NamedTuple):
    """Forces of users that act on tissues side by side."""

    push: Integers  # (forces,): where their machine code is, in the order of their names
    strength: Floats  # (forces, tissues)
    states: Integers  # (1,) or (WIDTH,): where the tissues are
    numbers: Integers  # likewise the numbers of each
    scale: Floats  # h / mu of each
    blame: Integers  # (2, tissues): 1 + the first force that was not finite, and the id of the cell; 0: none was
    evaluate: int  # the machine code of the functions below
    follow: int


_LINE = np.zeros(1, np.int64)
_EXAMPLE = UserForces(_LINE, np.zeros((1, 1)), _LINE, _LINE, np.zeros(1), np.zeros((2, 1), np.int64), 0, 0)
USER_FORCES = struct_type(_EXAMPLE)
user_forces_at = reader(_EXAMPLE)
# push(state, on, strength, numbers) and energy(state, strength, numbers) of a force; parts of a substep.
PUSH: Any = signature(None, STATE, struct_type(PointForces(*np.zeros((9, 1)))), float, NUMBERS)
ENERGY: Any = signature(float, STATE, float, NUMBERS)
PART: Any = signature(None, USER_FORCES, WORKSPACE)
PART_IN_SPACE: Any = signature(None, USER_FORCES, SURFACE_WORKSPACE)
# Calls of these functions by their addresses, with the arguments above.
call_push, call_energy, call_part, call_part_in_space = map(call, (PUSH, ENERGY, PART, PART_IN_SPACE))


@inner
def clear(state: TissueState) -> None:
    """Set the forces on all points to 0."""
    on = state.on
    for forces in (on.x, on.y, on.ax, on.ay, on.bx, on.by, on.z, on.az, on.bz):
        for i in range(state.sizes[CELLS]):
            forces[i] = 0.0


@inner
def find_not_finite(state: TissueState) -> int:
    """Return a cell on which the forces are not finite, -1 if there is none."""
    on = state.on
    for i in range(state.sizes[CELLS]):
        total = on.x[i] + on.y[i] + on.ax[i] + on.ay[i] + on.bx[i] + on.by[i] + on.z[i] + on.az[i] + on.bz[i]
        if not math.isfinite(total):
            return i
    return -1


@inner
def add_forces(own: UserForces, state: TissueState, k: int) -> None:
    """Sum the forces on tissue k where its points are now; note the first one that is not finite where they are."""
    clear(state)
    for number in range(len(own.push)):
        call_push(own.push[number], state, state.on, own.strength[number, k], numbers_at(own.numbers[k]))
    if own.blame[0, k] == 0 and find_not_finite(state) >= 0 and find_lost(state) < 0:
        clear(state)  # once more, looking
        for number in range(len(own.push)):
            call_push(own.push[number], state, state.on, own.strength[number, k], numbers_at(own.numbers[k]))
            i = find_not_finite(state)
            if i >= 0 and own.blame[0, k] == 0:
                own.blame[0, k], own.blame[1, k] = 1 + number, state.cells.id[i]


def evaluate_forces(own: UserForces, work: Any) -> None:
    """The sum of the forces where the points of each tissue in the workspace, seen flat, are now:
    ``TissueState.on``.
    """
    for k in range(len(work.cells)):
        if work.cells[k] > 0:
            state = state_at(own.states[k])
            put_back(work, state, k, len(work.cells))
            add_forces(own, state, k)


def follow_forces(own: UserForces, work: Any) -> None:
    """Move the points of each tissue by (h / mu) times these forces, a basal point as the others do, see ``move``."""
    width = len(work.cells)
    for k in range(width):
        scale, state = own.scale[k], state_at(own.states[k])
        on, cells = state.on, state.cells
        for i in range(work.cells[k]):
            place = width * i + k
            moves, held = work.moves[place], work.held[place]
            for points, force in ((work.x, on.x), (work.y, on.y), (work.ax, on.ax), (work.ay, on.ay)):
                points[place] += scale * force[i]
            store(work.z, place, load(work.z, place) + scale * on.z[i])
            store(work.az, place, load(work.az, place) + scale * on.az[i])
            basal = scale * on.bx[i], scale * on.by[i], scale * on.bz[i]
            if work.bent:
                along = basal[0] * load(work.tangent_x, place) + basal[1] * load(work.tangent_y, place)
                store(work.along, place, load(work.along, place) + held * along)
            basal = tangential(work, held, (cells.bx[i], cells.by[i], cells.bz[i]), basal)
            work.bx[place] += moves * basal[0]
            work.by[place] += moves * basal[1]
            store(work.bz, place, load(work.bz, place) + moves * basal[2])
