"""The smooth motion between two events, x' = F + sum_k lambda_k n_k with n_k . x' = b_k for the active contacts k.

n_k are unit gradients, b_k the speeds of their sets along them. The multipliers lambda solve a system with the Gram
matrix of the n_k; the Newton steps back onto g_k = 0 use the same factor.
"""

import numpy as np

from dincl.compiled import inner
from dincl.compiled.arrays import Floats
from dincl.events.many_contacts import FACTOR, NO_FACTOR, SOLVE, call_many
from dincl.events.runge_kutta import EPS, dense_value
from dincl.events.workspace import SPARE, EventWorkspace
from dincl.rows.table import VELOCITIES, call_python, linearise
from dincl.solvers.envelope_factor import add_row, append, border, clear, orthogonal_square, row_dot, solve_envelope
from dincl.solvers.sparse_factor import SPARSE_FROM
from dincl.system.arrays import COINCIDENT, OK, SETS, SINGULAR, SystemArrays, evaluate, system_at

# Newton steps back onto the active contacts; from a state that is off by an integration error one or two are enough.
MOST_CORRECTIONS = 8
# Gaps at most this large, relative to the size of the problem, need no step back.
MET = 2e-15
# Part of itself to which a Newton step must shrink the largest gap, if its factor is to serve for the next one.
SHRINKS = 0.1


@inner
def linearise_active(run: EventWorkspace, t: float, x: Floats) -> int:
    """Write the unit gradients of the active rows at x, and their gaps into ``bound``."""
    system, active = system_at(run.system), run.active
    if call_python(system.sets, t, x, VELOCITIES) != 0:
        return SETS
    for k in range(active.number[0]):
        r = active.row[k]
        gap = linearise(system.rows, system.sets, r, x, system.program.gradient)
        if gap != gap:
            system.offending[0] = r
            return COINCIDENT
        system.program.bound[r] = gap
    return OK


@inner
def factorise(run: EventWorkspace) -> int:
    """Factorise the Gram matrix of the active rows: by a sparse factor if they are many, else by its envelope."""
    system, active = system_at(run.system), run.active
    rows, gradient, count = system.rows, system.program.gradient, active.number[0]
    if run.many != 0 and count >= SPARSE_FROM:
        code = call_many(run.many, run, FACTOR, count, 0.0)
        if code != NO_FACTOR:
            return int(code)
    run.gram.number[1] = 0
    clear(active)
    for k in range(count):
        r = active.row[k]
        border(rows, r, gradient, active)
        square = orthogonal_square(rows, r, gradient, active)
        if not square > 4.0 * EPS:
            active.number[0] = count
            return SINGULAR
        append(rows, active, r, square)
    return OK


@inner
def is_factorised(run: EventWorkspace) -> bool:
    """Return whether the sparse factor is one of the active rows, though of another state."""
    active, gram = run.active, run.gram
    if active.number[0] == 0 or gram.number[1] != active.number[0]:
        return False
    for k in range(active.number[0]):
        place = gram.place[active.row[k]]
        if place < 0 or gram.used[place] == 0:
            return False
    return True


@inner
def solve_active(run: EventWorkspace) -> None:
    """Solve with the factor for ``right`` of the active rows, in place."""
    if run.gram.number[1] == 0:
        solve_envelope(run.active)
    else:
        call_many(run.many, run, SOLVE, run.active.number[0], 0.0)


@inner
def set_speed(system: SystemArrays, r: int) -> float:
    """Compute b_r, the speed of the set of row r along its gradient."""
    rows, speed, total = system.rows, system.sets.speed, 0.0
    if system.sets.address == 0:
        return 0.0
    if system.sets.general[rows.row[r].family] != 0:
        return -float(system.sets.rate[r])
    for p in range(rows.start[r], rows.stop[r]):
        total += system.program.gradient[p] * speed[rows.row[r].family, rows.column[p] % speed.shape[1]]
    return total


@inner
def velocity_at(run: EventWorkspace, t: float, x: Floats, rate: Floats, multiplier: Floats) -> int:
    """Write x' into ``rate``, and the multipliers, which are refined once."""
    system, active = system_at(run.system), run.active
    rows, gradient, right = system.rows, system.program.gradient, active.right
    code = evaluate(system, t, x, rate)
    if code != OK or active.number[0] == 0:
        return code
    code = linearise_active(run, t, x)
    if code == OK:
        code = factorise(run)
    if code != OK:
        return code
    count = active.number[0]
    for k in range(count):
        multiplier[k] = 0.0
    for _ in range(2):
        for k in range(count):
            r = active.row[k]
            right[k] = set_speed(system, r) - row_dot(rows, r, gradient, rate)
        solve_active(run)
        for k in range(count):
            multiplier[k] += right[k]
            add_row(rows, active.row[k], gradient, right[k], rate)
    return OK


@inner
def restore(run: EventWorkspace, t: float, x: Floats) -> int:
    """Move x back onto g(t, x) = 0 of the active rows, along their gradients."""
    system, active = system_at(run.system), run.active
    if active.number[0] == 0:
        return OK
    factorised, last = is_factorised(run), np.inf
    for _ in range(MOST_CORRECTIONS):
        code, largest = linearise_active(run, t, x), 0.0
        if code != OK:
            return code
        for k in range(active.number[0]):
            largest = max(largest, abs(system.program.bound[active.row[k]]))
        if largest <= MET * run.state[0].size:
            break
        # A sparse factor of a state nearby serves as long as gaps shrink by it.
        factorised, last = factorised and largest <= SHRINKS * last, largest
        if not factorised:
            code = factorise(run)
            if code != OK:
                return code
        for k in range(active.number[0]):
            active.right[k] = system.program.bound[active.row[k]]
        solve_active(run)
        for k in range(active.number[0]):
            add_row(system.rows, active.row[k], system.program.gradient, -active.right[k], x)
    return OK


@inner
def dense_state(run: EventWorkspace, theta: float) -> None:
    """Write the dense output at a part of the step into ``point``, its derivative after theta into the spare rate."""
    x, dense, point, slope, terms = run.x, run.dense, run.point, run.rate[SPARE], run.pair.terms
    run.state[0].theta = -1.0
    for k in range(x.size):
        point[k], slope[k] = dense_value(dense, terms, x[k], k, theta)


@inner
def dense_velocity(run: EventWorkspace, theta: float) -> int:
    """Write the velocity at the dense output into the spare rate, and its multipliers."""
    state = run.state[0]
    dense_state(run, theta)
    return velocity_at(run, state.t + theta * state.step, run.point, run.rate[SPARE], run.multiplier[SPARE])
