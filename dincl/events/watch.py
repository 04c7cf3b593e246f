"""The first event on the dense output of a step: a gap that closes, a push that vanishes, a contact that stirs."""

import numpy as np

from dincl.compiled import inner
from dincl.events.arrays import CLOSED, HELD, march_at
from dincl.events.choice import TOUCHING
from dincl.events.signals import NEVER, PARTS, PUSHES, SUSPICIOUS, first_negative
from dincl.neighbours import EVENT_MARGIN, SHORT_STEP_MARGIN, TOO_WIDE
from dincl.rows.table import DISTANCE, VELOCITIES, call_python, gap, linearise
from dincl.solvers.factor import times
from dincl.steps.catch_up import carry, list_sorted
from dincl.system.arrays import OK, system_at

# Sets are taken to be carried up to so many times as far as they are at the nodes.
SAFETY = 2.0


@inner
def is_suspicious(run: int) -> bool:
    """Whether a push falls, in one of the stages, much below what it has at the ends of the step."""
    march = march_at(run)
    last = march.pair.stages
    for k in range(march.held.number[0]):
        low = min(march.push[0, k], march.push[last, k])
        if low < 0.0:
            return True
        for i in range(1, last + 1 + march.pair.more):
            if march.push[i, k] < SUSPICIOUS * low:
                return True
    return False


@inner
def make_room(run: int) -> float:
    """How far the dense output is from straight lines for each particle, at most, and the longest way of all.

    x + theta (F_0 + (1 - theta) (F_1 + theta (...))) leaves the line by no more than (|F_1| + |F_2| + ...) / 4.
    """
    march = march_at(run)
    state, d, carried, farthest = march.state[0], system_at(march.place).sets.shift.shape[1], 0.0, 0.0
    for j in range(1, PARTS + 1):
        carried = max(carried, carry(march.place, state.now, state.now + j / PARTS * state.made))
    for i in range(march.bend.size):
        bend, way = 0.0, 0.0
        for j in range(march.pair.terms):
            square = 0.0
            for k in range(d):
                square += march.dense[j, i * d + k] * march.dense[j, i * d + k]
            if j == 0:
                way = np.sqrt(square)
            else:
                bend += 0.25 * np.sqrt(square)
        march.bend[i] = bend
        farthest = max(farthest, way + bend)
    return farthest + SAFETY * carried


@inner
def stays_clear(run: int, r: int) -> bool:
    """Whether a row at rest is not met on the straight lines of the step, nor as near as the dense output is."""
    march = march_at(run)
    rows, sets = system_at(march.place).rows, system_at(march.place).sets
    row, d = rows.row[r], sets.shift.shape[1]
    if row.kind != DISTANCE or (row.j < 0 and sets.address != 0):
        return False
    start, along, way, end = 0.0, 0.0, 0.0, 0.0
    for k in range(d):
        i, j = row.i * d + k, row.j * d + k
        if row.j >= 0:
            arrow, step = march.x[i] - march.x[j], march.dense[0, i] - march.dense[0, j]
        else:
            arrow, step = march.x[i] - rows.coefficient[rows.start[r] + k], march.dense[0, i]
        start += arrow * arrow
        along += arrow * step
        way += step * step
        end += (arrow + step) * (arrow + step)
    bend = march.bend[row.i] + (march.bend[row.j] if row.j >= 0 else 0.0)
    if row.sign < 0.0:
        return bool(np.sqrt(max(start, end)) + bend < row.length)
    nearest = start
    if along < 0.0:
        nearest = end if -along >= way else start - along * along / way
    limit = row.length + bend
    return bool(nearest > limit * limit)


@inner
def may_stir(run: int, r: int) -> bool:
    """Whether a closed row that is not held has a speed that is not zero, in one of the stages.

    For runs of many particles, whose steps are short: the stages are as dense as the nodes at which ``first_negative``
    looks, where each look costs a factorisation. Such a row is that of a disc which falls along a wall.
    """
    march = march_at(run)
    state, system, pair = march.state[0], system_at(march.place), march.pair
    rows, gradient = system.rows, system.program.gradient
    if state.cuts == 0 or system.sets.address != 0:
        return True
    for i in range(1, pair.stages + 1):
        for p in range(rows.start[r], rows.stop[r]):
            column, way = rows.column[p], 0.0
            for j in range(i):
                way += pair.a[i, j] * march.rate[j, column]
            march.point[column] = march.x[column] + state.made * way
        linearise(rows, system.sets, r, march.point, gradient)
        state.theta = -1.0
        if abs(times(rows, r, gradient, march.rate[i])) > state.slow:
            return True
    return False


@inner
def first_event(run: int) -> tuple[float, int]:
    """The part of the step after which something changes, NEVER if nothing does, and the row whose gap closes or -1."""
    march = march_at(run)
    state, system, x = march.state[0], system_at(march.place), march.x
    rows, sets, near, touching = system.rows, system.sets, system.near, TOUCHING * march.state[0].size
    found, closing = NEVER, -1
    state.code = OK
    if march.held.number[0] > 0 and is_suspicious(run):
        found = first_negative(run, PUSHES, found)
    reach = make_room(run) + touching
    if sets.address != 0:
        call_python(sets, state.now, x, VELOCITIES)
    if state.cuts != 0 and near.radius[0] > TOO_WIDE * reach:
        near.radius[0] = -1.0
    list_sorted(march.place, state.now, x, reach, EVENT_MARGIN if state.cuts == 0 else SHORT_STEP_MARGIN)
    for q in range(near.number[0]):
        r = near.row[q]
        if march.closed[r] == CLOSED and may_stir(run, r):
            stirs = first_negative(run, r + march.closed.size, found)
            if stirs < found:
                found, closing = stirs, -1
        if march.closed[r] == HELD or stays_clear(run, r):
            continue
        if sets.address != 0 and rows.row[r].j < 0:
            call_python(sets, state.now, x, VELOCITIES)
        value = gap(rows, sets, r, x)
        if value <= rows.row[r].lipschitz * reach + touching:
            # Rounding takes a gap further down, and that of a closed row which others hold so does the integrator.
            below = max(touching, state.tol) if march.closed[r] == CLOSED else touching
            state.level = min(value - below, 0.0)
            meets = first_negative(run, r, found)
            if meets < found:
                found, closing = meets, r if state.level == 0.0 else -1
    return found, closing
