"""The integrator: phases with fixed active contacts, from event to event, and states on the dense output."""

from typing import Any

import numpy as np

from dincl.compiled import inner, kernel
from dincl.compiled.arrays import Floats, Offsets
from dincl.events.contacts import decide_contacts
from dincl.events.location import NEVER, first_event
from dincl.events.motion import restore, set_speed, velocity_at
from dincl.events.runge_kutta import EPS, dense_value
from dincl.events.steps import accept_step, check_jump, make_step, pass_stop, truncate_step
from dincl.events.workspace import AGAIN, DONE, FULL, JUMPS, NO_STEP, SLOW, SPARE, STUCK, TOUCHING, EventWorkspace
from dincl.rows.table import VELOCITIES, call_python, gap, is_timed, linearise
from dincl.solvers.envelope_factor import add_row, row_dot
from dincl.system.arrays import OK, SETS, bounded, longest, system_at

# A piece that ends within this part of its steps is over.
SLIVER = 1e-3
# Changes of the contacts at one time.
MOST_AT_ONCE = 100
# Steps of a run: a hundred discs with 300 events take about a thousand. Each time after so many, the number that the
# run needs is estimated.
MOST_STEPS, CHECK = 100_000, 5_000
# Jumps of the drift allowed in one run.
MOST_JUMPS = 10_000
# An event before a jump, or the end, by no more than this part of the run is at the jump, or the end.
MEETS = 1e-12
# The share of the last phase in the mean of their lengths. A step is at most this many times that mean for a run in one
# part, two thirds of it in two parts; twice as much after each step without an event.
SHARE, PHASES = 0.1, 3.0
# Free places in the table at the start of a step: for the steps on the way to an event.
FREE = 32
# A dense output is used for the state at an event if the estimated error of its step is below this part of the
# tolerance. Then 200 discs state an error of 1e-9; with 0.1 it is 1e-8.
ACCURATE = 1e-2
# Newton steps to the time at which a gap closes, where a step ends by its dense output; the allowed rest of the gap,
# relative to the size of the problem.
MOST_NEWTON, CLOSED_GAP = 4, 1e-14
# Units in the last place of a time by which an event may be late.
ROUNDED_TIMES = 4.0
# No times, steps and states, for a call that makes steps.
NO_STATES = np.zeros(0), np.zeros(0, dtype=np.int64), np.zeros((0, 0))


@kernel
def integrate(run: Any, most: int, t: Floats, step: Offsets, x: Floats) -> int:
    """Continue to the end, until the table of steps is full, or for ``most`` steps: DONE, FULL or a failure.

    For ``most`` = 0 write the states at times t within these steps into x (K, n): OK or a failure. A kernel of their
    own would need much of this one again, and 0.8 s to compile it.
    """
    state = run.state[0]
    if most == 0:
        return write_states(run, t, step, x)
    for _ in range(most):
        code = begin_phase(run) if state.undecided != 0 else OK
        if code == OK:
            code = step_to_event(run)
        if code != OK:
            return code
        if state.jumps > MOST_JUMPS:
            return JUMPS
        if is_slow(run):
            return SLOW
        if state.steps > run.steps.end.size - FREE or state.events > run.steps.event.shape[0] - run.contact.size:
            return FULL
    return FULL


@inner
def begin_phase(run: EventWorkspace) -> int:
    """Decide the contacts, and choose the longest step of the phase, and the first one of a run."""
    state, code = run.state[0], OK
    # What started small and went far rounds as what is large.
    state.size = max(state.size, longest(run.x, system_at(run.system).sets.shift.shape[1]))
    if state.stop - state.t <= MEETS * (state.end - state.start):
        if state.stop < state.end:
            code = pass_stop(run)
        elif state.steps > 0:
            # What a contact at the end would do behind it is nobody's question, and may have no answer.
            state.t = run.steps.end[state.steps - 1] = state.end
            return DONE
    if code == OK:
        code = decide_contacts(run)
    if code != OK:
        return code
    state.repeats = state.repeats + 1 if state.phase > 0 and state.t == state.decided_at else 0
    if state.phase > 0 and state.t > state.decided_at:
        share = max(SHARE, 1.0 / state.phase)
        state.mean_phase += share * (state.t - state.decided_at - state.mean_phase)
    state.decided_at, state.undecided = state.t, 0
    state.phase += 1
    state.longest = (state.end - state.t) / state.parts
    if state.mean_phase > 0.0:
        # A longer step would be cut at the next event, and its error estimate, for all of it, would be in the way.
        state.longest = min(state.longest, PHASES * 2.0 / (1.0 + state.parts) * state.mean_phase)
    if state.repeats > MOST_AT_ONCE:
        return STUCK
    if state.h == 0.0:
        way = state.size * min(1.0, state.tol / state.size) ** (1.0 / (run.pair.order + 1.0))
        state.h = min(state.longest, 0.1 * way / state.speed if state.speed > 0.0 else state.longest)
    code = restore(run, state.t, run.x)
    return code if code != OK else velocity_at(run, state.t, run.x, run.rate[0], run.multiplier[0])


@inner
def step_to_event(run: EventWorkspace) -> int:
    """Make a step, to the next event at most: OK, DONE or a failure."""
    state, sets = run.state[0], system_at(run.system).sets
    left = state.stop - state.t
    if not left > 0.0:
        return DONE
    code, h = make_step(run, min(state.longest, left, resolved_step(run)))
    if code == OK:
        code = check_jump(run, h)
    if code != OK:
        return OK if code == AGAIN else code
    part, closing = first_event(run)
    if state.code != OK or sets.failed[0] != 0:
        return int(state.code) if state.code != OK else SETS
    if part < NEVER:
        code = go_to_event(run, h, state.t + part * h, closing)
    elif h < left:
        accept_step(run, h, state.t + h)
        state.longest = min(2.0 * state.longest, (state.end - state.decided_at) / state.parts)
    else:
        accept_step(run, h, state.stop)
        code = pass_stop(run) if state.stop < state.end else OK
    return code if code != OK or bounded(run.x, state.largest) else NO_STEP


@inner
def resolved_step(run: EventWorkspace) -> float:
    """Return the longest step that resolves the functions of time, within the piece in which t is."""
    state, pieces = run.state[0], run.pieces
    while state.piece < pieces.shape[0] and pieces[state.piece, 0] - state.t <= SLIVER * pieces[state.piece, 1]:
        state.piece += 1
    if state.piece == pieces.shape[0]:
        return np.inf
    stop, longest = pieces[state.piece]
    return float(min(longest / state.parts, stop - state.t))


@inner
def go_to_event(run: EventWorkspace, h: float, t: float, closing: int) -> int:
    """Continue to the event at t, and until the gap of row ``closing`` >= 0 is closed to rounding.

    By the dense output of the step of length h if it is accurate, else by new steps.
    """
    state, first = run.state[0], run.state[0].steps
    part, before, code = (t - state.t) / state.parts, state.t, OK
    if state.error < ACCURATE and t > state.t:
        code = truncate_step(run, h, t if state.parts == 1 else state.t + part)
        if code == OK and state.parts > 1:
            code = velocity_at(run, state.t, run.x, run.rate[0], run.multiplier[0])
    while code == OK and state.t < t:
        code, h = make_step(run, min(part, t - state.t))
        if code == OK and state.steps == run.steps.end.size:
            code = STUCK
        if code == OK:
            accept_step(run, h, t if h >= t - state.t else state.t + h)
    if code == OK and closing >= 0:
        code = close_gap(run, closing, before)
        if state.steps > first:
            run.steps.end[state.steps - 1] = state.t
    state.undecided = 1
    return code if code != OK else restore(run, state.t, run.x)


@inner
def close_gap(run: EventWorkspace, closing: int, earliest: float) -> int:
    """Move along the velocity, forth or back in time, until this gap is closed."""
    state, system = run.state[0], system_at(run.system)
    rows, sets, gradient = system.rows, system.sets, system.program.gradient
    for _ in range(MOST_NEWTON):
        call_python(sets, state.t, run.x, VELOCITIES)
        width = linearise(rows, sets, closing, run.x, gradient)
        speed = row_dot(rows, closing, gradient, run.rate[0]) - set_speed(system, closing)
        wait = max(-width / speed if speed < 0.0 else 0.0, earliest - state.t)
        for k in range(run.x.size):
            run.x[k] += wait * run.rate[0, k]
        state.t += wait
        # A dense output leaves the active rows by more than an integrator does; to restore them moves this gap, too.
        code = restore(run, state.t, run.x)
        if code != OK or abs(gap(rows, sets, closing, run.x)) <= CLOSED_GAP * state.size:
            return code
    if is_timed(sets, rows.row[closing]):
        # A time is rounded, and with it the place of a set: a fast one touches after a move of x by as much.
        call_python(sets, state.t, run.x, VELOCITIES)
        width = linearise(rows, sets, closing, run.x, gradient)
        moved = ROUNDED_TIMES * EPS * state.t * abs(set_speed(system, closing))
        if TOUCHING * state.size < width <= moved:
            add_row(rows, closing, gradient, -width, run.x)
    return OK


@inner
def is_slow(run: EventWorkspace) -> bool:
    """Return whether the run needs more steps than allowed, at the rate of its last ones."""
    state = run.state[0]
    made = state.made - state.checked
    if made < CHECK:
        return False
    needed = (state.end - state.t) / (state.t - state.checked_t) * made if state.t > state.checked_t else np.inf
    state.checked, state.checked_t = state.made, state.t
    return bool(state.made + needed > MOST_STEPS)


@inner
def activate(run: EventWorkspace, p: int) -> None:
    """Activate the rows of step p, without a factor of another state, so that a state depends on its time alone."""
    run.gram.number[1] = 0
    run.active.number[0] = run.steps.number[p]
    for k in range(run.active.number[0]):
        run.active.row[k] = run.steps.active[p, k]


@inner
def write_states(run: EventWorkspace, t: Floats, step: Offsets, x: Floats) -> int:
    """Write states: the dense output, moved onto the active rows."""
    steps, point = run.steps, run.point
    for q in range(t.size):
        p = step[q]
        activate(run, p)
        theta = (t[q] - steps.start[p]) / steps.h[p]
        for k in range(run.x.size):
            point[k] = dense_value(steps.dense[p], run.pair.terms, steps.x[p, k], k, theta)[0]
        code = restore(run, t[q], point)
        if code != OK:
            return code
        for k in range(run.x.size):
            x[q, k] = point[k]
    return OK


@kernel
def rate_at(run: Any, t: float, step: int, x: Floats, rate: Floats) -> int:
    """Write x' at a state x of a step into ``rate``."""
    activate(run, step)
    return velocity_at(run, t, x, rate, run.multiplier[SPARE])
