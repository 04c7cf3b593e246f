"""Steps of the penalty method for small systems."""

import numpy as np

from dincl.compiled import inner, kernel
from dincl.constants import LARGEST
from dincl.kernels.arrays import Floats
from dincl.kernels.pair_list import DONE, SERVED, PairList, is_stale, list_again
from dincl.kernels.sweep_steps import PAIRS, Families, families_at
from dincl.kernels.system import COINCIDENT, NOT_A_NUMBER, OK, SETS, Steps, bounded, evaluate, system_at
from dincl.kernels.table import DISTANCE, PLACES, RowTable, ask


@inner
def push_pairs(pairs: PairList, f: int, x: Floats, d: int, spring: bool, force: Floats) -> tuple[int, int]:
    """Add the force of the near pairs of a family that overlap: how many do, and one whose centres coincide or DONE."""
    overlaps, one, other, lengths = 0, pairs.near_one, pairs.near_other, pairs.near_length
    for q in range(pairs.near_first[f], pairs.near_first[f + 1]):
        i, j, length, square = one[q], other[q], lengths[q], 0.0
        for k in range(d):
            square += (x[i + k] - x[j + k]) * (x[i + k] - x[j + k])
        distance = np.sqrt(square)
        overlap = length - distance
        if not overlap > 0.0:
            continue
        if distance == 0.0:
            return overlaps, q
        overlaps += 1
        scale, size = 1.0 / distance, overlap if spring else 1.0
        for k in range(d):
            push = (x[i + k] - x[j + k]) * scale * size
            force[i + k] += push
            force[j + k] -= push
    return overlaps, DONE


@inner
def push_distance(rows: RowTable, r: int, x: Floats, shift: Floats, spring: bool, force: Floats) -> int:
    """Add the force of a row of distances: 1 if it is violated, 0 if not, -1 if it has no direction."""
    d, f = shift.shape[1], rows.row[r].family
    row, anchor, square = rows.row[r], rows.start[r], 0.0
    i, j = row.i * d, row.j * d
    for k in range(d):
        end = x[j + k] if j >= 0 else rows.coefficient[anchor + k] + shift[f, k]
        square += (x[i + k] - end) * (x[i + k] - end)
    distance = np.sqrt(square)
    violation = -(row.sign * (distance - row.length))
    if not violation > 0.0:
        return 0
    if distance == 0.0:
        return -1
    scale, size = row.sign / distance, violation if spring else 1.0
    for k in range(d):
        end = x[j + k] if j >= 0 else rows.coefficient[anchor + k] + shift[f, k]
        push = (x[i + k] - end) * scale * size
        force[i + k] += push
        if j >= 0:
            force[j + k] -= push
    return 1


@inner
def push_affine(rows: RowTable, r: int, x: Floats, shift: Floats, spring: bool, force: Floats) -> int:
    """The same for an affine row."""
    d, f, height, carried = shift.shape[1], rows.row[r].family, 0.0, 0.0
    for p in range(rows.start[r], rows.start[r + 1]):
        height += rows.coefficient[p] * x[rows.column[p]]
        carried += rows.coefficient[p] * shift[f, rows.column[p] % d]
    violation = -(height - (rows.row[r].length + carried))
    if not violation > 0.0:
        return 0
    for p in range(rows.start[r], rows.start[r + 1]):
        force[rows.column[p]] += rows.coefficient[p] * (violation if spring else 1.0)
    return 1


@inner
def push_all(families: Families, x: Floats, spring: bool, force: Floats) -> int:
    """sum_k max(0, -g_k)^(exponent - 1) grad g_k; how many rows are violated, -1 if one has no direction."""
    system, pairs, overlaps = system_at(families.place), families.pairs, 0
    shift, rows, d = system.sets.shift, system.rows, system.sets.shift.shape[1]
    if pairs.one.size > 0 and is_stale(pairs, x, d):
        list_again(pairs, x, d)
    pairs.number[SERVED] += 1
    for k in range(x.size):
        force[k] = 0.0
    for f in range(families.formula.size):
        if families.formula[f] == PAIRS:
            found, stopped = push_pairs(pairs, f, x, d, spring, force)
            overlaps += found
            if stopped != DONE:
                families.blamed[0], families.blamed[1] = f, stopped
                return -1
        for r in range(families.first[f], families.first[f + 1]):
            if rows.row[r].kind == DISTANCE:
                found = push_distance(rows, r, x, shift, spring, force)
            else:
                found = push_affine(rows, r, x, shift, spring, force)
            if found < 0:
                families.blamed[0], families.blamed[1] = f, r - families.first[f]
                return -1
            overlaps += found
    return overlaps


@kernel
def advance(place: int, strength: float, spring: bool, steps: Steps, x: Floats, room: Floats) -> tuple[int, int]:
    """Make steps of the penalty method, of exponent 2 if ``spring`` and else 1; how it ended, and the step reached.

    A step that cannot be made leaves x (n,) as it was; ``room`` (2, n) is written to.
    """
    families = families_at(place)
    system, force, velocity, h = system_at(families.place), room[0], room[1], steps.end / steps.number
    for step in range(steps.first, steps.last):
        t = steps.origin + step * steps.end / steps.number
        code = evaluate(system.drift, system.sets.shift.shape[1], t, x, velocity)
        if code != OK:
            return code, step
        if ask(system.sets, t, x, PLACES) != 0:
            return SETS, step
        overlaps = push_all(families, x, spring, force)
        if overlaps < 0:
            return COINCIDENT, step
        for k in range(x.size):
            if overlaps > 0:
                velocity[k] += strength * force[k]
            force[k] = x[k] + h * velocity[k]
        if not bounded(force, LARGEST):
            return NOT_A_NUMBER, step
        for k in range(x.size):
            x[k] = force[k]
    return OK, steps.last
