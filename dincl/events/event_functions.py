"""Functions of time that must not become negative during a step, on its dense output.

They are the gap of an open row; the smallest multiplier of the active rows; for a closed row that is not active how far
its speed is below the one that changes its state. Each is a function of the part theta of the step;
``dincl.events.location`` finds the first zeros.
"""

import numpy as np

from dincl.compiled import inner
from dincl.events.motion import dense_state, dense_velocity, set_speed
from dincl.events.runge_kutta import dense_value
from dincl.events.workspace import SPARE, EventWorkspace
from dincl.rows.table import CALLBACK, DISTANCE, VELOCITIES, call_python, gap, is_timed, linearise
from dincl.solvers.envelope_factor import row_dot
from dincl.system.arrays import OK, system_at

# The gap of row r; how fast it falls, which becomes negative at a minimum of the gap; the smallest multiplier of the
# active rows; by how much the speed of the closed row r is below the threshold.
GAP, CLOSING, RELEASE, MOTION = range(4)
# Speeds and multipliers count as negative below this many times the threshold of the decision of contacts.
NEGATIVE = 10.0


@inner
def gap_and_slope_at(run: EventWorkspace, r: int, theta: float) -> tuple[float, float]:
    """Compute a number with the sign of the gap of row r less ``state.level``, and its derivative after theta."""
    state, system, dense, x, terms = run.state[0], system_at(run.system), run.dense, run.x, run.pair.terms
    row, rows, sets, d, h = system.rows.row[r], system.rows, system.sets, system.sets.shift.shape[1], state.step
    curved = row.kind == CALLBACK or sets.general[row.family] != 0 or (row.kind == DISTANCE and row.plain == 0)
    if is_timed(sets, row) or curved:
        dense_state(run, theta)
        call_python(sets, state.t + theta * h, run.point, VELOCITIES)
    value, slope = 0.0, 0.0
    if curved:
        value = linearise(rows, sets, r, run.point, system.program.gradient) - state.level
        slope = row_dot(rows, r, system.program.gradient, run.rate[SPARE]) - h * set_speed(system, r)
        if np.isnan(value):  # at a centre there is no gradient, but there is a gap
            return gap(rows, sets, r, run.point) - state.level, 0.0
        return value, slope
    if row.kind == DISTANCE:
        # sign (|X_i - X_j|^2 - L^2) has the sign of the gap, and no root.
        for k in range(d):
            one, speed = dense_value(dense, terms, x[row.i * d + k], row.i * d + k, theta)
            if row.j >= 0:
                other, rate = dense_value(dense, terms, x[row.j * d + k], row.j * d + k, theta)
            else:
                other = rows.coefficient[rows.start[r] + k] + sets.shift[row.family, k]
                rate = h * sets.speed[row.family, k]
            value += (one - other) * (one - other)
            slope += 2.0 * (one - other) * (speed - rate)
        length = row.length + row.sign * state.level
        return row.sign * (value - length * length), row.sign * slope
    for p in range(rows.start[r], rows.stop[r]):
        column = rows.column[p]
        place, speed = dense_value(dense, terms, x[column], column, theta)
        value += rows.coefficient[p] * (place - sets.shift[row.family, column % d])
        slope += rows.coefficient[p] * (speed - h * sets.speed[row.family, column % d])
    return value - row.length - state.level * np.sqrt(row.square), slope


@inner
def event_function_at(run: EventWorkspace, which: int, r: int, theta: float) -> float:
    """Compute one of the functions at theta."""
    if which == RELEASE:
        return least_multiplier_at(run, theta)
    if which == MOTION:
        return speed_margin_at(run, r, theta)
    value, slope = gap_and_slope_at(run, r, theta)
    return -slope if which == CLOSING else value


@inner
def least_multiplier_at(run: EventWorkspace, theta: float) -> float:
    """Compute the smallest multiplier of the active rows; negative where there is no velocity."""
    state, found = run.state[0], np.inf
    multiplier = run.multiplier[SPARE]
    if theta == 0.0:
        multiplier = run.multiplier[0]
    elif theta == 1.0:
        multiplier = run.multiplier[run.pair.stages]
    elif not has_velocity(run, theta):
        return -1.0
    for k in range(run.active.number[0]):
        found = min(found, multiplier[k])
    return float(NEGATIVE * state.zero + found)


@inner
def speed_margin_at(run: EventWorkspace, r: int, theta: float) -> float:
    """Compute by how much the speed of a closed row is below the threshold; negative where there is no velocity."""
    state, system = run.state[0], system_at(run.system)
    if not has_velocity(run, theta):
        return -1.0
    call_python(system.sets, state.t + theta * state.step, run.point, VELOCITIES)
    linearise(system.rows, system.sets, r, run.point, system.program.gradient)
    speed = row_dot(system.rows, r, system.program.gradient, run.rate[SPARE]) - set_speed(system, r)
    return float(NEGATIVE * state.zero - abs(speed))


@inner
def has_velocity(run: EventWorkspace, theta: float) -> bool:
    """Compute the velocity at theta, and its multipliers, unless they are known; return whether that succeeded."""
    state = run.state[0]
    if state.theta != theta:
        state.code = dense_velocity(run, theta)
        state.theta = theta
    return bool(state.code == OK)
