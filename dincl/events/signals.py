"""What must not become negative during a step, on its dense output: gaps, pushes, speeds; and where it does."""

import numpy as np

from dincl.compiled import inner
from dincl.compiled.arrays import Floats
from dincl.events.arrays import march_at
from dincl.events.motion import EPS, at, dense_state, least_speed, move
from dincl.rows.table import CALLBACK, DISTANCE, FORMULA, VELOCITIES, call_python, linearise
from dincl.solvers.factor import times
from dincl.system.arrays import OK, system_at

# Looked at are the ends of this many equal parts of a step, and the lows in between.
PARTS = 4
# Speeds and pushes count as negative below this many times what the choice takes for zero.
NEGATIVE = 10.0
# What is watched has the number of a row, for its gap; from m on, for the speed of a row that is closed and not held;
# or stands for the pushes.
PUSHES = -1
# A low is looked at closely when it falls below this part of what is around it.
SUSPICIOUS = 0.5
# A push, or a speed, vanishes linearly in time, and the way that is lost is of second order: the part of a step to
# which its time is wanted, for a tolerance of 1. A gap is followed to rounding, and so is a push that jumps: between
# such times it still falls by so much of what it falls by in all.
RELEASE, STEEP = 3e-3, 0.1
MOST_ITERATIONS = 100
# No event in this step.
NEVER = 2.0


@inner
def signal(run: int, what: int, theta: float) -> tuple[float, float]:
    """What must not become negative, at a part ``theta`` of the step; for a gap also its derivative after theta."""
    march = march_at(run)
    if what == PUSHES or what >= march.closed.size:
        return weakness(run, what, theta), 0.0
    state, system = march.state[0], system_at(march.place)
    row, rows, sets, d, h = system.rows.row[what], system.rows, system.sets, system.sets.shift.shape[1], state.made
    if row.j < 0 and (sets.address != 0 or row.kind == FORMULA):
        dense_state(run, theta)
        call_python(sets, state.now + theta * h, march.point, VELOCITIES)
    value, slope, terms = 0.0, 0.0, march.pair.terms
    if row.kind == DISTANCE:
        for k in range(d):
            one, speed = at(march.dense, terms, march.x[row.i * d + k], row.i * d + k, theta)
            if row.j >= 0:
                other, rate = at(march.dense, terms, march.x[row.j * d + k], row.j * d + k, theta)
            else:
                other = rows.coefficient[rows.start[what] + k] + sets.shift[row.family, k]
                rate = h * sets.speed[row.family, k]
            value += (one - other) * (one - other)
            slope += 2.0 * (one - other) * (speed - rate)
        length = row.length + row.sign * state.level
        return row.sign * (value - length * length), row.sign * slope
    if row.kind in (CALLBACK, FORMULA):
        value = linearise(rows, sets, what, march.point, system.program.gradient) - state.level
        slope = times(rows, what, system.program.gradient, march.rate[16]) - h * least_speed(system, what)
        return value, slope
    for p in range(rows.start[what], rows.stop[what]):
        column = rows.column[p]
        place, speed = at(march.dense, terms, march.x[column], column, theta)
        value += rows.coefficient[p] * (place - sets.shift[row.family, column % d])
        slope += rows.coefficient[p] * (speed - h * sets.speed[row.family, column % d])
    return value - row.length - state.level * np.sqrt(row.square), slope


@inner
def weakness(run: int, what: int, theta: float) -> float:
    """The smallest push, or how far the speed of a closed row is below what makes it a change; negative on failure."""
    march = march_at(run)
    state, system = march.state[0], system_at(march.place)
    zero, t = NEGATIVE * state.slow, state.now + theta * state.made
    if what == PUSHES and theta == 0.0:
        return float(zero + least(run, march.push[0]))
    if what == PUSHES and theta == 1.0:
        return float(zero + least(run, march.push[march.pair.stages]))
    if state.theta != theta:
        dense_state(run, theta)
        state.code = move(run, t, march.point, march.rate[16], march.push[16])
        state.theta = theta
    if state.code != OK:
        return -1.0
    if what == PUSHES:
        return float(zero + least(run, march.push[16]))
    r = what - march.closed.size
    call_python(system.sets, t, march.point, VELOCITIES)
    linearise(system.rows, system.sets, r, march.point, system.program.gradient)
    speed = times(system.rows, r, system.program.gradient, march.rate[16]) - least_speed(system, r)
    return float(zero - abs(speed))


@inner
def least(run: int, push: Floats) -> float:
    """The least of the pushes of the held rows."""
    march = march_at(run)
    found = np.inf
    for k in range(march.held.number[0]):
        found = min(found, push[k])
    return found


@inner
def root(run: int, what: int, a: float, first: float, b: float, last: float, slope: bool) -> float:
    """Where a signal becomes negative that is ``first`` >= 0 at a and ``last`` < 0 at b > a; Chandrupatla (1997)."""
    march = march_at(run)
    if first <= 0.0:
        return a
    c, third, share, state, steep = a, first, 0.5, march.state[0], 0.0
    rounding = 2.0 * EPS * max(abs(state.now) / max(state.made, 1e-300), 1.0)
    allowed = rounding
    if what < 0 or what >= march.closed.size:
        allowed, steep = max(rounding, RELEASE * np.sqrt(state.tol / state.size)), STEEP * (first - last)
    for _ in range(MOST_ITERATIONS):
        middle = a + share * (b - a)
        value, rising = signal(run, what, middle)
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
def first_negative(run: int, what: int, most: float) -> float:
    """When a signal becomes negative at a node, or dips below zero between nodes; NEVER if not until ``most``."""
    two, one, falling, is_gap = np.inf, np.inf, 0.0, 0 <= what < march_at(run).closed.size
    for j in range(PARTS + 1):
        theta = j / PARTS
        value, slope = signal(run, what, theta)
        left, before, end, low = theta - 1.0 / PARTS, one, theta, value
        if not value < 0.0 and is_gap and falling < 0.0 < slope and dips(one, falling / PARTS, value, slope / PARTS):
            end = root(run, what, left, -falling, theta, -slope, True)
        elif not value < 0.0 and not is_gap and j > 1 and sinks(two, one, value):
            left, before = theta - 2.0 / PARTS, two
            end = lowest_between(run, what, left, theta)
        if end < theta:
            low = signal(run, what, end)[0]
        if low < 0.0:
            return root(run, what, left, before, end, low, False) if j > 0 else 0.0
        if theta > most:
            break
        two, one, falling = one, value, slope
    return NEVER


@inner
def dips(before: float, falling: float, after: float, rising: float) -> bool:
    """Whether the cubic with these values and slopes at the ends of [0, 1] falls low between them."""
    cube = 2.0 * (before - after) + falling + rising
    square = 3.0 * (after - before) - 2.0 * falling - rising
    root = np.sqrt(max(square * square - 3.0 * cube * falling, 0.0))
    bottom = -falling / (square + root) if square + root > 0.0 else 0.5
    low = before + bottom * (falling + bottom * (square + bottom * cube))
    return not low > SUSPICIOUS * min(before, after)


@inner
def sinks(before: float, value: float, after: float) -> bool:
    """Whether the parabola through three values falls low around the middle one."""
    if not value <= min(before, after):
        return False
    bend = before - 2.0 * value + after
    depth = (after - before) * (after - before) / (8.0 * bend) if bend > 0.0 else 0.0
    return value - depth <= SUSPICIOUS * value


@inner
def lowest_between(run: int, what: int, left: float, right: float) -> float:
    """Where a signal is lowest, by golden section; the first place at which it is negative ends the search."""
    golden = 0.6180339887498949
    a, b = right - golden * (right - left), left + golden * (right - left)
    at_a, at_b = signal(run, what, a)[0], signal(run, what, b)[0]
    while right - left > 1e-4 and at_a >= 0.0 and at_b >= 0.0:
        if at_a < at_b:
            right, b, at_b = b, a, at_a
            a = right - golden * (right - left)
            at_a = signal(run, what, a)[0]
        else:
            left, a, at_a = a, b, at_b
            b = left + golden * (right - left)
            at_b = signal(run, what, b)[0]
    return a if at_a < at_b else b
