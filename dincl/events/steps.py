"""Steps of a run from event to event, and the way to an event."""

import numpy as np

from dincl.compiled import inner
from dincl.events.arrays import march_at
from dincl.events.motion import correct, dense_state, error_of, interpolate, least_speed, move, stage
from dincl.rows.table import VELOCITIES, call_python, gap, linearise
from dincl.solvers.factor import times
from dincl.system.arrays import OK, system_at

# How a run ends besides the codes of ``system``: no step is short enough; too many changes of the contacts at one time.
NO_STEP, STUCK = 23, 22
# Of the step that the error allows, taken; the least and the most that a step changes from one to the next.
SAFETY, LEAST, MOST = 0.9, 0.2, 10.0
# The root of 2, at most the length of a gradient.
PAIR = 1.4142135623730951
# A dense output tells the state at an event if the estimated error of its step is below this part of the tolerance.
# Then 200 discs state an error of 1e-9; with 0.1 it is 1e-8.
ACCURATE = 1e-2
# Newton steps to the time at which a gap closes, where the dense output tells the way to it; and what may be left of
# the gap, relative to the size of the problem.
MOST_WAITS, CLOSED_GAP = 4, 1e-14


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
    note_piece(run, h, t)
    for k in range(march.held.number[0]):
        march.push[0, k] = march.push[march.pair.stages, k]
    for k in range(march.x.size):
        march.x[k] = march.after[k]
        march.rate[0, k] = march.rate[march.pair.stages, k]
    march.state[0].now, march.state[0].usual = t, h


@inner
def note_piece(run: int, h: float, t: float) -> None:
    """Add the step of length h to the path, up to t."""
    march = march_at(run)
    state, path, terms, dense = march.state[0], march.path, march.pair.terms, march.dense
    p, part = state.pieces, (t - state.now) / h
    path.end[p], path.start[p], path.length[p], path.number[p] = t, state.now, h, march.held.number[0]
    for k in range(march.held.number[0]):
        path.held[p, k], least = march.held.row[k], 0.0
        for i in range(march.pair.stages):
            # At its end a step may be at a jump already.
            if march.pair.c[i] < min(part, 1.0):
                least = min(least, march.push[i, k])
        state.doubt -= PAIR * h * least
    kept, written, x = path.x, path.dense, march.x
    for k in range(x.size):
        kept[p, k] = x[k]
        for j in range(terms):
            written[p, j, k] = dense[j, k]
    state.pieces += 1


@inner
def cut(run: int, h: float, t: float) -> int:
    """Let the step end at t by its dense output."""
    march = march_at(run)
    state = march.state[0]
    dense_state(run, (t - state.now) / h)
    note_piece(run, h, t)
    for k in range(march.x.size):
        march.x[k], march.rate[0, k] = march.point[k], march.rate[16, k] / h
    state.now, state.usual = t, h
    return correct(run, t, march.x)


@inner
def arrive(run: int, h: float, t: float, closing: int) -> int:
    """Go to the event at t, and for a gap the way that is left, as short as the dense output is accurate.

    Where the dense output of the step of length h is accurate it tells the state at the event; else steps are made
    anew.
    """
    march = march_at(run)
    state, first = march.state[0], march.state[0].pieces
    part, before, code = (t - state.now) / state.parts, state.now, OK
    if state.cuts != 0 and state.error < ACCURATE and t > state.now:
        code = cut(run, h, t if state.parts == 1 else state.now + part)
        if code == OK and state.parts > 1:
            code = move(run, state.now, march.x, march.rate[0], march.push[0])
    while code == OK and state.now < t:
        code, h = make_step(run, min(part, t - state.now))
        if code == OK and state.pieces == march.path.end.size:
            code = STUCK
        if code == OK:
            take(run, h, t if h >= t - state.now else state.now + h)
    if code == OK and closing >= 0:
        code = close(run, closing, before)
        if state.pieces > first:
            march.path.end[state.pieces - 1] = state.now
    state.choose = 1
    return code if code != OK else correct(run, state.now, march.x)


@inner
def close(run: int, closing: int, before: float) -> int:
    """Go on until this gap is closed, or back, but not to a time earlier than ``before``."""
    march = march_at(run)
    state, system = march.state[0], system_at(march.place)
    for _ in range(MOST_WAITS):
        wait = max(wait_for(run, closing), before - state.now)
        for k in range(march.x.size):
            march.x[k] += wait * march.rate[0, k]
        state.now += wait
        if state.cuts == 0:
            break
        # A dense output leaves the held rows by more than an integrator does, and to put it back moves the gap, too.
        code = correct(run, state.now, march.x)
        if code != OK or abs(gap(system.rows, system.sets, closing, march.x)) <= CLOSED_GAP * state.size:
            return code
    return OK


@inner
def wait_for(run: int, closing: int) -> float:
    """How long until this gap closes, by one Newton step; 0 if it does not close."""
    march = march_at(run)
    system = system_at(march.place)
    call_python(system.sets, march.state[0].now, march.x, VELOCITIES)
    width = linearise(system.rows, system.sets, closing, march.x, system.program.gradient)
    speed = times(system.rows, closing, system.program.gradient, march.rate[0]) - least_speed(system, closing)
    return -width / speed if speed < 0.0 else 0.0
