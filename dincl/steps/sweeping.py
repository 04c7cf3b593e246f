"""Steps of schemes that take one row after another: position based dynamics, and the penalty method.

``sweep_of`` makes the sweep of position based dynamics, which projects onto pairs of discs, walls and rows of the
table, set by set in the order of the constraints, and that of its extended form, which corrects with a multiplier for
each of them.
"""

from collections.abc import Callable
from functools import partial
from typing import Any

from dincl.compiled import c_function, call, inner, kernel, struct_type
from dincl.compiled.arrays import Axes, Floats
from dincl.compiled.calls import DOUBLES, floats_at, signature
from dincl.neighbours.lists import (
    INCOMPLETE,
    ONE,
    OUTDATED,
    SWEEPS,
    UNKNOWN,
    Move,
    add_disc_forces,
    correct_any_pair,
    correct_pair,
    disc_sweep,
    gather,
    move_all,
    move_all_at_once,
    pair_list_at,
    project_pair,
    scatter,
)
from dincl.rows.table import (
    AFFINE,
    CALLBACK,
    DISPLACEMENTS,
    DISTANCE,
    GRADIENTS,
    RowTable,
    Sets,
    call_python,
    evaluate_row,
    value_of,
)
from dincl.solvers.envelope_factor import add_row
from dincl.steps.grid import TimeGrid
from dincl.steps.loop import DISCS, NO_FAMILIES, WALL, Families, Stepping, loop_of
from dincl.system.arrays import (
    COINCIDENT,
    FLAT,
    OK,
    REPEAT,
    SETS,
    STALE,
    SYSTEM,
    TOO_FAR,
    UNSETTLED,
    SystemArrays,
    evaluate,
    system_at,
)

# A row that Python evaluates is projected onto until a step moves less than this, relative to the first or to x; never
# more than so many times.
SETTLED, MOST_ITERATIONS = 1e-13, 50
# Particles for which all walls are taken before the next ones.
BLOCK = 1024
# Steps are repeated with wider lists, which hold more pairs, at most so many times.
MOST_LISTS = 60
# So many coordinates are moved and compared with their references in one pass; fewer of them are in the cache anyway.
MANY = 300


@inner
def record_discs(families: Families, f: int, code: int) -> int:
    """Return how a sweep over discs ended, and record which discs lie on one point."""
    if code == COINCIDENT:
        pairs = pair_list_at(families.pairs[f])
        families.offending[0] = f
        for end in range(2):
            disc = pairs.number[ONE + end]
            families.offending[1 + end] = disc if pairs.disc.size == 0 else pairs.disc[disc]
    return code


@inner
def way_onto_wall(height: float, bound: float, multiplier: Floats, p: int, begin: bool, compliance: float) -> float:
    """Return the way along the unit normal of a wall by which a particle of this height is projected onto it."""
    return bound - height if height < bound else 0.0


@inner
def way_at_wall(height: float, bound: float, multiplier: Floats, p: int, begin: bool, compliance: float) -> float:
    """Return the change of the multiplier of a particle at a wall, see ``lists.correct_pair``."""
    before = 0.0 if begin else multiplier[p]
    after = max(before - (height - bound + compliance * before) / (1.0 + compliance), 0.0)
    multiplier[p] = after
    return float(after - before)


# int64 f(system, families, family, t, x, coordinates, compliance): a sweep over rows of the table, by its address, so
# that kernels of runs with discs and walls alone are compiled without it.
VISIT_ROWS: Any = signature(int, struct_type(SYSTEM), struct_type(NO_FAMILIES), int, float, DOUBLES, int, float)
call_visit = call(VISIT_ROWS)


@partial(c_function, VISIT_ROWS)
def correct_rows(
    system: SystemArrays, families: Families, f: int, t: float, place: Floats, n: int, compliance: float
) -> int:
    """Move x along the gradients of the rows of a family in the table by the changes of their multipliers."""
    rows, program, x = system.rows, system.program, floats_at(place, n)
    for r in range(families.first[f], families.last[f]):
        if rows.row[r].kind == CALLBACK and call_python(system.sets, t, x, GRADIENTS) != 0:
            return SETS
        value = evaluate_row(rows, system.sets, r, x, program.gradient)
        if value != value:
            families.offending[0], families.offending[1] = f, r - families.first[f]
            return COINCIDENT
        square, before = compliance, program.multiplier[r]
        for p in range(rows.start[r], rows.stop[r]):
            square += program.gradient[p] * program.gradient[p]
        if square > 0.0:
            program.multiplier[r] = max(before - (value + compliance * before) / square, 0.0)
        if program.multiplier[r] != before:
            add_row(rows, r, program.gradient, program.multiplier[r] - before, x)
            families.corrections[0] += 1
    return OK


@partial(c_function, VISIT_ROWS)
def project_rows(
    system: SystemArrays, families: Families, f: int, t: float, place: Floats, n: int, compliance: float
) -> int:
    """Project onto the rows of a family in the table, one after another."""
    rows, sets, gradient, current, x = system.rows, system.sets, system.program.gradient, False, floats_at(place, n)
    for r in range(families.first[f], families.last[f]):
        row = rows.row[r]
        if row.kind == CALLBACK and not current and call_python(sets, t, x, GRADIENTS) != 0:
            return SETS
        value = value_of(rows, sets, r, x)
        current, code = not value < 0.0, OK if value == value else COINCIDENT
        if value < 0.0 and (row.kind == DISTANCE or row.kind == AFFINE):
            # The linearisation of these rows has the same nearest point.
            value = evaluate_row(rows, sets, r, x, gradient)
            code = OK if value == value else COINCIDENT
            if row.square > 0.0:  # none of its particles is fixed, or not all
                add_row(rows, r, gradient, -value / row.square, x)
        elif value < 0.0:
            code = project_curved(system, r, t, x)
        if code != OK:
            families.offending[0], families.offending[1] = f, r - families.first[f]
            return code
        families.corrections[0] += value < 0.0
    return OK


@inner
def project_curved(system: SystemArrays, r: int, t: float, x: Floats) -> int:
    """Project x onto {g_r >= 0}, for a violated row whose projection has no formula: OK or why not.

    The row is linearised again at the point reached, always for the same start y: a fixed point with
    x = y + lambda grad g(x) and g(x) = 0 is the nearest point of a violated set. The footnote to Method 2.2 stops after
    the first of these Gauss-Newton steps, which is exact for affine rows only.
    """
    rows, gradient, y, first = system.rows, system.program.gradient, system.middle, 0.0
    for k in range(x.size):
        y[k] = x[k]
    for iteration in range(MOST_ITERATIONS):
        if iteration > 0 and rows.row[r].kind == CALLBACK and call_python(system.sets, t, x, GRADIENTS) != 0:
            return SETS
        lack, square = -evaluate_row(rows, system.sets, r, x, gradient), 0.0
        if lack != lack:
            return COINCIDENT
        for p in range(rows.start[r], rows.stop[r]):
            square += gradient[p] * gradient[p]
            lack += gradient[p] * (x[rows.column[p]] - y[rows.column[p]])
        if square == 0.0:
            return FLAT
        moved, largest = step_from(rows, gradient, r, max(lack, 0.0) / square, y, x, system.velocity)
        if first == 0.0:
            first = moved
        if moved <= SETTLED * max(first, largest):
            return OK
    return UNSETTLED


@inner
def step_from(
    rows: RowTable, gradient: Floats, r: int, multiplier: float, y: Floats, x: Floats, before: Floats
) -> tuple[float, float]:
    """Write x = y + multiplier grad g_r; return the largest change of a coordinate, and the largest coordinate."""
    moved, largest = 0.0, 0.0
    for k in range(x.size):
        before[k], x[k] = x[k], y[k]
    for p in range(rows.start[r], rows.stop[r]):
        x[rows.column[p]] += multiplier * gradient[p]
    for k in range(x.size):
        moved, largest = max(moved, abs(x[k] - before[k])), max(largest, abs(x[k]))
    return moved, largest


@inner
def move_first(families: Families, move: Move, after: Floats, axes: Any) -> int:
    """Write all particles after the step before the sweeps; return what is known of the list of the first family."""
    if families.form.size == 0 or families.form[0] != DISCS or pair_list_at(families.pairs[0]).disc.size > 0:
        move_all(move, after)
        return UNKNOWN
    return int(move_all_at_once(move, after, pair_list_at(families.pairs[0]), axes))


def sweep_of(visit_pair: Callable[..., int], visit_wall: Callable[..., float]) -> Callable[..., int]:
    """Make the sweep over all sets in which pairs of discs and walls are visited like this."""
    sweep_discs = disc_sweep(visit_pair)

    @inner
    def sweep_family_of_discs(
        families: Families, f: int, x: Floats, known: int, begin: bool, compliance: float, axes: Any
    ) -> int:
        """Sweep over pairs of discs."""
        pairs, points = pair_list_at(families.pairs[f]), x
        if pairs.disc.size > 0:
            gather(x, pairs, len(axes))
            points = pairs.point
        code = sweep_discs(points, pairs, known if f == 0 else UNKNOWN, begin, compliance, axes)
        scatter(x, pairs, len(axes))
        return int(record_discs(families, f, code))

    @inner
    def sweep_wall(
        families: Families, f: int, x: Floats, block: int, shift: Floats, begin: bool, compliance: float, axes: Any
    ) -> int:
        """Take one wall, moved by ``shift``, for a block of particles; return how many moved."""
        d, n, corrections, carried = len(axes), families.normal[f], 0, 0.0
        one, two, three = n[0], n[min(1, d - 1)], n[min(2, d - 1)]
        begins, count = families.first[f] + block, min(BLOCK, x.size // d - block)
        multiplier, some = families.multiplier, min(families.multiplier.size, 1)
        for k in range(d):
            carried += n[k] * shift[k]
        # Slices begin at 0, so that the compiler knows that no index is negative.
        points, bound, multiplier = x[block * d :], families.bound[begins:], multiplier[begins * some :]
        # Written out, without calls that take arrays and without branches, so that several particles are taken at once.
        # x + -0.0 is x, also where x is -0.0.
        for i in range(count):
            height = 0.0 + one * points[i * d]
            if d > 1:
                height += two * points[i * d + 1]
            if d > 2:
                height += three * points[i * d + 2]
            way = visit_wall(height, bound[i] + carried, multiplier, i, begin, compliance)
            moves = way != 0.0
            points[i * d] += way * one if moves else -0.0
            if d > 1:
                points[i * d + 1] += way * two if moves else -0.0
            if d > 2:
                points[i * d + 2] += way * three if moves else -0.0
            corrections += moves
        return corrections

    @inner
    def sweep_walls(
        families: Families, first: int, end: int, x: Floats, shift: Floats, begin: bool, compliance: float, axes: Any
    ) -> None:
        """Take walls ``first`` ... ``end`` - 1 one after another, for so many particles as stay in the cache."""
        d, corrections = len(axes), 0
        for block in range(0, x.size // d, BLOCK):
            for f in range(first, end):
                corrections += sweep_wall(families, f, x, block, shift[f], begin, compliance, axes)
        families.corrections[0] += corrections

    @inner
    def sweep(
        system: SystemArrays,
        families: Families,
        t: float,
        x: Floats,
        known: int,
        begin: bool,
        compliance: float,
        axes: Any,
    ) -> int:
        """Sweep over all sets at time t: OK or why not; ``known`` is what ``move_first`` returned, or UNKNOWN."""
        count, f = families.form.size, 0
        while f < count:
            form, code, last = families.form[f], OK, f + 1
            if form == DISCS:
                code = sweep_family_of_discs(families, f, x, known, begin, compliance, axes)
            elif form == WALL:
                while last < count and families.form[last] == WALL:
                    last += 1
                sweep_walls(families, f, last, x, system.sets.shift, begin, compliance, axes)
            else:
                code = call_visit(families.visit_rows, system, families, f, t, x, x.size, compliance)
            if code != OK:
                return int(code)
            f = last
        return OK

    return sweep


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
    return int(record_discs(families, f, add_disc_forces(points, pairs, spring, force, axes)))


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
    return int(evaluate(system, t, x, run.rate))


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
