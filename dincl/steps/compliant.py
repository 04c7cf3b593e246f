"""Step of extended position based dynamics: sweeps that accumulate a multiplier for each row."""

from typing import Any

from dincl.compiled import inner
from dincl.neighbours import ROW_MARGIN
from dincl.rows.table import CALLBACK, DISPLACEMENTS, GRADIENTS, call_python, evaluate_row
from dincl.solvers.envelope_factor import add_row
from dincl.steps.catch_up import drift_step, finish_step
from dincl.steps.loop import step_function, stepping_at
from dincl.steps.programs import FAILED_LIST, MOST_SEARCHES, NEW_LIST, SAME_LIST, list_near
from dincl.system.arrays import (
    COINCIDENT,
    OK,
    PYTHON,
    SETS,
    TOO_FAR,
    SystemArrays,
    farthest,
    longest,
    system_at,
)


@inner
def correct_row(system: SystemArrays, t: float, r: int, compliance: float) -> int:
    """Move z along the gradient of row r by the change of its multiplier: OK or why not.

    For g + compliance mu = 0 with mu >= 0 it is -(g + compliance mu) / (|grad g|^2 + compliance), at least -mu.
    """
    rows, program = system.rows, system.program
    if rows.row[r].kind == CALLBACK and call_python(system.sets, t, program.z, GRADIENTS) != 0:
        return SETS
    value = evaluate_row(rows, system.sets, r, program.z, program.gradient)
    if value != value:
        system.offending[0] = r
        return COINCIDENT
    square, before = compliance, program.multiplier[r]
    for p in range(rows.start[r], rows.stop[r]):
        square += program.gradient[p] * program.gradient[p]
    if square > 0.0:
        program.multiplier[r] = max(before - (value + compliance * before) / square, 0.0)
    if program.multiplier[r] != before:
        add_row(rows, r, program.gradient, program.multiplier[r] - before, program.z)
        program.answer[0] += 1.0
    return OK


@inner
def correct_listed_rows(place: int, t: float, sweeps: int, compliance: float) -> int:
    """Sweep over the listed rows, from z = y and multipliers of zero: OK or why not."""
    system = system_at(place)
    near, program = system.near, system.program
    for k in range(program.z.size):
        program.z[k] = program.y[k]
    for r in range(program.multiplier.size):
        program.multiplier[r] = 0.0
    for _ in range(sweeps):
        if call_python(system.sets, t, program.z, GRADIENTS) != 0:
            return SETS
        for q in range(near.number[0]):
            code = correct_row(system, t, near.row[q], compliance)
            if code != OK:
                return code
    return OK


@inner
def sweep_with_multipliers(place: int, t: float, around: Any, radius: float, sweeps: int, compliance: float) -> int:
    """Sweep over the rows near ``around``, again with more rows if z leaves the region that they are listed for."""
    system = system_at(place)
    if call_python(system.sets, t, around, DISPLACEMENTS) != 0:
        return SETS
    if list_near(place, t, around, radius, ROW_MARGIN) == FAILED_LIST:
        return PYTHON
    for _ in range(MOST_SEARCHES):
        code = correct_listed_rows(place, t, sweeps, compliance)
        if code != OK:
            return code
        distance = farthest(system.program.z, around, system.sets.shift.shape[1])
        listed = list_near(place, t, around, distance, ROW_MARGIN)
        if listed != NEW_LIST:
            return OK if listed == SAME_LIST else PYTHON
    return TOO_FAR


@step_function
def xpbd(t: float, x: Any, after: Any, place: int, d: int, setting: Any) -> int:
    """Sweep over x + h F(t, x) with the sets at t + h; setting = h, sweeps, compliance [time]."""
    run, h = stepping_at(place), setting[0]
    code = drift_step(run, t, run.x, h)
    if code == OK:
        radius = 2.0 * h * longest(run.rate, system_at(run.place).sets.shift.shape[1])
        code = sweep_with_multipliers(run.place, t + h, run.x, radius, int(setting[1]), setting[2] / h)
    finish_step(run)
    return code
