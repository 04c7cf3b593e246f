"""Steps that meet the tolerance and hide no jump of the velocity.

Breaks of the functions of time are known before the run: jumps of a set, of its velocity, and of the drift at x0. Other
jumps of the drift are found on the way: where the derivative of the dense output differs from the velocity, bisection
locates one, and the run stops there.
"""

import numpy as np

from dincl.compiled import inner
from dincl.events.motion import dense_state, dense_velocity, restore, velocity_at
from dincl.events.runge_kutta import EPS, allowed_error, dense_value, error_ratio, interpolate, stage_point
from dincl.events.workspace import AGAIN, MOVED, NO_STEP, SPARE, TOUCHING, EventWorkspace
from dincl.neighbours import ROW_MARGIN
from dincl.rows.table import VELOCITIES, call_python, gap
from dincl.steps.programs import list_sorted
from dincl.system.arrays import OK, SETS, system_at

# Part of the step that the error allows; the least and the largest factor from one step to the next.
SAFETY, LEAST, MOST = 0.9, 0.2, 10.0
# The root of 2, at most the length of a gradient.
PAIR = 1.4142135623730951
# An estimate below this hides no error as large as the tolerance: the estimate of a step over a jump is at least about
# a thousandth of the error.
NEGLIGIBLE = 1e-4
# The part of a step at which velocities are compared: none of the stages lies there, and it alternates between runs.
PLACES = (0.63, 0.41)
# Largest allowed difference between the derivative of the dense output and the velocity, times the step, over the
# tolerance. Without a limit smooth problems take 6 % fewer evaluations, with 10 in place of 30 they take 21 % more.
DEFECT = 30.0
# A step is divided into this many parts to locate a jump. A difference that shrinks below this share of its first value
# while its part is halved is no jump.
PARTS, SHRINKS = 8, 0.3


@inner
def make_step(run: EventWorkspace, limit: float) -> tuple[int, float]:
    """Make a step from x that meets the tolerance, no longer than ``limit``, with its dense output.

    Returns how it ended, and its length.
    """
    state, pair = run.state[0], run.pair
    h, exponent, most, i = min(state.h, limit), -1.0 / (pair.order + 1.0), MOST, 1
    shortened = h < state.h
    while i < pair.stages + 1 + pair.more:
        if not state.t + h > state.t:
            return NO_STEP, h
        stage_point(pair, run.x, run.rate, h, i, run.point)
        if i == pair.stages:
            after, point = run.after, run.point
            for k in range(after.size):
                after[k] = point[k]
        code = velocity_at(run, state.t + pair.c[i] * h, run.point, run.rate[i], run.multiplier[i])
        if code != OK:
            return code, h
        i += 1
        if i == pair.stages + 1:
            error = error_ratio(pair, run.x, run.after, run.rate, h, state.tol, state.size)
            state.error = error
            change = min(most, max(LEAST, SAFETY * error**exponent)) if error > 0.0 else most
            if error < 1.0:
                # A step that was cut short, and could have been longer still, does not say how long.
                state.h = max(state.h, h * change) if shortened and change == MOST else h * change
            else:
                h, most, shortened, i = h * (change if error < np.inf else LEAST), 1.0, False, 1
    state.made += 1
    interpolate(pair, run.x, run.after, run.rate, h, run.dense)
    state.theta, state.step = -1.0, h
    return OK, h


@inner
def record_step(run: EventWorkspace, h: float, t: float) -> None:
    """Append the step of length h to the table, for times up to t."""
    state, steps, terms, dense = run.state[0], run.steps, run.pair.terms, run.dense
    p, part = state.steps, (t - state.t) / h
    steps.end[p], steps.start[p], steps.h[p], steps.number[p] = t, state.t, h, run.active.number[0]
    for k in range(run.active.number[0]):
        steps.active[p, k], least = run.active.row[k], 0.0
        for i in range(run.pair.stages):
            # At its end a step may be at a jump already.
            if run.pair.c[i] < min(part, 1.0):
                least = min(least, run.multiplier[i, k])
        state.neglected -= PAIR * h * least
    saved, written, x = steps.x, steps.dense, run.x
    for k in range(x.size):
        saved[p, k] = x[k]
        for j in range(terms):
            written[p, j, k] = dense[j, k]
    state.steps += 1


@inner
def accept_step(run: EventWorkspace, h: float, t: float) -> None:
    """Record the step and continue from its end at t."""
    record_step(run, h, t)
    for k in range(run.active.number[0]):
        run.multiplier[0, k] = run.multiplier[run.pair.stages, k]
    for k in range(run.x.size):
        run.x[k] = run.after[k]
        run.rate[0, k] = run.rate[run.pair.stages, k]
    run.state[0].t, run.state[0].last_h = t, h


@inner
def truncate_step(run: EventWorkspace, h: float, t: float) -> int:
    """Record the step and continue from t within, by its dense output."""
    state = run.state[0]
    dense_state(run, (t - state.t) / h)
    record_step(run, h, t)
    for k in range(run.x.size):
        run.x[k], run.rate[0, k] = run.point[k], run.rate[SPARE, k] / h
    state.t, state.last_h = t, h
    return restore(run, t, run.x)


@inner
def pass_stop(run: EventWorkspace) -> int:
    """Continue behind a break, where contacts are decided.

    MOVED if a set jumped away from a contact or onto a particle. The next stop is a known break, or the end.
    """
    state, breaks = run.state[0], run.breaks
    last, code = state.resume, OK
    is_known = state.passed < breaks.shape[0] and state.resume == breaks[state.passed, 2]
    if is_known:
        last = breaks[state.passed, 1]
        if state.undecided == 0:
            for k in range(run.x.size):
                run.x[k] += (last - state.t) * run.rate[0, k]
        code = restore(run, last, run.x)
        state.passed += 1
    state.t, state.undecided, state.h = state.resume, 1, max(state.h, state.last_h)
    if state.steps > 0:
        run.steps.end[state.steps - 1] = last
    state.stop = state.resume = state.end
    if state.passed < breaks.shape[0]:
        state.stop, state.resume = breaks[state.passed, 0], breaks[state.passed, 2]
    if is_known and code == OK:
        code = check_sets(run)
    return code if code != OK else restore(run, state.t, run.x)


@inner
def check_sets(run: EventWorkspace) -> int:
    """Return MOVED if an active row is open, or a row overlaps by more than an integrator leaves; else OK or a failure.

    Behind a kink of a set neither happens: within the interval that holds the kink sets move by rounding.
    """
    state, system, x, touching = run.state[0], system_at(run.system), run.x, TOUCHING * run.state[0].size
    rows, sets, near = system.rows, system.sets, system.near
    if sets.address == 0:
        return OK
    if call_python(sets, state.t, x, VELOCITIES) != 0:
        return SETS
    for k in range(run.active.number[0]):
        if not gap(rows, sets, run.active.row[k], x) <= touching:
            return MOVED
    list_sorted(system, state.t, x, touching, ROW_MARGIN)
    for q in range(near.number[0]):
        if not gap(rows, sets, near.row[q], x) >= -max(touching, state.tol):
            return MOVED
    return OK


@inner
def check_jump(run: EventWorkspace, h: float) -> int:
    """Compare the dense output of a step with the velocity between its stages: OK, AGAIN or a failure."""
    state = run.state[0]
    if state.error < NEGLIGIBLE:
        return OK
    # Runs have 1, 2, 4, 8 parts.
    theta = PLACES[0] if state.parts % 3 == 1 else PLACES[1]
    code = dense_velocity(run, theta)
    if code != OK:
        return code
    axis, largest = 0, 0.0
    for k in range(run.x.size):
        part = abs(h * defect(run, h, theta, k)) / allowed_error(state.tol, state.size, run.x[k], run.after[k])
        if part > largest:
            axis, largest = k, part
    return locate_jump(run, h, axis) if largest > DEFECT else OK


@inner
def locate_jump(run: EventWorkspace, h: float, axis: int) -> int:
    """Let the run stop at the jump of this coordinate of its velocity; without a jump the step is too long."""
    state = run.state[0]
    a, b, first, last, widest, before = 0.0, 1.0, 0.0, 0.0, -1.0, 0.0
    for j in range(1, PARTS + 1):
        code = dense_velocity(run, j / PARTS)
        if code != OK:
            return code
        value = defect(run, h, j / PARTS, axis)
        if abs(value - before) > widest:
            a, b, first, last, widest = (j - 1) / PARTS, j / PARTS, before, value, abs(value - before)
        before = value
    while (b - a) * h > 2.0 * EPS * (state.t + h):
        middle = 0.5 * (a + b)
        code = dense_velocity(run, middle)
        if code != OK:
            return code
        value = defect(run, h, middle, axis)
        if abs(value - first) > abs(last - value):
            b, last = middle, value
        else:
            a, first = middle, value
        if not abs(last - first) > SHRINKS * widest:
            state.h = 0.25 * h
            return AGAIN
    rounding = 4.0 * EPS * (state.t + h)
    state.stop, state.resume = state.t + a * h - rounding, min(state.t + b * h + rounding, state.end)
    state.jumps += 1
    code = OK if state.stop > state.t else pass_stop(run)
    return AGAIN if code == OK else code


@inner
def defect(run: EventWorkspace, h: float, theta: float, k: int) -> float:
    """Compute the difference of coordinate k of the velocity from the derivative of the dense output."""
    return float(run.rate[SPARE, k] - dense_value(run.dense, run.pair.terms, run.x[k], k, theta)[1] / h)
