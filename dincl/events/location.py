"""Event location: the first gap that closes, multiplier that vanishes or closed row that moves during a step."""

import numpy as np

from dincl.compiled import inner
from dincl.events.contacts import TOUCHING
from dincl.events.event_functions import MULTIPLIERS, NEVER, PARTS, SUSPICIOUS, first_negative
from dincl.events.workspace import ACTIVE, CLOSED, EventWorkspace
from dincl.neighbours import EVENT_MARGIN, SHORT_STEP_MARGIN, TOO_WIDE
from dincl.rows.table import DISTANCE, VELOCITIES, call_python, gap, is_timed, linearise
from dincl.solvers.envelope_factor import row_dot
from dincl.steps.programs import carry, list_sorted
from dincl.system.arrays import OK, system_at

# Sets are taken to be carried up to so many times as far as they are at the nodes.
SAFETY = 2.0


@inner
def first_event(run: EventWorkspace) -> tuple[float, int]:
    """Find the part of the step after which something changes, or NEVER, and the row whose gap closes, or -1."""
    state, system, x = run.state[0], system_at(run.system), run.x
    rows, sets, near, touching = system.rows, system.sets, system.near, TOUCHING * run.state[0].size
    found, closing = NEVER, -1
    state.code = OK
    if run.active.number[0] > 0 and may_release(run):
        found = first_negative(run, MULTIPLIERS, found)
    radius = bound_displacement(run) + touching
    if sets.address != 0:
        call_python(sets, state.t, x, VELOCITIES)
    if state.many != 0 and near.radius[0] > TOO_WIDE * radius:
        near.radius[0] = -1.0
    list_sorted(run.system, state.t, x, radius, EVENT_MARGIN if state.many == 0 else SHORT_STEP_MARGIN)
    for q in range(near.number[0]):
        r = near.row[q]
        if run.contact[r] == CLOSED and may_move(run, r):
            moves = first_negative(run, run.contact.size + r, found)
            if moves < found:
                found, closing = moves, -1
        if run.contact[r] == ACTIVE or stays_open(run, r):
            continue
        if is_timed(sets, rows.row[r]):
            call_python(sets, state.t, x, VELOCITIES)
        value = gap(rows, sets, r, x)
        if value <= rows.row[r].lipschitz * radius + touching:
            # Rounding makes a gap smaller, and of a closed row between active ones so does the integrator.
            below = max(touching, state.tol) if run.contact[r] == CLOSED else touching
            state.level = min(value - below, 0.0)
            closes = first_negative(run, r, found)
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
    state, d, carried, farthest = run.state[0], system_at(run.system).sets.shift.shape[1], 0.0, 0.0
    for j in range(1, PARTS + 1):
        carried = max(carried, carry(run.system, state.t, run.x, state.t + j / PARTS * state.step))
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
    if row.kind != DISTANCE or is_timed(sets, row):
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

    For runs of many particles, whose steps are short: the stages are as dense as the nodes of ``first_negative``, where
    each evaluation costs a factorisation. Such a row is the contact of a disc that falls along a wall.
    """
    state, system, pair = run.state[0], system_at(run.system), run.pair
    rows, gradient = system.rows, system.program.gradient
    if state.many == 0 or system.sets.address != 0:
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
