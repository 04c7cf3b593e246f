"""Event location: the first gap that closes, multiplier that vanishes or closed row that moves during a step."""

import numpy as np

from dincl.compiled import inner
from dincl.events.event_functions import CLOSING, GAP, MOTION, RELEASE, event_function_at, gap_and_slope_at
from dincl.events.runge_kutta import EPS
from dincl.events.workspace import ACTIVE, CLOSED, TOUCHING, EventWorkspace
from dincl.neighbours import EVENT_MARGIN, TOO_WIDE
from dincl.rows.table import DISTANCE, VELOCITIES, call_python, gap, is_timed, linearise, scaled_length
from dincl.solvers.envelope_factor import row_dot
from dincl.steps.programs import carry, list_sorted
from dincl.system.arrays import OK, system_at

# Sets are taken to be carried up to so many times as far as they are at the nodes.
SAFETY = 2.0
# Nodes are the ends of this many equal parts of a step; minima between them are searched for.
PARTS = 4
# The minimum of a multiplier or a speed is searched for if a parabola falls below this part of the values around it.
SUSPICIOUS = 0.5
# A multiplier, or a speed, vanishes linearly in time, and the displacement by a late release is of second order: the
# accuracy of its time, as a part of the step, for a tolerance of 1. A gap is followed to rounding, and so is a
# multiplier that jumps: within that accuracy it still falls by more than this share of its whole fall.
RELEASED, STEEP = 3e-3, 0.1
MOST_ITERATIONS = 100
# The minimum of a function is located to this part of the step.
MINIMUM = 1e-4
# The time of an event that does not happen in the step.
NEVER = np.inf


@inner
def root_of(run: EventWorkspace, which: int, r: int, a: float, first: float, b: float, last: float) -> float:
    """Find where the function becomes negative that is ``first`` >= 0 at a and ``last`` < 0 at b > a.

    It is located to rounding, or, of a multiplier or a speed, as precisely as a release needs.
    Source: Chandrupatla (1997).
    """
    if first <= 0.0:
        return a
    c, third, share, state, steep = a, first, 0.5, run.state[0], 0.0
    rounding = 2.0 * EPS * max(abs(state.t) / max(state.step, 1e-300), 1.0)
    allowed = rounding
    if which in (RELEASE, MOTION):
        allowed, steep = max(rounding, RELEASED * np.sqrt(state.tol / state.size)), STEEP * (first - last)
    for _ in range(MOST_ITERATIONS):
        middle = a + share * (b - a)
        value = event_function_at(run, which, r, middle)
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
def first_closing(run: EventWorkspace, r: int, latest: float) -> float:
    """Find when the gap of row r closes, at a node or between nodes; NEVER if not until ``latest``.

    Each minimum between nodes is located: no interpolant of values and slopes sees how deep two small discs pass
    through each other that fly past.
    """
    before, falling = np.inf, 0.0
    for j in range(PARTS + 1):
        left, end = (j - 1) / PARTS, j / PARTS
        value, slope = gap_and_slope_at(run, r, end)
        low = value
        if not value < 0.0 and falling < 0.0 < slope:
            end = root_of(run, CLOSING, r, left, -falling, end, -slope)
            low = event_function_at(run, GAP, r, end)
        if low < 0.0:
            return root_of(run, GAP, r, left, before, end, low) if j > 0 else 0.0
        if j / PARTS > latest:
            break
        before, falling = value, slope
    return NEVER


@inner
def lowest_between(run: EventWorkspace, which: int, r: int, left: float, right: float) -> tuple[float, float]:
    """Find the minimum by golden section, and its time; the first negative value ends the search."""
    golden = 0.6180339887498949
    a, b = right - golden * (right - left), left + golden * (right - left)
    at_a, at_b = event_function_at(run, which, r, a), event_function_at(run, which, r, b)
    while right - left > MINIMUM and at_a >= 0.0 and at_b >= 0.0:
        if at_a < at_b:
            right, b, at_b = b, a, at_a
            a = right - golden * (right - left)
            at_a = event_function_at(run, which, r, a)
        else:
            left, a, at_a = a, b, at_b
            b = left + golden * (right - left)
            at_b = event_function_at(run, which, r, b)
    return (a, at_a) if at_a < at_b else (b, at_b)


@inner
def first_negative(run: EventWorkspace, which: int, r: int, latest: float) -> float:
    """Find when the function of row r is negative, at a node or between nodes; NEVER if not until ``latest``."""
    two, one = np.inf, np.inf
    for j in range(PARTS + 1):
        left, before, end = (j - 1) / PARTS, one, j / PARTS
        value = event_function_at(run, which, r, end)
        low = value
        if not value < 0.0 and j > 1 and sinks(two, one, value):
            left, before = (j - 2) / PARTS, two
            end, low = lowest_between(run, which, r, left, j / PARTS)
        if low < 0.0:
            return root_of(run, which, r, left, before, end, low) if j > 0 else 0.0
        if j / PARTS > latest:
            break
        two, one = one, value
    return NEVER


@inner
def sinks(before: float, value: float, after: float) -> bool:
    """Return whether the parabola through three values falls low around the middle one."""
    if not value <= min(before, after):
        return False
    bend = before - 2.0 * value + after
    depth = (after - before) * (after - before) / (8.0 * bend) if bend > 0.0 else 0.0
    return value - depth <= SUSPICIOUS * value


@inner
def first_event(run: EventWorkspace) -> tuple[float, int]:
    """Find the part of the step after which something changes, or NEVER, and the row whose gap closes, or -1."""
    state, system, x = run.state[0], system_at(run.system), run.x
    rows, sets, near, touching = system.rows, system.sets, system.near, TOUCHING * run.state[0].size
    found, closing = NEVER, -1
    state.code = OK
    if run.active.number[0] > 0 and may_release(run):
        found = first_negative(run, RELEASE, -1, found)
    radius = bound_displacement(run) + touching
    if sets.address != 0:
        call_python(sets, state.t, x, VELOCITIES)
    if near.radius[0] > TOO_WIDE * radius:
        near.radius[0] = -1.0
    list_sorted(system, state.t, x, radius, EVENT_MARGIN)
    for q in range(near.number[0]):
        r = near.row[q]
        if run.contact[r] == CLOSED and may_move(run, r):
            moves = first_negative(run, MOTION, r, found)
            if moves < found:
                found, closing = moves, -1
        if run.contact[r] == ACTIVE or stays_open(run, r):
            continue
        if is_timed(sets, rows.row[r]):
            call_python(sets, state.t, x, VELOCITIES)
        value = gap(rows, sets, r, x)
        # The gap is one over the length of the gradient, but the Lipschitz constant is that of g.
        if value <= rows.row[r].lipschitz * radius / scaled_length(rows, sets, r) + touching:
            # Rounding makes a gap smaller, and of a closed row between active ones so does the integrator.
            below = max(touching, state.tol) if run.contact[r] == CLOSED else touching
            state.level = min(value - below, 0.0)
            closes = first_closing(run, r, found)
            if closes < found:
                found, closing = closes, r if state.level == 0.0 else -1
    return found, closing


@inner
def may_release(run: EventWorkspace) -> bool:
    """Return whether a multiplier falls, in one of the stages, much below its values at the ends of the step."""
    last = run.pair.stages
    for k in range(run.active.number[0]):
        low = min(run.multiplier[0, k], run.multiplier[last, k])
        if low < 0.0:
            return True
        for i in range(1, last + 1 + run.pair.more):
            if run.multiplier[i, k] < SUSPICIOUS * low:
                return True
    return False


@inner
def bound_displacement(run: EventWorkspace) -> float:
    """Bound how far any particle and set move in the step; for each particle, ``bend`` is how far it leaves its line.

    x + theta (F_0 + (1 - theta) (F_1 + theta (...))) leaves the line by no more than (|F_1| + |F_2| + ...) / 4.
    """
    state, system, carried, farthest = run.state[0], system_at(run.system), 0.0, 0.0
    d = system.sets.shift.shape[1]
    for j in range(1, PARTS + 1):
        carried = max(carried, carry(system, state.t, run.x, state.t + j / PARTS * state.step))
    for i in range(run.bend.size):
        bend, way = 0.0, 0.0
        for j in range(run.pair.terms):
            square = 0.0
            for k in range(d):
                square += run.dense[j, i * d + k] * run.dense[j, i * d + k]
            if j == 0:
                way = np.sqrt(square)
            else:
                bend += 0.25 * np.sqrt(square)
        run.bend[i] = bend
        farthest = max(farthest, way + bend)
    return farthest + SAFETY * carried


@inner
def stays_open(run: EventWorkspace, r: int) -> bool:
    """Return whether a row of a set that does not move is met neither on the lines of the step nor within ``bend``."""
    rows, sets = system_at(run.system).rows, system_at(run.system).sets
    row, d = rows.row[r], sets.shift.shape[1]
    if row.kind != DISTANCE or row.plain == 0 or is_timed(sets, row):
        return False
    start, along, way, end = 0.0, 0.0, 0.0, 0.0
    for k in range(d):
        i, j = row.i * d + k, row.j * d + k
        if row.j >= 0:
            arrow, step = run.x[i] - run.x[j], run.dense[0, i] - run.dense[0, j]
        else:
            arrow, step = run.x[i] - rows.coefficient[rows.start[r] + k], run.dense[0, i]
        start += arrow * arrow
        along += arrow * step
        way += step * step
        end += (arrow + step) * (arrow + step)
    bend = run.bend[row.i] + (run.bend[row.j] if row.j >= 0 else 0.0)
    if row.sign < 0.0:
        return bool(np.sqrt(max(start, end)) + bend < row.length)
    nearest = start
    if along < 0.0:
        nearest = end if -along >= way else start - along * along / way
    limit = row.length + bend
    return bool(nearest > limit * limit)


@inner
def may_move(run: EventWorkspace, r: int) -> bool:
    """Return whether a closed row that is not active has a speed that is not zero, in one of the stages.

    The stages are as dense as the nodes of ``first_negative``, where each evaluation costs a factorisation. Such a row
    is the contact of a disc that falls along a wall.
    """
    state, system, pair = run.state[0], system_at(run.system), run.pair
    rows, gradient = system.rows, system.program.gradient
    if system.sets.address != 0:
        return True
    for i in range(1, pair.stages + 1):
        for p in range(rows.start[r], rows.stop[r]):
            column, way = rows.column[p], 0.0
            for j in range(i):
                way += pair.a[i, j] * run.rate[j, column]
            run.point[column] = run.x[column] + state.step * way
        linearise(rows, system.sets, r, run.point, gradient)
        state.theta = -1.0
        if abs(row_dot(rows, r, gradient, run.rate[i])) > state.zero:
            return True
    return False
