"""Many contacts at once: the sparse factor of their Gram matrix, in a function that kernels call by its address.

Runs of few particles, which never have so many contacts, are compiled without it.
"""

from functools import partial
from typing import Any

from dincl.compiled import c_function, call, inner
from dincl.compiled.calls import signature
from dincl.events.runge_kutta import EPS
from dincl.events.workspace import KIND, TOUCHING, EventWorkspace
from dincl.rows.table import gap
from dincl.solvers.active_set import CYCLES, nearest_sparse
from dincl.solvers.sparse_factor import FEW, analyse, covers, refactor, solve_sparse
from dincl.system.arrays import OK, SINGULAR, system_at

# Requests: the velocity and the multipliers of the touching rows; the factor of the active rows; to solve with it.
VELOCITY, FACTOR, SOLVE = range(3)
# Returned where the rows have no such factor.
NO_FACTOR = -1
# Mean phases to look ahead for rows that are analysed with the touching ones.
AHEAD = 10.0

# int64 f(run, request, rows, speed)
MANY: Any = signature(int, KIND, int, int, float)
call_many = call(MANY)


@partial(c_function, MANY)
def many_contacts(run: EventWorkspace, request: int, count: int, speed: float) -> int:
    """Do what is requested; return OK, how it failed, or NO_FACTOR."""
    system, gram, active = system_at(run.system), run.gram, run.active
    rows, program = system.rows, system.program
    if request == VELOCITY:
        if covers(run.touching, count, gram) or analyse(rows, run.touching, list_upcoming(run, count), gram):
            return int(nearest_sparse(rows, run.touching, count, program, gram, speed))
        return CYCLES
    if request == FACTOR:
        if not (covers(active.row, count, gram) or analyse(rows, active.row, count, gram)):
            return NO_FACTOR
        for k in range(gram.number[0]):
            gram.used[k] = 0
        for k in range(count):
            gram.used[gram.place[active.row[k]]] = 1
        return OK if refactor(rows, program.gradient, gram, 4.0 * EPS) == 0 else SINGULAR
    for k in range(gram.number[0]):
        gram.right[k] = 0.0
    for k in range(count):
        gram.right[gram.place[active.row[k]]] = active.right[k]
    solve_sparse(gram)
    for k in range(count):
        active.right[k] = gram.right[gram.place[active.row[k]]]
    return OK


@inner
def list_upcoming(run: EventWorkspace, count: int) -> int:
    """List after the touching rows those that touch soon if velocities do not change; the number of all.

    They are analysed with the others, switched off, so that the analysis serves for more than one event.
    """
    state, system, x, point, rate = run.state[0], system_at(run.system), run.x, run.point, run.rate[0]
    rows, sets, near, found = system.rows, system.sets, system.near, count
    for k in range(x.size):
        point[k] = x[k] + AHEAD * state.mean_phase * rate[k]
    for q in range(near.number[0]):
        r = near.row[q]
        touches = gap(rows, sets, r, x) <= TOUCHING * state.size
        if not touches and found < count + FEW and gap(rows, sets, r, point) <= 0.0:
            run.touching[found] = r
            found += 1
    return found
