"""Steps of schemes that take one row after another: position based dynamics, and the penalty method."""

from typing import Any

from dincl.compiled import inner
from dincl.compiled.arrays import Floats
from dincl.neighbours.lists import DONE, FAILED, add_disc_forces, gather, pair_list_at
from dincl.rows.table import DISPLACEMENTS, GRADIENTS, RowTable, Sets, call_python, evaluate_row, value_of
from dincl.steps.loop import Stepping, step_function, stepping_at
from dincl.steps.sweeps import DISCS, WALL, Families, record_discs, sweep
from dincl.system.arrays import COINCIDENT, OK, SETS, SystemArrays, evaluate, system_at


@inner
def add_forces(system: SystemArrays, families: Families, x: Floats, spring: bool, force: Floats) -> int:
    """Add max(0, -g) grad g of all rows to ``force``, or grad g of violated rows without ``spring``: OK or why not."""
    rows, shift = system.rows, system.sets.shift
    for f in range(families.form.size):
        if families.form[f] == DISCS:
            code = add_forces_of_discs(families, f, x, spring, force)
            if code != OK:
                return code
        elif families.form[f] == WALL:
            add_wall_forces(x, families.normal[f], families.bound[families.first[f] :], shift[f], spring, force)
        else:
            for r in range(families.first[f], families.last[f]):
                if not add_row_force(rows, system.sets, r, x, system.program.gradient, spring, force):
                    families.offending[0], families.offending[1] = f, r - families.first[f]
                    return COINCIDENT
    return OK


@inner
def add_forces_of_discs(families: Families, f: int, x: Floats, spring: bool, force: Floats) -> int:
    """Add the forces of a family of discs."""
    pairs, points = pair_list_at(families.pairs[f]), x
    if pairs.disc.size > 0:
        gather(x, pairs, families.axes.size)
        points = pairs.point
    if families.axes.size == 2:
        ended = add_disc_forces(points, pairs, spring, force, (0, 0))
    elif families.axes.size == 3:
        ended = add_disc_forces(points, pairs, spring, force, (0, 0, 0))
    else:
        ended = add_disc_forces(points, pairs, spring, force, families.axes)
    return OK if ended == DONE else record_discs(families, f, ended == FAILED)


@inner
def add_row_force(rows: RowTable, sets: Sets, r: int, x: Floats, gradient: Floats, spring: bool, force: Floats) -> bool:
    """Add the force of a row of the table; false if it is violated and has no direction."""
    value = value_of(rows, sets, r, x)
    if not value < 0.0:
        return value == value
    if not evaluate_row(rows, sets, r, x, gradient) < 0.0:
        return False
    for p in range(rows.start[r], rows.stop[r]):
        force[rows.column[p]] += gradient[p] * (-value if spring else 1.0)
    return True


@inner
def add_wall_forces(x: Floats, normal: Floats, bound: Floats, shift: Floats, spring: bool, force: Floats) -> None:
    """Add the forces of a wall that was carried by ``shift``."""
    d, carried = normal.size, 0.0
    for k in range(d):
        carried += normal[k] * shift[k]
    for i in range(x.size // d):
        height = 0.0
        for k in range(d):
            height += normal[k] * x[i * d + k]
        violation = bound[i] + carried - height
        if violation > 0.0:
            for k in range(d):
                force[i * d + k] += normal[k] * (violation if spring else 1.0)


@inner
def sweep_often(run: Stepping, t: float, x: Floats, sweeps: int) -> int:
    """Project x in place onto one row after another of all sets at time t, so many ``sweeps``: OK or why not."""
    system = system_at(run.place)
    if call_python(system.sets, t, x, DISPLACEMENTS) != 0:
        return SETS
    for _ in range(sweeps):
        code = sweep(system, run.families, t, x)
        if code != OK:
            return code
    return OK


@step_function
def pbd(t: float, x: Any, after: Any, place: int, d: int, setting: Any) -> int:
    """P_{S_M} ... P_{S_1} (x + h F(t, x)), ``setting[1]`` times, with the sets at t + h; setting[0] = h."""
    run, h = stepping_at(place), setting[0]
    system = system_at(run.place)
    code = evaluate(system.drift, system.sets.shift.shape[1], t, run.x, run.rate)
    if code != OK:
        return code
    start, speed, rate, moved = run.x, run.v, run.rate, run.after
    for k in range(start.size):
        moved[k] = start[k] + h * (speed[k] + h * rate[k] if speed.size > 0 else rate[k])
    return sweep_often(run, t + h, run.after, int(setting[1]))


@step_function
def penalty(t: float, x: Any, after: Any, place: int, d: int, setting: Any) -> int:
    """x + h (F(t, x) + strength sum_k max(0, -g_k)^(exponent - 1) grad g_k); setting = h, strength, exponent."""
    run, h = stepping_at(place), setting[0]
    system = system_at(run.place)
    code = evaluate(system.drift, system.sets.shift.shape[1], t, run.x, run.rate)
    if code == OK and call_python(system.sets, t, run.x, GRADIENTS) != 0:
        code = SETS
    start, rate, force = run.x, run.rate, run.after
    for k in range(start.size):
        force[k] = 0.0
    if code == OK:
        code = add_forces(system, run.families, start, setting[2] == 2.0, force)
    for k in range(start.size):
        force[k] = start[k] + h * (rate[k] + setting[1] * force[k])
    return code
