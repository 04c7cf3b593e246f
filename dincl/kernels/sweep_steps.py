"""Steps of position based dynamics for small systems; the formulas are those of ``sweeps`` and ``affine``."""

from typing import NamedTuple

import numpy as np

from dincl.compiled import inner, kernel
from dincl.compiled.structs import reader
from dincl.constants import LARGEST
from dincl.kernels.arrays import Floats, Offsets
from dincl.kernels.pair_list import CORRECTIONS, DONE, NO_PAIRS, PairList, part_pairs
from dincl.kernels.system import COINCIDENT, NOT_A_NUMBER, OK, SETS, Steps, bounded, evaluate, system_at
from dincl.kernels.table import PLACES, RowTable, ask

# Whose formula a family of rows has: ``sweep_pairs``, ``sweep_distance``, ``sweep_half_space`` or ``sweep_affine``.
PAIRS, DISTANCES, WALL, AFFINE = range(4)


class Families(NamedTuple):
    """The sets, one family of rows each: pairs kept apart in ``pairs``, all others in the table of a small system."""

    formula: Offsets  # (families,)
    first: Offsets  # (families + 1,): those of family f are rows first[f] ... first[f + 1] of the table
    moving: Offsets  # (families,): 1 if the set is carried along a path
    blamed: Offsets  # (2,): the family that failed, and its pair in the list, or its row
    pairs: PairList
    place: int  # the handle of the system


# For its types.
_NONE = np.zeros(0, dtype=np.int64)
families_at = reader(Families(_NONE, _NONE, _NONE, _NONE, NO_PAIRS, 0))


@inner
def project_distance(rows: RowTable, r: int, x: Floats, d: int) -> int:
    """1 if row r moved x, 0 if it did not, -1 if it has no direction."""
    row, anchor, square = rows.row[r], rows.start[r], 0.0
    i, j = row.i * d, row.j * d
    for k in range(d):
        end = rows.coefficient[anchor + k] if j < 0 else x[j + k]
        square += (x[i + k] - end) * (x[i + k] - end)
    if row.sign * (square - row.length * row.length) >= 0.0:
        return 0
    stretch = row.length / np.sqrt(square)
    if stretch == np.inf:
        return -1
    share = stretch - 1.0 if j < 0 else 0.5 * (stretch - 1.0)
    for k in range(d):
        if j < 0:
            x[i + k] += share * (x[i + k] - rows.coefficient[anchor + k])
        else:
            move = share * (x[i + k] - x[j + k])
            x[i + k] += move
            x[j + k] -= move
    return 1


@inner
def project_wall(rows: RowTable, r: int, x: Floats) -> int:
    """The same for a.x >= b with |a| = 1."""
    height, bound = 0.0, rows.row[r].length
    for p in range(rows.start[r], rows.start[r + 1]):
        height += rows.coefficient[p] * x[rows.column[p]]
    if not height < bound:
        return 0
    for p in range(rows.start[r], rows.start[r + 1]):
        x[rows.column[p]] += (bound - height) * rows.coefficient[p]
    return 1


@inner
def project_affine(rows: RowTable, r: int, x: Floats) -> int:
    """The same for a.x >= b."""
    missing, square = rows.row[r].length, 0.0
    for p in range(rows.start[r], rows.start[r + 1]):
        missing -= rows.coefficient[p] * x[rows.column[p]]
    if not missing > 0.0:
        return 0
    for p in range(rows.start[r], rows.start[r + 1]):
        square += rows.coefficient[p] * rows.coefficient[p]
    step = missing / square
    for p in range(rows.start[r], rows.start[r + 1]):
        x[rows.column[p]] += step * rows.coefficient[p]
    return 1


@inner
def sweep_rows(rows: RowTable, formula: int, first: int, last: int, x: Floats, d: int) -> tuple[int, int]:
    """Project onto the rows of a family, one after another: corrections, and the row without a direction or -1."""
    corrections = 0
    for r in range(first, last):
        if formula == WALL:
            moved = project_wall(rows, r, x)
        elif formula == AFFINE:
            moved = project_affine(rows, r, x)
        else:
            moved = project_distance(rows, r, x, d)
        if moved < 0:
            return corrections, r - first
        corrections += moved
    return corrections, DONE


@inner
def carry_back(x: Floats, shift: Floats, f: int, way: float, d: int) -> None:
    """Move all particles along with set f, ``way`` = 1, or to where it is at rest, ``way`` = -1."""
    for p in range(0, x.size, d):
        for k in range(d):
            x[p + k] += way * shift[f, k]


@inner
def sweep(families: Families, x: Floats) -> int:
    """Project onto one row after another of all sets where they are: OK or COINCIDENT."""
    system, pairs = system_at(families.place), families.pairs
    shift, rows, d = system.sets.shift, system.rows, system.sets.shift.shape[1]
    for f in range(families.formula.size):
        formula = families.formula[f]
        if formula == PAIRS:
            stopped = part_pairs(pairs, f, x, d)
        else:
            if families.moving[f] != 0:
                carry_back(x, shift, f, -1.0, d)
            first, last = families.first[f], families.first[f + 1]
            corrections, stopped = sweep_rows(rows, formula, first, last, x, d)
            pairs.number[CORRECTIONS] += corrections
            if families.moving[f] != 0:
                carry_back(x, shift, f, 1.0, d)
        if stopped != DONE:
            families.blamed[0], families.blamed[1] = f, stopped
            return COINCIDENT
    return OK


@kernel
def advance(place: int, sweeps: int, steps: Steps, x: Floats, v: Floats, room: Floats) -> tuple[int, int]:
    """Make steps of PBD, or of SecondOrderPBD with velocities v (n,) in place of (0,); how it ended, the step reached.

    A step that cannot be made leaves x and v (n,) as they were; ``room`` (2, n) is written to. Moving sets are seen
    from where they were carried, at the end of the step.
    """
    families = families_at(place)
    system, moved, velocity, h = system_at(families.place), room[0], room[1], steps.end / steps.number
    for step in range(steps.first, steps.last):
        t = steps.origin + step * steps.end / steps.number
        code = evaluate(system.drift, system.sets.shift.shape[1], t, x, velocity)
        if code != OK:
            return code, step
        for k in range(x.size):
            moved[k] = x[k] + h * (v[k] + h * velocity[k] if v.size > 0 else velocity[k])
        if ask(system.sets, t + h, x, PLACES) != 0:
            return SETS, step
        for _ in range(sweeps):
            code = sweep(families, moved)
            if code != OK:
                return code, step
        if not bounded(moved, LARGEST):
            return NOT_A_NUMBER, step
        for k in range(v.size):
            v[k] = (moved[k] - x[k]) / h
        for k in range(x.size):
            x[k] = moved[k]
    return OK, steps.last
