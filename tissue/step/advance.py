"""Many steps dt of the first-order model in one call, without the interpreter (Method 3.7)."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.random import Generator

from dincl.compiled import call, inner, signature, struct_type
from tissue.kernels import kernel
from tissue.kernels.generators import GENERATOR, generator_at
from tissue.kernels.rules import Rules, call_substeps, rules_at
from tissue.kernels.surface_workspace import surface_workspace_at
from tissue.kernels.workspace import LOST, RUNNING, workspace_at
from tissue.model.cycle import adapt_rest_lengths, count_due, divide, set_phases
from tissue.model.emt import begin_events
from tissue.model.extents import is_closed
from tissue.model.noise import WORD_VALUES, add_noise
from tissue.model.scale import watch_sides
from tissue.network.neighbours import has_room
from tissue.state.cells import Floats, Integers
from tissue.state.numbers import Numbers, numbers_at
from tissue.state.running import ANY, APICAL, BASAL, CELLS, ON_LINE, Kind, TissueState, state_at
from tissue.state.space import FLAT, SPATIAL
from tissue.step.copies import copy_from_workspace, copy_in, copy_out, copy_to_workspace

# How a call ended: all steps made; no room for the daughters that may come; after the rules of a step in which more
# than this part of a layer in space has left it, so that its neighbours are to be found anew before cells move.
DONE, FULL, LEFT = range(3)
MANY = 1 / 20


class StepInput(NamedTuple):
    """Input of steps dt of tissues side by side: addresses of the tissues, of numbers, memory and machine code.

    dt and the number of substeps are the same for all of them, see ``tissue.runs.group``.
    """

    states: Integers  # (1,) or (WIDTH,)
    ended: Integers  # of each RUNNING, or the step that failed
    random: Integers  # (2, k, GENERATOR): the generators of draws and of noise
    numbers: Integers  # of each tissue
    rules: int
    flat: int  # the workspace seen flat, and as substeps see it
    wide: int
    substeps: int  # all substeps of one dt
    move: int  # that, with what comes before and after: ``move_slices`` or ``move_surface``
    scale: Floats  # h / mu of each tissue


_LINE = np.zeros(1, np.int64)
_EXAMPLE = StepInput(_LINE, _LINE, np.zeros((2, 1, GENERATOR), np.int64), _LINE, 0, 0, 0, 0, 0, np.zeros(1))
STEP = struct_type(_EXAMPLE)
# move(step): the largest number of cells of the tissues that run.
MOVE: Any = signature(int, STEP)
call_move = call(MOVE)


@kernel
def advance(step: StepInput, made: int, steps: int, ruled: bool, kind: Kind) -> tuple[int, int]:
    """Make the steps ``made`` to ``steps``, the k-th to t = (k + 1) dt; how many are made then, and how the call ended.

    A tissue that is lost, or whose lumen is closed, stays as it is from then on: ``ended`` is set to the step that
    failed. After FULL nothing is lost: put the cells into larger states and go on. After LEFT renew the networks and
    go on with ``ruled``: the rules of the next step have been applied. ``kind``: of the tissues.
    """
    rules, states, ended, dt = rules_at(step.rules), step.states, step.ended, numbers_at(step.numbers[0]).dt
    while made < steps:
        t = (made + 1) * dt
        for k in range(len(states)):
            if ended[k] == RUNNING and not ruled and is_full(state_at(states[k]), t):
                return made, FULL
        for k in range(len(states)):
            if ended[k] == RUNNING and not ruled:
                state, draws, noise = (
                    state_at(states[k]),
                    generator_at(step.random[0], k),
                    generator_at(step.random[1], k),
                )
                outside = count_outside(state)
                _apply_rules(state, t, numbers_at(step.numbers[k]), rules, draws, noise, kind)
                if state.space.dimension != FLAT and count_outside(state) - outside > MANY * state.sizes[CELLS]:
                    return made, LEFT
        ruled = False
        if not call_move(step.move, step):  # nobody runs any more
            return steps, DONE
        for k in range(len(states)):
            if ended[k] == RUNNING:
                state = state_at(states[k])
                if find_lost(state) >= 0 or (len(kind) != ON_LINE and is_closed(state)):
                    ended[k] = made + 1
                else:
                    watch_sides(state, t, kind)
        made += 1
    return made, DONE


@kernel
def move_all(step: StepInput) -> int:
    """Make all substeps of one dt, without the rules: the largest number of cells of the tissues that run."""
    cells: int = call_move(step.move, step)
    return cells


def move_slices(step: StepInput) -> int:
    """Copy slices to their workspace, make all substeps of one dt, and copy them back; the largest number of cells."""
    flat = workspace_at(step.flat)
    n = copy_in(step.states, step.ended, flat, step.numbers, step.scale)
    if n > 0:
        call_substeps(step.substeps, step.flat, step.wide, n)
        copy_out(flat, step.states)
    return int(n)


def move_surface(step: StepInput) -> int:
    """Make all substeps of one dt for a sheet or a closed surface."""
    if step.ended[0] != RUNNING:
        return 0
    state, work = state_at(step.states[0]), surface_workspace_at(step.flat)
    n = copy_to_workspace(state, work, numbers_at(step.numbers[0]), step.scale[0])
    call_substeps(step.substeps, step.flat, step.wide, n)
    copy_from_workspace(work, state)
    return int(n)


@inner
def count_outside(state: TissueState) -> int:
    """Count the cells that are in no apical layer, and those in no basal one."""
    sizes = state.sizes
    return int(2 * sizes[CELLS] - sizes[APICAL] - sizes[BASAL])


@kernel
def is_full(state: TissueState, t: float) -> bool:
    """Return whether the daughters that may come at time t have no room, nor their neighbours in space."""
    due, space = count_due(state, t), state.space
    full: bool = state.sizes[CELLS] + due > len(state.cells.x)
    if space.dimension == SPATIAL:
        full = full or not (has_room(space.apical, due) and has_room(space.basal, due))
    return full


@kernel
def apply_rules(
    state: TissueState, t: float, numbers: Numbers, rules: Rules, draws: Generator, noise: Generator
) -> None:
    """Apply what happens once per dt before cells move."""
    _apply_rules(state, t, numbers, rules, draws, noise, ANY)


@inner
def _apply_rules(
    state: TissueState, t: float, numbers: Numbers, rules: Rules, draws: Generator, noise: Generator, kind: Kind
) -> None:
    """Apply what happens once per dt before cells move: divisions, events, phases, rest lengths, noise or its key."""
    state.clock[0] = t
    divide(state, t, numbers, rules, draws)
    begin_events(state, t, numbers, rules, kind)
    set_phases(state, t, numbers)
    adapt_rest_lengths(state, t, numbers, rules)
    if numbers.noise_in_substeps:
        for word in range(2):
            state.noise_key[word] = int(WORD_VALUES * noise.random())
    else:
        add_noise(state, numbers.variance * numbers.dt, noise)


@kernel
def find_lost(state: TissueState) -> int:
    """Return the first cell whose coordinates add up to LOST in magnitude, or are not numbers; -1 if there is none."""
    cells = state.cells
    for i in range(state.sizes[CELLS]):
        nucleus, apical = abs(cells.x[i]) + abs(cells.y[i]), abs(cells.ax[i]) + abs(cells.ay[i])
        basal, deep = abs(cells.bx[i]) + abs(cells.by[i]), abs(cells.z[i]) + abs(cells.az[i]) + abs(cells.bz[i])
        if not nucleus + apical + basal + deep < LOST:  # nor if it is NaN
            return i
    return -1
