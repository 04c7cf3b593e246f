"""Steps of schemes that take one row after another: position based dynamics, and the penalty method."""

from collections.abc import Callable
from functools import partial
from typing import Any

from dincl.compiled import inner, kernel
from dincl.compiled.arrays import Axes, Floats
from dincl.neighbours.lists import (
    DONE,
    INCOMPLETE,
    OUTDATED,
    SWEEPS,
    UNKNOWN,
    Move,
    add_disc_forces,
    correct_any_pair,
    correct_pair,
    gather,
    move_all,
    pair_list_at,
    project_pair,
)
from dincl.rows.table import DISPLACEMENTS, GRADIENTS, RowTable, Sets, call_python, evaluate_row, value_of
from dincl.steps.grid import TimeGrid
from dincl.steps.loop import Stepping, loop_of
from dincl.steps.sweeps import (
    DISCS,
    WALL,
    Families,
    move_first,
    record_discs,
    sweep_of,
    way_at_wall,
    way_onto_wall,
)
from dincl.system.arrays import COINCIDENT, OK, REPEAT, SETS, STALE, TOO_FAR, SystemArrays, evaluate, system_at

# Steps are repeated with wider lists, which hold more pairs, at most so many times.
MOST_LISTS = 60
# So many coordinates are moved and compared with their references in one pass; fewer of them are in the cache anyway.
MANY = 300


@inner
def add_forces(system: SystemArrays, families: Families, x: Floats, spring: bool, force: Floats, axes: Any) -> int:
    """Add max(0, -g) grad g of all rows to ``force``, or grad g of violated rows without ``spring``: OK or why not."""
    rows, shift = system.rows, system.sets.shift
    for f in range(families.form.size):
        if families.form[f] == DISCS:
            code = add_forces_of_discs(families, f, x, spring, force, axes)
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
def add_forces_of_discs(families: Families, f: int, x: Floats, spring: bool, force: Floats, axes: Any) -> int:
    """Add the forces of a family of discs."""
    pairs, points = pair_list_at(families.pairs[f]), x
    if pairs.disc.size > 0:
        gather(x, pairs, len(axes))
        points = pairs.point
    ended = add_disc_forces(points, pairs, spring, force, axes)
    return OK if ended == DONE else record_discs(families, f, ended)


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
def drift_at_start(run: Stepping, system: SystemArrays, t: float, x: Floats) -> int:
    """Write F(t, x) into ``rate``, once for a step that is made again with more room: OK or DRIFT."""
    if run.repeats[0] != 0:
        run.repeats[0] = 0
        return OK
    return int(evaluate(system.drift, system.sets.shift.shape[1], t, x, run.rate))


def sweeps_of(sweep: Callable[..., int]) -> Callable[..., int]:
    """Make the function that sweeps as often as the settings say."""

    @inner
    def sweep_often(run: Stepping, t: float, move: Move, after: Floats, compliance: float, axes: Any) -> int:
        """Write the point of the step ``move``, and sweep over all sets at time t: OK or why not."""
        system = system_at(run.system)
        if call_python(system.sets, t, move.x, DISPLACEMENTS) != 0:
            return SETS
        known = UNKNOWN
        if after.size < MANY:
            move_all(move, after)
        else:
            known = move_first(run.families, move, after, axes)
        for k in range(run.settings.sweeps):
            code = sweep(system, run.families, t, after, known, k == 0, compliance, axes)
            while code == REPEAT:
                move_all(move, after)
                code = sweep(system, run.families, t, after, INCOMPLETE, True, compliance, axes)
            known = UNKNOWN
            if code != OK:
                return int(code)
        return OK

    return sweep_often


project_often = sweeps_of(sweep_of(project_pair, way_onto_wall))
project_any_often = sweeps_of(sweep_of(correct_any_pair, way_onto_wall))
correct_often = sweeps_of(sweep_of(correct_pair, way_at_wall))
correct_any_often = sweeps_of(sweep_of(correct_any_pair, way_at_wall))


def pbd_of(sweep_often: Callable[..., int]) -> Callable[..., int]:
    """Make the step of position based dynamics with these sweeps."""

    @inner
    def pbd(run: Stepping, t: float, h: float, x: Floats, v: Floats, after: Floats, axes: Any) -> int:
        """P_{S_M} ... P_{S_1} (x + h F(t, x)), or of x + h (v + h F), as often as set, with the sets at t + h."""
        system = system_at(run.system)
        code = drift_at_start(run, system, t, x)
        if code == OK:
            code = sweep_often(run, t + h, Move(h, x, v, run.rate), after, 0.0, axes)
        return int(code)

    return pbd


def xpbd_of(sweep_often: Callable[..., int]) -> Callable[..., int]:
    """Make the step of extended position based dynamics with these sweeps."""

    @inner
    def xpbd(run: Stepping, t: float, h: float, x: Floats, v: Floats, after: Floats, axes: Any) -> int:
        """Sweep over x + h F(t, x) with the sets at t + h, with a multiplier for each row that is 0 at the start.

        Multipliers belong to pairs of a list. If a list no longer holds all pairs, the step is repeated with a wider
        one.
        """
        system, families = system_at(run.system), run.families
        code = drift_at_start(run, system, t, x)
        for _ in range(MOST_LISTS):
            if code != OK:
                return code
            for r in range(system.program.multiplier.size):
                system.program.multiplier[r] = 0.0
            code = sweep_often(run, t + h, Move(h, x, v, run.rate), after, run.settings.compliance / h, axes)
            if code != STALE:
                return code
            for f in range(families.form.size):
                if families.form[f] == DISCS:
                    pairs = pair_list_at(families.pairs[f])
                    pairs.number[SWEEPS], pairs.number[OUTDATED] = 0, 1
            code = OK
        return TOO_FAR

    return xpbd


@inner
def penalty(run: Stepping, t: float, h: float, x: Floats, v: Floats, after: Floats, axes: Any) -> int:
    """x + h (F(t, x) + strength sum_k max(0, -g_k)^(exponent - 1) grad g_k)."""
    system, rate, settings = system_at(run.system), run.rate, run.settings
    code = drift_at_start(run, system, t, x)
    if code == OK and call_python(system.sets, t, x, GRADIENTS) != 0:
        code = SETS
    for k in range(x.size):
        after[k] = 0.0
    if code == OK:
        code = add_forces(system, run.families, x, settings.exponent == 2, after, axes)
    for k in range(x.size):
        after[k] = x[k] + h * (rate[k] + settings.strength * after[k])
    return code


_pbd, _xpbd, _penalty = loop_of(pbd_of(project_often)), loop_of(xpbd_of(correct_often)), loop_of(penalty)
_pbd_of_any, _xpbd_of_any = loop_of(pbd_of(project_any_often)), loop_of(xpbd_of(correct_any_often))


@partial(kernel, references=False)
def run_pbd(place: int, grid: TimeGrid, output: int, axes: Axes) -> tuple[int, int]:
    """Make steps of position based dynamics, see ``dincl.steps.loop.loop_of``."""
    return _pbd(place, grid, output, axes)


@partial(kernel, references=False)
def run_xpbd(place: int, grid: TimeGrid, output: int, axes: Axes) -> tuple[int, int]:
    """Make steps of extended position based dynamics."""
    return _xpbd(place, grid, output, axes)


@partial(kernel, references=False)
def run_penalty(place: int, grid: TimeGrid, output: int, axes: Axes) -> tuple[int, int]:
    """Make steps of the penalty method."""
    return _penalty(place, grid, output, axes)


@partial(kernel, references=False)
def run_pbd_of_any(place: int, grid: TimeGrid, output: int, axes: Axes) -> tuple[int, int]:
    """Make steps of position based dynamics in scaled coordinates or a periodic box."""
    return _pbd_of_any(place, grid, output, axes)


@partial(kernel, references=False)
def run_xpbd_of_any(place: int, grid: TimeGrid, output: int, axes: Axes) -> tuple[int, int]:
    """Make steps of extended position based dynamics in scaled coordinates or a periodic box."""
    return _xpbd_of_any(place, grid, output, axes)
