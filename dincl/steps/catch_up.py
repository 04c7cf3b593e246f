"""Steps of the catch-up schemes."""

from typing import Any

import numpy as np

from dincl.compiled import inner
from dincl.compiled.arrays import Floats
from dincl.drifts.functions import call_drift
from dincl.neighbours import ROW_MARGIN
from dincl.rows.candidates import distance_from_search, find_candidates, note_search, sort_candidates
from dincl.rows.table import DISPLACEMENTS, GRADIENTS, call_python, gap, linearise
from dincl.solvers.active_set import nearest
from dincl.solvers.factor import add, times
from dincl.steps.loop import Stepping, step_function, stepping_at
from dincl.system.arrays import (
    COINCIDENT,
    MISSED,
    OK,
    PYTHON,
    SETS,
    TOO_FAR,
    evaluate,
    farthest,
    longest,
    system_at,
)

# A projection that ends farther away than the rows reach is repeated with twice its distance, at most this often.
MOST_REACHES = 60
# Linearisations for one projection onto a curved set; a y that violates by less than this part of tol is its own.
MOST_RELINEARISATIONS, NEGLIGIBLE = 60, 1e-3


@inner
def list_sorted(place: int, t: float, x: Floats, reach: float, margin: float) -> bool:
    """See that every row that matters within ``reach`` of x is listed, in the order of the cloud; false on failure.

    A new list is made for ``margin`` times the reach, see ``dincl.neighbours``.
    """
    system = system_at(place)
    sets, near = system.sets, system.near
    if distance_from_search(sets, x, near) + reach <= near.radius[0]:
        return True
    if near.search == 0:
        find_candidates(system.rows, sets, x, margin * reach, near)
    else:
        near.radius[0] = margin * reach
        if call_drift(near.search, t, x, near.reference, x.size, sets.shift.shape[1], near.radius) != 0:
            return False
        note_search(sets, x, margin * reach, near)
    sort_candidates(system.rows, x, sets.shift.shape[1], near)
    return True


@inner
def linearise_near(place: int, t: float, x: Floats) -> int:
    """The listed rows linearised at x: a_r . z >= bound_r with unit gradients."""
    system = system_at(place)
    rows, sets, near, program = system.rows, system.sets, system.near, system.program
    if call_python(sets, t, x, GRADIENTS) != 0:
        return SETS
    for q in range(near.number[0]):
        r = near.row[q]
        value = linearise(rows, sets, r, x, program.gradient)
        if value != value:
            system.blamed[0] = r
            return COINCIDENT
        program.bound[r] = times(rows, r, program.gradient, x) - value
    return OK


@inner
def certify(place: int, t: float) -> tuple[int, float]:
    """Linearise the listed rows at z, and give the residual of z as the nearest point of the curved set to y."""
    system = system_at(place)
    program, near = system.program, system.near
    code, residual, z = linearise_near(place, t, program.z), 0.0, program.z
    for k in range(z.size):
        program.direction[k] = z[k] - program.y[k]
    for q in range(near.number[0]):
        r = near.row[q]
        push = program.multiplier[r]
        value = times(system.rows, r, program.gradient, z) - program.bound[r]
        residual = max(residual, -value, abs(min(push, value)))
        if push > 0.0:
            add(system.rows, r, program.gradient, -push, program.direction)
    for k in range(z.size):
        residual = max(residual, abs(program.direction[k]))
    return code, residual


@inner
def is_inside(place: int, t: float, allowed: float) -> bool:
    """Whether y violates no listed row by more than ``allowed``."""
    system = system_at(place)
    if call_python(system.sets, t, system.program.y, GRADIENTS) != 0:
        return False
    for q in range(system.near.number[0]):
        if not gap(system.rows, system.sets, system.near.row[q], system.program.y) >= -allowed:
            return False
    return True


@inner
def carry(place: int, t: float, later: float) -> float:
    """How far each set is carried from t to a later time, into ``move``; the longest way."""
    system = system_at(place)
    if system.sets.address == 0 or later == t:
        return 0.0
    move, shift, longest = system.move, system.sets.shift, 0.0
    call_python(system.sets, later, system.program.y, DISPLACEMENTS)
    for f in range(move.shape[0]):
        for k in range(move.shape[1]):
            move[f, k] = shift[f, k]
    call_python(system.sets, t, system.program.y, DISPLACEMENTS)
    for f in range(move.shape[0]):
        square = 0.0
        for k in range(move.shape[1]):
            move[f, k] -= shift[f, k]
            square += move[f, k] * move[f, k]
        longest = max(longest, np.sqrt(square))
    return longest


@inner
def shift_bounds(place: int) -> None:
    """Carry the linearised rows along with their sets."""
    system = system_at(place)
    rows, near, program = system.rows, system.near, system.program
    d = system.move.shape[1]
    for q in range(near.number[0]):
        r = near.row[q]
        for p in range(rows.start[r], rows.stop[r]):
            program.bound[r] += program.gradient[p] * system.move[rows.row[r].family, rows.column[p] % d]


@inner
def project(place: int, t: float, around: Floats, reach: float, later: float, exact: bool, tol: float) -> int:
    """Project y onto S(t), searched from ``around``, or onto its linearisation there, carried to a later time."""
    system = system_at(place)
    d = system.sets.shift.shape[1]
    carried = carry(place, t, later)
    if call_python(system.sets, t, around, DISPLACEMENTS) != 0:
        return SETS
    for _ in range(MOST_REACHES):
        if not list_sorted(place, t, around, reach, ROW_MARGIN):
            return PYTHON
        code = solve(place, t, around, later, exact, tol)
        if code != OK:
            return code
        distance = farthest(system.program.z, around, d) + carried
        if distance <= reach:
            return OK
        reach = 2.0 * distance
    return TOO_FAR


@inner
def solve(place: int, t: float, around: Floats, later: float, exact: bool, tol: float) -> int:
    """The same with the listed rows; onto a curved set by linearising again at the point reached, for the same y."""
    system = system_at(place)
    program, solving = system.program, system.solving
    solving.called[0] = 0.0
    if solving.whole != 0:
        question = solving.question
        question[0], question[1], question[2], question[3] = t, later, 1.0 if exact else 0.0, tol
        code = int(call_drift(solving.address, t, around, program.z, place, 0, question))
        program.answer[2] += solving.called[0]
        return code
    if exact and is_inside(place, t, NEGLIGIBLE * tol):
        for k in range(program.z.size):
            program.z[k] = program.y[k]
        return OK
    code = linearise_near(place, t, around)
    if later != t and system.sets.address != 0:
        shift_bounds(place)
    residual = 0.0
    for _ in range(MOST_RELINEARISATIONS if exact else 1):
        if code == OK:
            code = call_drift(solving.address, tol, program.y, program.z, place, 0, program.answer)
        residual = program.answer[1]
        if code == OK and exact:
            code, residual = certify(place, t)
        if code != OK or residual <= tol:
            break
    program.answer[1] = residual
    program.answer[2] += solving.called[0]
    return MISSED if code == OK and not residual <= tol else code


@inner
def move_ahead(run: Stepping, t: float, at: Floats, h: float) -> int:
    """Write x + h F(t, at) into y."""
    system, x, y, rate = system_at(run.place), run.x, run.projection.y, run.rate
    code = evaluate(system.drift, system.sets.shift.shape[1], t, at, rate)
    for k in range(x.size):
        y[k] = x[k] + h * rate[k]
    return code


@inner
def call_projection(run: Stepping, place: int, t: float, around: Floats, later: float, reach: float, tol: float) -> int:
    """Project y, searched from ``around``; a linearisation is carried with its sets to a later time."""
    given, question = run.projection.around, run.projection.question
    for k in range(given.size):
        given[k] = around[k]
    question[0], question[1], question[2] = later, reach, tol
    code = call_drift(run.projection.address, t, given, run.projection.z, place, 0, question)
    return SETS if code == OK and system_at(run.place).sets.request[1] != 0.0 else code


@inner
def finish_step(run: Stepping) -> None:
    """Take z for the state after the step."""
    after, z = run.after, run.projection.z
    for k in range(after.size):
        after[k] = z[k]


@step_function
def active_set(t: float, y: Any, z: Any, place: int, d: int, answer: Any) -> int:
    """The program of the near rows by the active set; see ``system.Solving``."""
    system = system_at(place)
    near, program, chosen = system.near, system.program, system.chosen
    code = nearest(system.rows, near.row, near.number[0], program, chosen, 0.0)
    system.solving.called[0] = 1.0 if chosen.number[0] > 0 else 0.0
    return code


@step_function
def project_onto_set(t: float, x: Any, z: Any, place: int, d: int, question: Any) -> int:
    """The nearest point of S(t); see ``steps.ProjectionArrays``."""
    run = stepping_at(place)
    return project(run.place, t, run.projection.around, question[1], question[0], True, question[2])


@step_function
def project_onto_linearised(t: float, x: Any, z: Any, place: int, d: int, question: Any) -> int:
    """The nearest point of the linearisation of S(t); see ``steps.ProjectionArrays``."""
    run = stepping_at(place)
    return project(run.place, t, run.projection.around, question[1], question[0], False, question[2])


@step_function
def catch_up(t: float, x: Any, after: Any, place: int, d: int, setting: Any) -> int:
    """P_S(x + h F(t, x)) with the set at t + h; setting = h, tolerance."""
    run, h = stepping_at(place), setting[0]
    code = move_ahead(run, t, run.x, h)
    if code == OK:
        reach = 2.0 * h * longest(run.rate, system_at(run.place).sets.shift.shape[1])
        code = call_projection(run, place, t + h, run.x, t + h, reach, setting[1])
    finish_step(run)
    return code


@step_function
def midpoint_catch_up(t: float, x: Any, after: Any, place: int, d: int, setting: Any) -> int:
    """P_{S~(m)} (x + h F(t + h/2, m)), m the middle of a step of linearised catch-up, which may be less accurate."""
    run, h, tol = stepping_at(place), setting[0], setting[1]
    start, middle, z = run.x, run.after, run.projection.z
    code = move_ahead(run, t, start, h)
    length = h * longest(run.rate, system_at(run.place).sets.shift.shape[1])
    if code == OK:
        code = call_projection(run, place, t + h, start, t + h, 2.0 * length, max(tol, np.sqrt(tol * length)))
    for k in range(start.size):
        middle[k] = 0.5 * (start[k] + z[k])
    if code == OK:
        code = move_ahead(run, t + 0.5 * h, middle, h)
    if code == OK:
        code = call_projection(run, place, t + 0.5 * h, middle, t + h, 2.0 * length, tol)
    finish_step(run)
    return code
