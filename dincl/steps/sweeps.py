"""Sweeps in compiled code: projections onto one row after another, set by set in the order of the constraints.

``sweep_of`` makes the sweep of position based dynamics, which projects onto pairs of discs, walls and rows of the
table, and that of its extended form, which corrects with a multiplier for each of them.
"""

from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

from dincl.compiled import c_function, call, inner, struct_type
from dincl.compiled.arrays import Floats, Offsets, Table, empty
from dincl.compiled.calls import DOUBLES, floats_at, signature
from dincl.neighbours import lists
from dincl.neighbours.lists import UNKNOWN, Move, disc_sweep, gather, move_all, move_all_at_once, pair_list_at, scatter
from dincl.rows.table import AFFINE, CALLBACK, DISTANCE, GRADIENTS, RowTable, call_python, evaluate_row, value_of
from dincl.solvers.envelope_factor import add_row
from dincl.system.arrays import COINCIDENT, FLAT, NEED_ROOM, OK, REPEAT, SETS, STALE, SYSTEM, UNSETTLED, SystemArrays

# Forms of families: discs, whose near pairs are listed; a wall for all particles, for d <= 3; rows of the table.
DISCS, WALL, ROWS = range(3)
# A row that Python evaluates is projected onto until a step moves less than this, relative to the first or to x; never
# more than so many times.
SETTLED, MOST_ITERATIONS = 1e-13, 50
# Particles for which all walls are taken before the next ones.
BLOCK = 1024


class Families(NamedTuple):
    """Rows of each constraint of the problem, in one of three forms."""

    form: Offsets
    first: Offsets  # the rows of a family are first ... last - 1 of the table; those of a wall begin in ``bound``
    last: Offsets
    pairs: Offsets  # the address of the PairList of discs
    normal: Table  # (families, d): of walls
    bound: Floats  # least allowed heights of all particles over walls [length]
    multiplier: Floats  # of all particles at walls, or (0,) for schemes that have none
    corrections: Offsets  # (1,): by rows of walls and of the table
    offending: Offsets  # (3,): after a failure the family, and its row or two discs
    visit_rows: int  # the address of ``project_rows`` or ``correct_rows``, 0 without rows of the table


# Of a scheme that makes no sweeps.
NO_FAMILIES: Families = empty(Families)


@inner
def record_discs(families: Families, f: int, ended: int) -> int:
    """Return the code of a step for how a sweep over discs ended, and record which discs lie on one point."""
    pairs = pair_list_at(families.pairs[f])
    if ended == lists.STALE or ended == lists.REPEAT:
        return STALE if ended == lists.STALE else REPEAT
    if ended != lists.SAME_POINT:
        return NEED_ROOM if ended == lists.FULL else SETS
    families.offending[0] = f
    for end in range(2):
        disc = pairs.number[lists.ONE + end]
        families.offending[1 + end] = disc if pairs.disc.size == 0 else pairs.disc[disc]
    return COINCIDENT


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
        ended = sweep_discs(points, pairs, known if f == 0 else UNKNOWN, begin, compliance, axes)
        scatter(x, pairs, len(axes))
        return OK if ended == lists.DONE else record_discs(families, f, ended)

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
