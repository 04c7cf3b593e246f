"""Functions of time that must not become negative during a step, on its dense output, and their first zero.

They are the gap of an open row; the smallest multiplier of the active rows; for a closed row that is not active how far
its speed is below the one that changes its state.
"""

import numpy as np

from dincl.compiled import inner
from dincl.compiled.arrays import Floats
from dincl.events.motion import dense_state, dense_velocity, set_speed
from dincl.events.runge_kutta import EPS, dense_value
from dincl.events.workspace import SPARE, EventWorkspace
from dincl.rows.table import CALLBACK, DISTANCE, FORMULA, VELOCITIES, call_python, gap, is_timed, linearise
from dincl.solvers.envelope_factor import row_dot
from dincl.system.arrays import OK, system_at

# Nodes are the ends of this many equal parts of a step; minima between them are searched for.
PARTS = 4
# Speeds and multipliers count as negative below this many times the threshold of the decision of contacts.
NEGATIVE = 10.0
# An event function has the number r of a row, for its gap; m + r, for the speed of a closed row that is not active; or
# this number, for the multipliers.
MULTIPLIERS = -1
# A minimum is searched for if an interpolant falls below this part of the values around it.
SUSPICIOUS = 0.5
# A multiplier, or a speed, vanishes linearly in time, and the displacement by a late release is of second order: the
# accuracy of its time, as a part of the step, for a tolerance of 1. A gap is followed to rounding, and so is a
# multiplier that jumps: within that accuracy it still falls by more than this share of its whole fall.
RELEASE, STEEP = 3e-3, 0.1
MOST_ITERATIONS = 100
# The minimum of a function is located to this part of the step.
MINIMUM = 1e-4
# No event in this step.
NEVER = 2.0


@inner
def event_function(run: EventWorkspace, which: int, theta: float) -> tuple[float, float]:
    """Evaluate a function at a part ``theta`` of the step; for a gap also its derivative after theta."""
    if not 0 <= which < run.contact.size:
        return margin(run, which, theta), 0.0
    state, system, dense, x, terms = run.state[0], system_at(run.system), run.dense, run.x, run.pair.terms
    row, rows, sets, d, h = system.rows.row[which], system.rows, system.sets, system.sets.shift.shape[1], state.step
    if is_timed(sets, row) or row.kind == FORMULA:
        dense_state(run, theta)
        call_python(sets, state.t + theta * h, run.point, VELOCITIES)
    value, slope = 0.0, 0.0
    if row.kind in (CALLBACK, FORMULA) or sets.general[row.family] != 0:
        value = linearise(rows, sets, which, run.point, system.program.gradient) - state.level
        slope = row_dot(rows, which, system.program.gradient, run.rate[SPARE]) - h * set_speed(system, which)
        if np.isnan(value):  # at a centre there is no gradient, but there is a gap
            return gap(rows, sets, which, run.point) - state.level, 0.0
        return value, slope
    if row.kind == DISTANCE:
        # sign (|X_i - X_j|^2 - L^2) has the sign of the gap, and no root.
        for k in range(d):
            one, speed = dense_value(dense, terms, x[row.i * d + k], row.i * d + k, theta)
            if row.j >= 0:
                other, rate = dense_value(dense, terms, x[row.j * d + k], row.j * d + k, theta)
            else:
                other = rows.coefficient[rows.start[which] + k] + sets.shift[row.family, k]
                rate = h * sets.speed[row.family, k]
            value += (one - other) * (one - other)
            slope += 2.0 * (one - other) * (speed - rate)
        length = row.length + row.sign * state.level
        return row.sign * (value - length * length), row.sign * slope
    for p in range(rows.start[which], rows.stop[which]):
        column = rows.column[p]
        place, speed = dense_value(dense, terms, x[column], column, theta)
        value += rows.coefficient[p] * (place - sets.shift[row.family, column % d])
        slope += rows.coefficient[p] * (speed - h * sets.speed[row.family, column % d])
    return value - row.length - state.level * np.sqrt(row.square), slope


@inner
def margin(run: EventWorkspace, which: int, theta: float) -> float:
    """Evaluate the smallest multiplier, or the margin of the speed of a closed row; negative if that fails."""
    state, system = run.state[0], system_at(run.system)
    zero = NEGATIVE * state.zero
    if which == MULTIPLIERS and theta == 0.0:
        return float(zero + least(run, run.multiplier[0]))
    if which == MULTIPLIERS and theta == 1.0:
        return float(zero + least(run, run.multiplier[run.pair.stages]))
    if state.theta != theta:
        state.code = dense_velocity(run, theta)
        state.theta = theta
    if state.code != OK:
        return -1.0
    if which == MULTIPLIERS:
        return float(zero + least(run, run.multiplier[SPARE]))
    r = which - run.contact.size
    call_python(system.sets, state.t + theta * state.step, run.point, VELOCITIES)
    linearise(system.rows, system.sets, r, run.point, system.program.gradient)
    speed = row_dot(system.rows, r, system.program.gradient, run.rate[SPARE]) - set_speed(system, r)
    return float(zero - abs(speed))


@inner
def least(run: EventWorkspace, multiplier: Floats) -> float:
    """Return the smallest multiplier of the active rows."""
    found = np.inf
    for k in range(run.active.number[0]):
        found = min(found, multiplier[k])
    return found


@inner
def first_negative(run: EventWorkspace, which: int, latest: float) -> float:
    """Find when a function becomes negative at a node, or between nodes; NEVER if not until ``latest``."""
    two, one, falling, is_gap = np.inf, np.inf, 0.0, 0 <= which < run.contact.size
    for j in range(PARTS + 1):
        theta = j / PARTS
        value, slope = event_function(run, which, theta)
        left, before, end, low = theta - 1.0 / PARTS, one, theta, value
        if not value < 0.0 and is_gap and falling < 0.0 < slope and dips(one, falling / PARTS, value, slope / PARTS):
            end = root(run, which, left, -falling, theta, -slope, True)
        elif not value < 0.0 and not is_gap and j > 1 and sinks(two, one, value):
            left, before = theta - 2.0 / PARTS, two
            end = lowest_between(run, which, left, theta)
        if end < theta:
            low = event_function(run, which, end)[0]
        if low < 0.0:
            return root(run, which, left, before, end, low, False) if j > 0 else 0.0
        if theta > latest:
            break
        two, one, falling = one, value, slope
    return NEVER


@inner
def root(run: EventWorkspace, which: int, a: float, first: float, b: float, last: float, slope: bool) -> float:
    """Find where a function becomes negative that is ``first`` >= 0 at a and ``last`` < 0 at b > a.

    Or, with ``slope``, its derivative, with the sign changed. Source: Chandrupatla (1997).
    """
    if first <= 0.0:
        return a
    c, third, share, state, steep = a, first, 0.5, run.state[0], 0.0
    rounding = 2.0 * EPS * max(abs(state.t) / max(state.step, 1e-300), 1.0)
    allowed = rounding
    if not 0 <= which < run.contact.size:
        allowed, steep = max(rounding, RELEASE * np.sqrt(state.tol / state.size)), STEEP * (first - last)
    for _ in range(MOST_ITERATIONS):
        middle = a + share * (b - a)
        value, rising = event_function(run, which, middle)
        if slope:
            value = -rising
        if (value > 0.0) == (first > 0.0):
            c, third = a, first
        else:
            c, third, b, last = b, last, a, first
        a, first = middle, value
        limit = allowed / abs(b - a)
        if limit > 0.5 and allowed > rounding and abs(first - last) > steep:
            allowed = rounding
            limit = allowed / abs(b - a)
        if limit > 0.5 or first == 0.0 or state.code != OK:
            break
        xi, phi = (a - b) / (c - b), (first - last) / (third - last)
        share = 0.5
        if phi * phi < xi and (1.0 - phi) * (1.0 - phi) < 1.0 - xi:
            share = first / (last - first) * third / (last - third)
            share += (c - a) / (b - a) * first / (third - first) * last / (third - last)
        share = min(1.0 - limit, max(limit, share))
    return a if first <= 0.0 else b


@inner
def dips(before: float, falling: float, after: float, rising: float) -> bool:
    """Return whether the cubic with these values and slopes at the ends of [0, 1] falls low between them."""
    cube = 2.0 * (before - after) + falling + rising
    square = 3.0 * (after - before) - 2.0 * falling - rising
    root = np.sqrt(max(square * square - 3.0 * cube * falling, 0.0))
    bottom = -falling / (square + root) if square + root > 0.0 else 0.5
    low = before + bottom * (falling + bottom * (square + bottom * cube))
    return not low > SUSPICIOUS * min(before, after)


@inner
def sinks(before: float, value: float, after: float) -> bool:
    """Return whether the parabola through three values falls low around the middle one."""
    if not value <= min(before, after):
        return False
    bend = before - 2.0 * value + after
    depth = (after - before) * (after - before) / (8.0 * bend) if bend > 0.0 else 0.0
    return value - depth <= SUSPICIOUS * value


@inner
def lowest_between(run: EventWorkspace, which: int, left: float, right: float) -> float:
    """Find the minimum of a function by golden section; the first negative value ends the search."""
    golden = 0.6180339887498949
    a, b = right - golden * (right - left), left + golden * (right - left)
    at_a, at_b = event_function(run, which, a)[0], event_function(run, which, b)[0]
    while right - left > MINIMUM and at_a >= 0.0 and at_b >= 0.0:
        if at_a < at_b:
            right, b, at_b = b, a, at_a
            a = right - golden * (right - left)
            at_a = event_function(run, which, a)[0]
        else:
            left, a, at_a = a, b, at_b
            b = left + golden * (right - left)
            at_b = event_function(run, which, b)[0]
    return a if at_a < at_b else b
