"""Sweeps in compiled code: projections onto one row after another, set by set in the order of the constraints."""

from typing import Any, NamedTuple

import numpy as np

from dincl.compiled import inner
from dincl.compiled.arrays import Floats, Offsets
from dincl.neighbours import lists
from dincl.neighbours.lists import gather, pair_list_at, scatter, sweep_discs
from dincl.rows.formulas import project
from dincl.rows.table import AFFINE, CALLBACK, DISTANCE, GRADIENTS, SWEEP, RowTable, call_python, evaluate_row, value_of
from dincl.system.arrays import COINCIDENT, FLAT, OK, SETS, UNSETTLED, SystemArrays

# Forms of families: discs, whose near pairs are listed; a wall for all particles; rows of the table; projections of
# the user, in Python.
DISCS, WALL, ROWS, USER = range(4)
# A row that Python evaluates is projected onto until a step moves less than this, relative to the first or to x; never
# more than so many times.
SETTLED, MOST_ITERATIONS = 1e-13, 50


class Families(NamedTuple):
    """Rows of each constraint of the problem, in one of four forms."""

    form: Offsets
    moving: Offsets  # 1 if the set is carried along a path
    first: Offsets  # the rows of a family are first ... last - 1 of the table; those of a wall begin in ``bound``
    last: Offsets
    pairs: Offsets  # the address of the PairList of discs
    normal: Floats  # (families, d): of walls
    bound: Floats  # least allowed heights of all particles over walls [length]
    corrections: Offsets  # (1,): by rows of walls and of the table
    offending: Offsets  # (3,): after a failure the family, and its row or two discs
    axes: Offsets  # (d,)


_NONE, _FLOATS = np.zeros(0, dtype=np.int64), np.zeros(0)
# Of a scheme that makes no sweeps.
NO_FAMILIES = Families(_NONE, _NONE, _NONE, _NONE, _NONE, np.zeros((0, 1)), _FLOATS, _NONE, _NONE, _NONE)


@inner
def sweep(system: SystemArrays, families: Families, t: float, x: Floats) -> int:
    """Project x onto one row after another of all sets at time t: OK or why not."""
    if families.axes.size == 2:
        return sweep_all(system, families, t, x, (0, 0))
    if families.axes.size == 3:
        return sweep_all(system, families, t, x, (0, 0, 0))
    return sweep_all(system, families, t, x, families.axes)


@inner
def sweep_all(system: SystemArrays, families: Families, t: float, x: Floats, axes: Any) -> int:
    """Sweep with the number of axes in a type that the compiler knows."""
    for f in range(families.form.size):
        form, code = families.form[f], OK
        if form == DISCS:
            code = sweep_family_of_discs(families, f, x, axes)
        else:
            # Python evaluates its rows at their places; all other rows stand still, and particles are moved.
            first = families.first[f]
            called = form == ROWS and first < families.last[f] and system.rows.row[first].kind == CALLBACK
            carried = families.moving[f] != 0 and not called
            if carried:
                carry(x, system.sets.shift, f, -1.0)
            if form == WALL:
                families.corrections[0] += sweep_wall(x, families.normal[f], families.bound[families.first[f] :])
            elif form == ROWS:
                code = sweep_rows(system, families, f, t, x, axes)
            else:
                system.sets.request[2] = f
                code = SETS if call_python(system.sets, t, x, SWEEP) != 0 else OK
            if carried:
                carry(x, system.sets.shift, f, 1.0)
        if code != OK:
            return code
    return OK


@inner
def carry(x: Floats, shift: Floats, f: int, way: float) -> None:
    """Move all particles by ``way`` = 1 or -1 times the shift of set f."""
    d = shift.shape[1]
    for p in range(0, x.size, d):
        for k in range(d):
            x[p + k] += way * shift[f, k]


@inner
def sweep_family_of_discs(families: Families, f: int, x: Floats, axes: Any) -> int:
    """Sweep over pairs of discs."""
    pairs = pair_list_at(families.pairs[f])
    if pairs.disc.size == 0:
        ended = sweep_discs(x, pairs, axes)
    else:
        gather(x, pairs, len(axes))
        ended = sweep_discs(pairs.point, pairs, axes)
        scatter(x, pairs, len(axes))
    return OK if ended == lists.DONE else record_discs(families, f, ended == lists.FAILED)


@inner
def record_discs(families: Families, f: int, failed: bool) -> int:
    """Record which discs lie on one point; ``failed`` if the search for pairs failed."""
    pairs = pair_list_at(families.pairs[f])
    if failed:
        return SETS
    families.offending[0] = f
    for end in range(2):
        disc = pairs.number[lists.ONE + end]
        families.offending[1 + end] = disc if pairs.disc.size == 0 else pairs.disc[disc]
    return COINCIDENT


@inner
def sweep_wall(x: Floats, normal: Floats, bound: Floats) -> int:
    """Project all X_i onto normal . X_i >= bound_i with a unit normal: X_i += (bound_i - normal . X_i) normal."""
    corrections, d = 0, normal.size
    for i in range(x.size // d):
        height = 0.0
        for k in range(d):
            height += normal[k] * x[i * d + k]
        if height < bound[i]:
            for k in range(d):
                x[i * d + k] += (bound[i] - height) * normal[k]
            corrections += 1
    return corrections


@inner
def sweep_rows(system: SystemArrays, families: Families, f: int, t: float, x: Floats, axes: Any) -> int:
    """Project onto the rows of a family in the table, one after another."""
    rows, sets, current = system.rows, system.sets, False
    for r in range(families.first[f], families.last[f]):
        row, code, moved = rows.row[r], OK, 0
        if row.kind == DISTANCE:
            moved = project_distance(rows, r, x, axes)
        elif row.kind == AFFINE:
            moved = project_affine(rows, r, x)
        else:
            if row.kind == CALLBACK and not current and call_python(sets, t, x, GRADIENTS) != 0:
                return SETS
            value = value_of(rows, sets, r, x)
            current = not value < 0.0
            if not current:
                code, moved = project_curved(system, r, t, x), 1
            elif value != value:
                moved = -1
        if moved < 0 or code != OK:
            families.offending[0], families.offending[1] = f, r - families.first[f]
            return code if code != OK else COINCIDENT
        families.corrections[0] += moved
    return OK


@inner
def project_distance(rows: RowTable, r: int, x: Floats, axes: Any) -> int:
    """Project x onto the distance in row r; return 1 if x moved, 0 if not, -1 if the row has no direction."""
    row, d = rows.row[r], len(axes)
    if row.j < 0:
        return project(x, row.i * d, rows.coefficient, rows.start[r], True, row.length, row.sign, axes)
    return project(x, row.i * d, x, row.j * d, False, row.length, row.sign, axes)


@inner
def project_affine(rows: RowTable, r: int, x: Floats) -> int:
    """Project x onto row r: x += (b - a . x) a / |a|^2 where a . x < b; return 1 if x moved, else 0."""
    row, height = rows.row[r], 0.0
    for p in range(rows.start[r], rows.stop[r]):
        height += rows.coefficient[p] * x[rows.column[p]]
    if not height < row.length:
        return 0
    step = (row.length - height) / row.square
    for p in range(rows.start[r], rows.stop[r]):
        x[rows.column[p]] += step * rows.coefficient[p]
    return 1


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
