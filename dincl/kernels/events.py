"""From event to event: a run of the event-driven method, in pieces that fill the room there is."""

import numpy as np

from dincl.compiled import inner, kernel
from dincl.kernels.arrays import Floats, Offsets
from dincl.kernels.choice import choose
from dincl.kernels.factor import times
from dincl.kernels.jumps import AGAIN, MOST_JUMPS, look_for_jump, pass_stop
from dincl.kernels.march import march_at
from dincl.kernels.motion import at, correct, error_of, interpolate, least_speed, move, stage
from dincl.kernels.signals import NEVER
from dincl.kernels.system import OK, SETS, bounded, longest, system_at
from dincl.kernels.table import GRADIENTS, SPEEDS, ask, gap, linearise
from dincl.kernels.watch import first_event

# How a call ends besides the codes of ``system``: the time is reached; the room is full, so that it is to be called
# again; too many changes at one time; no step is short enough; too many steps are needed; the drift jumps too often.
DONE, FULL, STUCK, NO_STEP, SLOW, JUMPS = 20, 21, 22, 23, 24, 25
# Of the step that the error allows, taken; the least and the most that a step changes from one to the next.
SAFETY, LEAST, MOST = 0.9, 0.2, 10.0
# The root of 2, at most the length of a gradient.
PAIR = 1.4142135623730951
# Changes of the contacts at one time.
MOST_AT_ONCE = 100
# Steps of a run: a hundred discs with 300 events take about a thousand. After this many it is asked how many it needs.
MOST_STEPS, LOOK = 100_000, 5_000
# An event before a jump by no more than this part of the run is at the jump.
MEETS = 1e-12
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
            state.error = error
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
        path.held[p, k], least = march.held.row[k], 0.0
        for i in range(march.pair.stages):
            # At its end a step may be at a jump already.
            if march.pair.c[i] < 1.0:
                least = min(least, march.push[i, k])
        state.doubt -= PAIR * h * least
        march.push[0, k] = march.push[march.pair.stages, k]
    for k in range(march.x.size):
        path.x[p, k] = march.x[k]
        for j in range(7):
            path.dense[p, j, k] = march.dense[j, k]
        march.x[k] = march.after[k]
        march.rate[0, k] = march.rate[march.pair.stages, k]
    state.pieces += 1
    state.now, state.usual = t, h


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


@inner
def decide(run: int) -> int:
    """Decide the contacts, and begin a phase with them."""
    march = march_at(run)
    state, system = march.state[0], system_at(march.place)
    # What started small and went far rounds as what is large.
    state.size = max(state.size, longest(march.x, system.sets.shift.shape[1]))
    code = OK
    if state.stop < state.end and state.stop - state.now <= MEETS * state.end:
        code = pass_stop(run)
    if code == OK:
        code = choose(run)
    if code == OK:
        code = begin_phase(run)
    if code == OK:
        code = correct(run, state.now, march.x)
    return code if code != OK else move(run, state.now, march.x, march.rate[0], march.push[0])


@inner
def is_slow(run: int) -> bool:
    """Whether the run is not to end within the steps that it may have, as its last ones tell."""
    state = march_at(run).state[0]
    made = state.steps - state.marked
    if made < LOOK:
        return False
    needed = (state.end - state.now) / (state.now - state.mark) * made if state.now > state.mark else np.inf
    state.marked, state.mark = state.steps, state.now
    return bool(state.steps + needed > MOST_STEPS)


@inner
def go_on(run: int) -> int:
    """Make a step, to the next event at most: OK, DONE or a failure."""
    march = march_at(run)
    state, sets = march.state[0], system_at(march.place).sets
    left = state.stop - state.now
    if not left > 0.0:
        return DONE
    code, h = make_step(run, min(state.longest, left))
    if code == OK:
        code = look_for_jump(run, h)
    if code != OK:
        return OK if code == AGAIN else code
    part, closing = first_event(run)
    if state.code != OK or sets.ask[1] != 0.0:
        return int(state.code) if state.code != OK else SETS
    if part < NEVER:
        code = arrive(run, state.now + part * h, closing)
    elif h < left:
        take(run, h, state.now + h)
    else:
        take(run, h, state.stop)
        code = pass_stop(run) if state.stop < state.end else OK
    return code if code != OK or bounded(march.x, state.most) else NO_STEP


@kernel
def march_on(run: int, most: int) -> int:
    """Go on until the end, until the room for the path is full, or ``most`` steps: DONE, FULL or a failure."""
    march = march_at(run)
    state, path = march.state[0], march.path
    for _ in range(most):
        code = decide(run) if state.choose != 0 else OK
        if code == OK:
            code = go_on(run)
        if code != OK:
            return code
        if state.jumps > MOST_JUMPS:
            return JUMPS
        if is_slow(run):
            return SLOW
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


@kernel
def overlaps_at(run: int, t: Floats, x: Floats, overlap: Floats) -> None:
    """Write how far the states x (K, n) at times t are outside of the set into ``overlap`` (K,) [length]."""
    march = march_at(run)
    system = system_at(march.place)
    for q in range(t.size):
        overlap[q] = 0.0
        ask(system.sets, t[q], x[q], GRADIENTS)
        for r in range(system.rows.row.size):
            overlap[q] = max(overlap[q], -gap(system.rows, system.sets, r, x[q]))
