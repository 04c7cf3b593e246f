"""From event to event: a run of the event-driven method, in pieces that fill the room there is."""

import numpy as np

from dincl.compile import inner, kernel
from dincl.kernels.arrays import Floats, Offsets
from dincl.kernels.choice import choose
from dincl.kernels.factor import times
from dincl.kernels.march import march_at
from dincl.kernels.motion import at, correct, error_of, interpolate, least_speed, move, stage
from dincl.kernels.signals import NEVER
from dincl.kernels.system import OK, SETS, bounded, longest, system_at
from dincl.kernels.table import SPEEDS, ask, linearise
from dincl.kernels.watch import first_event

# How a call ends besides the codes of ``system``: the time is reached; the room is full, so that it is to be called
# again; too many changes at one time; no step is short enough.
DONE, FULL, STUCK, NO_STEP = 20, 21, 22, 23
# Of the step that the error allows, taken; the least and the most that a step changes from one to the next.
SAFETY, LEAST, MOST = 0.9, 0.2, 10.0
# Changes of the contacts at one time.
MOST_AT_ONCE = 100
# Pieces for which there is room at the beginning of a step: on the way to an event.
ROOM = 32


@inner
def make_step(run: int, limit: float) -> tuple[int, float]:
    """A step from ``x`` that meets the tolerance, no longer than ``limit``, and its dense output.

    How it ended, and its length.
    """
    march = march_at(run)
    state, pair = march.state[0], march.pair
    h, exponent, most, i = min(state.h, limit), -1.0 / (pair.order + 1.0), MOST, 1
    shortened = h < state.h
    while i < pair.stages + 1 + pair.more:
        if not state.now + h > state.now:
            return NO_STEP, h
        code = stage(run, h, i)
        if code != OK:
            return code, h
        i += 1
        if i == pair.stages + 1:
            error = error_of(run, h)
            change = min(most, max(LEAST, SAFETY * error**exponent)) if error > 0.0 else most
            if error < 1.0:
                # A step that was cut short, and could have been longer still, says nothing of how long.
                state.h = max(state.h, h * change) if shortened and change == MOST else h * change
            else:
                h, most, shortened, i = h * (change if error < np.inf else LEAST), 1.0, False, 1
    state.steps += 1
    interpolate(run, h)
    return OK, h


@inner
def take(run: int, h: float, t: float) -> None:
    """Add the step, with its dense output, to the path, and go on from its end at t."""
    march = march_at(run)
    state, path = march.state[0], march.path
    p = state.pieces
    path.end[p], path.start[p], path.length[p], path.number[p] = t, state.now, h, march.held.number[0]
    for k in range(march.held.number[0]):
        path.held[p, k] = march.held.row[k]
        march.push[0, k] = march.push[march.pair.stages, k]
    for k in range(march.x.size):
        path.x[p, k] = march.x[k]
        for j in range(7):
            path.dense[p, j, k] = march.dense[j, k]
        march.x[k] = march.after[k]
        march.rate[0, k] = march.rate[march.pair.stages, k]
    state.pieces += 1
    state.now = t


@inner
def arrive(run: int, t: float, closing: int) -> int:
    """Steps to the event at t, and for a gap the way that is left, as short as the dense output is accurate."""
    march = march_at(run)
    state, first = march.state[0], march.state[0].pieces
    part = (t - state.now) / state.parts
    while state.now < t:
        code, h = make_step(run, min(part, t - state.now))
        if code != OK or state.pieces == march.path.end.size:
            return code if code != OK else STUCK
        take(run, h, t if h >= t - state.now else state.now + h)
    if closing >= 0:
        before = march.path.start[first] if state.pieces > first else state.now
        wait = max(wait_for(run, closing), before - state.now)
        for k in range(march.x.size):
            march.x[k] += wait * march.rate[0, k]
        state.now += wait
        if state.pieces > first:
            march.path.end[state.pieces - 1] = state.now
    state.choose = 1
    return correct(run, state.now, march.x)


@inner
def wait_for(run: int, closing: int) -> float:
    """How long until this gap closes, by one Newton step; 0 if it does not close."""
    march = march_at(run)
    system = system_at(march.place)
    ask(system.sets, march.state[0].now, march.x, SPEEDS)
    gap = linearise(system.rows, system.sets, closing, march.x, system.program.gradient)
    speed = times(system.rows, closing, system.program.gradient, march.rate[0]) - least_speed(system, closing)
    return -gap / speed if speed < 0.0 else 0.0


@inner
def begin_phase(run: int) -> int:
    """Count the phase that begins once the contacts are decided; its longest step, and the first one of a run."""
    march = march_at(run)
    state = march.state[0]
    state.at_once = state.at_once + 1 if state.phase > 0 and state.now == state.chosen_at else 0
    state.chosen_at, state.choose = state.now, 0
    state.phase += 1
    state.longest = (state.end - state.now) / state.parts
    if state.at_once > MOST_AT_ONCE:
        return STUCK
    if state.h == 0.0:
        reach = state.size * min(1.0, state.tol / state.size) ** (1.0 / (march.pair.order + 1.0))
        state.h = min(state.longest, 0.1 * reach / state.speed if state.speed > 0.0 else state.longest)
    return OK


@kernel
def march_on(run: int, most: int) -> int:
    """Go on until the end, until the room for the path is full, or ``most`` steps: DONE, FULL or a failure."""
    march = march_at(run)
    state, path, sets = march.state[0], march.path, system_at(march.place).sets
    for _ in range(most):
        if state.choose != 0:
            # What started small and went far rounds as what is large.
            state.size = max(state.size, longest(march.x, sets.shift.shape[1]))
            code = choose(run)
            if code == OK:
                code = begin_phase(run)
            if code == OK:
                code = move(run, state.now, march.x, march.rate[0], march.push[0])
            if code != OK:
                return code
        left = state.end - state.now
        if not left > 0.0:
            return DONE
        code, h = make_step(run, min(state.longest, left))
        if code != OK:
            return code
        part, closing = first_event(run)
        if state.code != OK or sets.ask[1] != 0.0:
            return int(state.code) if state.code != OK else SETS
        if part == NEVER:
            take(run, h, state.end if h >= left else state.now + h)
        else:
            code = arrive(run, state.now + part * h, closing)
        if code != OK or not bounded(march.x):
            return code if code != OK else NO_STEP
        if state.pieces > path.end.size - ROOM or state.events > path.event.shape[0] - march.closed.size:
            return FULL
    return FULL


@inner
def hold(run: int, p: int) -> None:
    """Hold the rows of piece p."""
    march = march_at(run)
    march.held.number[0] = march.path.number[p]
    for k in range(march.held.number[0]):
        march.held.row[k] = march.path.held[p, k]


@kernel
def states_at(run: int, t: Floats, piece: Offsets, x: Floats) -> int:
    """Write the states at times t that lie in these pieces into x (K, n): the dense output, put onto the contacts."""
    march = march_at(run)
    path = march.path
    for q in range(t.size):
        p = piece[q]
        hold(run, p)
        part = (t[q] - path.start[p]) / path.length[p]
        for k in range(march.x.size):
            march.point[k] = at(path.dense[p], march.pair.terms, path.x[p, k], k, part)[0]
        code = correct(run, t[q], march.point)
        if code != OK:
            return code
        for k in range(march.x.size):
            x[q, k] = march.point[k]
    return OK


@kernel
def rate_at(run: int, t: float, p: int, x: Floats, rate: Floats) -> int:
    """Write x' at a state of piece p into ``rate``."""
    march = march_at(run)
    hold(run, p)
    return move(run, t, x, rate, march.push[16])
