"""The nearest point of a polyhedron by the dual active-set method of Goldfarb and Idnani (1983).

The Gram matrix of the active rows has one of two factors: ``nearest`` updates an envelope; ``nearest_sparse``, for many
rows of which few change, recomputes a sparse factor at every change.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from dincl.compiled import inner, kernel
from dincl.compiled.arrays import Floats, Offsets
from dincl.rows.table import RowTable
from dincl.solvers.envelope_factor import (
    EnvelopeFactor,
    add_row,
    append,
    border,
    clear,
    drop,
    orthogonal_square,
    row_dot,
    solve_envelope,
    solve_upper,
)
from dincl.solvers.sparse_factor import SparseFactor, refactor, solve_sparse, switch_off

# UNMET: a row depends on active rows that keep it from being met, up to DEPENDENT. It is no proof of an empty set.
OK, UNMET, CYCLES = 0, 1, 2
# A row is met when it is violated by less than this part of the largest violation, or than rounding of coordinates; at
# more than this many times as much a point is no solution.
MET, ROUNDING, VIOLATED = 1e-13, 1e-15, 1e4
# A row depends on the active rows if its part orthogonal to them is shorter than the root of this.
DEPENDENT = 1e-13
# A pivot up to this is rounding.
NO_PIVOT = 1e-15
MOST_REFINEMENTS = 4
# How ``move_towards`` ends where no active row blocks: the row is met, or cannot be met.
FULL_STEP, NO_STEP = -1, -2


class LeastDistance(NamedTuple):
    """min |z - y| subject to a_r . z >= bound_r for listed rows r with unit gradients; all by number of the row."""

    gradient: Floats
    bound: Floats  # (m,)
    multiplier: Floats  # (m,): on entry those of a similar program, on return the solution's
    y: Floats  # (n,)
    z: Floats  # (n,)
    length: Floats  # (m,): the gradients of the rows of the user over those of the program
    direction: Floats  # (n,)
    answer: Floats  # (3,): iterations so far, the residual of the last solution, projections so far


def least_distance(gradient: Floats, bound: Floats, multiplier: Floats, n: int) -> LeastDistance:
    """A program for n coordinates, from the multipliers of a similar one, with y = 0."""
    length = np.ones(bound.size)
    return LeastDistance(gradient, bound, multiplier, np.zeros(n), np.zeros(n), length, np.zeros(n), np.zeros(3))


@inner
def most_violated(
    rows: RowTable, listed: Offsets, count: int, program: LeastDistance, every: bool
) -> tuple[int, float]:
    """The row that z violates most, and by how much: of every row, or of rows without a multiplier."""
    worst, violation = -1, 0.0
    for q in range(count):
        r = listed[q]
        missing = program.bound[r] - row_dot(rows, r, program.gradient, program.z)
        if missing > violation and (every or program.multiplier[r] <= 0.0):
            worst, violation = r, missing
    return worst, violation


@inner
def write_missing(rows: RowTable, program: LeastDistance, factor: Any, x: Floats) -> float:
    """Write bound - A x of the active rows into ``right``; its largest absolute value."""
    largest = 0.0
    for k in range(factor.number[0]):
        factor.right[k] = 0.0
        if factor.used[k] != 0:
            r = factor.row[k]
            factor.right[k] = program.bound[r] - row_dot(rows, r, program.gradient, x)
            largest = max(largest, abs(factor.right[k]))
    return largest


@inner
def write_point(rows: RowTable, program: LeastDistance, factor: Any) -> None:
    """Write z = y + A^T multiplier of the active rows."""
    for k in range(program.z.size):
        program.z[k] = program.y[k]
    for k in range(factor.number[0]):
        if factor.used[k] != 0:
            add_row(rows, factor.row[k], program.gradient, program.multiplier[factor.row[k]], program.z)


@inner
def move_towards(rows: RowTable, worst: int, program: LeastDistance, factor: Any) -> tuple[int, float]:
    """Move z along the part p of a = a_worst that is orthogonal to the active rows A, until the row is met.

    On entry ``right`` = (A A^T)^-1 A a, so that p = a - A^T right. A step of length s adds s p to z, s to the
    multiplier of the row and -s right to the multipliers of A; it ends where one of these becomes zero. Returns
    FULL_STEP, the place of the active row that ends the step, or NO_STEP; and |p|^2.
    """
    gradient, multiplier, direction, z = program.gradient, program.multiplier, program.direction, program.z
    for k in range(z.size):
        direction[k] = 0.0
    add_row(rows, worst, gradient, 1.0, direction)
    total, square, active = row_dot(rows, worst, gradient, direction), 0.0, 0
    for k in range(factor.number[0]):
        if factor.used[k] != 0:
            active += 1
            add_row(rows, factor.row[k], gradient, -factor.right[k], direction)
    for k in range(z.size):
        square += direction[k] * direction[k]
    free = square > DEPENDENT * total and active < z.size
    missing = program.bound[worst] - row_dot(rows, worst, gradient, z)
    step, blocking = (missing / square if free else np.inf), FULL_STEP
    for k in range(factor.number[0]):
        r = factor.row[k]
        if factor.right[k] > 0.0 and multiplier[r] < step * factor.right[k]:
            step, blocking = multiplier[r] / factor.right[k], k
    if step == np.inf:
        return NO_STEP, square
    for k in range(factor.number[0]):
        if factor.used[k] != 0:
            multiplier[factor.row[k]] = max(multiplier[factor.row[k]] - step * factor.right[k], 0.0)
    multiplier[worst] += step
    if free:
        for k in range(z.size):
            z[k] += step * direction[k]
    if blocking >= 0:
        multiplier[factor.row[blocking]] = 0.0
    return blocking, square


@inner
def write_combination(worst: int, program: LeastDistance, factor: Any) -> None:
    """Write the multipliers of a combination of rows that nearly vanishes: a = A^T right after NO_STEP, right <= 0."""
    multiplier = program.multiplier
    for r in range(multiplier.size):
        multiplier[r] = 0.0
    for k in range(factor.number[0]):
        if factor.used[k] != 0:
            multiplier[factor.row[k]] = -factor.right[k]
    multiplier[worst] = 1.0


@inner
def warm_start(rows: RowTable, listed: Offsets, count: int, program: LeastDistance, factor: EnvelopeFactor) -> None:
    """Activate the independent ones of the rows with a multiplier, less rows whose multiplier is now negative."""
    gradient, multiplier = program.gradient, program.multiplier
    for q in range(count):
        r = listed[q]
        if multiplier[r] > 0.0:
            border(rows, r, gradient, factor)
            square = orthogonal_square(rows, r, gradient, factor)
            multiplier[r] = 0.0
            if square > DEPENDENT and factor.number[0] < program.y.size:
                append(rows, factor, r, square)
    negative = True
    while negative:
        write_missing(rows, program, factor, program.y)
        solve_envelope(factor)
        for k in range(factor.number[0]):
            multiplier[factor.row[k]] = factor.right[k]
        negative = False
        for k in range(factor.number[0] - 1, -1, -1):
            if multiplier[factor.row[k]] <= 0.0:
                multiplier[factor.row[k]], negative = 0.0, True
                drop(rows, factor, k)
    write_point(rows, program, factor)


@inner
def warm_start_sparse(
    rows: RowTable, listed: Offsets, count: int, program: LeastDistance, factor: SparseFactor
) -> None:
    """The same for a sparse factor."""
    gradient, multiplier = program.gradient, program.multiplier
    for q in range(count):
        factor.used[factor.place[listed[q]]] = 1 if multiplier[listed[q]] > 0.0 else 0
    negative = True
    while negative:
        refactor(rows, gradient, factor, DEPENDENT)
        write_missing(rows, program, factor, program.y)
        solve_sparse(factor)
        negative = False
        for k in range(factor.number[0]):
            multiplier[factor.row[k]] = factor.right[k]
            if factor.used[k] != 0 and factor.right[k] <= 0.0:
                multiplier[factor.row[k]], factor.used[k], negative = 0.0, 0, True
    write_point(rows, program, factor)


@inner
def meet(rows: RowTable, worst: int, program: LeastDistance, factor: EnvelopeFactor) -> int:
    """Move z until row ``worst`` is met, and activate it; OK, or UNMET."""
    while True:
        border(rows, worst, program.gradient, factor)
        solve_upper(factor)
        blocking, square = move_towards(rows, worst, program, factor)
        if blocking == NO_STEP:
            return UNMET
        if blocking == FULL_STEP:
            append(rows, factor, worst, square)
            return OK
        drop(rows, factor, blocking)


@inner
def meet_sparse(rows: RowTable, worst: int, program: LeastDistance, factor: SparseFactor) -> int:
    """The same for a sparse factor; CYCLES if a row became dependent."""
    gradient, dense = program.gradient, factor.dense
    while True:
        for p in range(rows.start[worst], rows.stop[worst]):
            dense[rows.column[p]] += gradient[p]
        for k in range(factor.number[0]):
            factor.right[k] = row_dot(rows, factor.row[k], gradient, dense) if factor.used[k] != 0 else 0.0
        for p in range(rows.start[worst], rows.stop[worst]):
            dense[rows.column[p]] = 0.0
        solve_sparse(factor)
        blocking, _ = move_towards(rows, worst, program, factor)
        if blocking == NO_STEP:
            return UNMET
        if blocking == FULL_STEP:
            factor.used[factor.place[worst]] = 1
        else:
            factor.used[blocking] = 0
        if refactor(rows, gradient, factor, NO_PIVOT) > 0:
            return CYCLES
        if blocking == FULL_STEP:
            return OK


def _method(clear: Any, warm_start: Any, meet: Any, solve: Any) -> Callable[..., int]:
    """Make the method for a factor with these functions."""

    @inner
    def method(rows: RowTable, listed: Offsets, count: int, program: LeastDistance, factor: Any, size: float) -> int:
        y, z, multiplier = program.y, program.z, program.multiplier
        for k in range(y.size):
            z[k] = y[k]
            size = max(size, abs(y[k]))
        clear(factor)
        worst, violation = most_violated(rows, listed, count, program, True)
        allowed = MET * violation + ROUNDING * size
        program.answer[1] = violation
        if violation <= allowed:
            for q in range(count):
                multiplier[listed[q]] = 0.0
            return OK
        warm_start(rows, listed, count, program, factor)
        # Row after row is met exactly, while rows whose multipliers would become negative leave the active set. The
        # distance from y grows with every row, so the iteration ends.
        for _ in range(20 * (count + 1)):
            worst, violation = most_violated(rows, listed, count, program, False)
            if violation <= allowed:
                break
            program.answer[0] += 1.0
            code = meet(rows, worst, program, factor)
            if code == UNMET and violation > VIOLATED * allowed:
                write_combination(worst, program, factor)
            if code == CYCLES or (code == UNMET and violation > VIOLATED * allowed):
                return int(code)
            if code == UNMET:
                multiplier[worst] = 0.0
                break
        # The multipliers are refined until the active rows are met to rounding.
        last = np.inf
        for refinement in range(MOST_REFINEMENTS + 1):
            write_point(rows, program, factor)
            largest = write_missing(rows, program, factor, z)
            program.answer[1] = largest
            if largest <= ROUNDING * size or not largest < 0.5 * last or refinement == MOST_REFINEMENTS:
                break
            last = largest
            solve(factor)
            for k in range(factor.number[0]):
                if factor.used[k] != 0:
                    multiplier[factor.row[k]] = max(multiplier[factor.row[k]] + factor.right[k], 0.0)
        worst, violation = most_violated(rows, listed, count, program, True)
        program.answer[1] = max(program.answer[1], violation)
        return OK if violation <= VIOLATED * allowed else CYCLES

    return method


# (rows, listed, count, program, factor, size): write the nearest point z = y + sum_r multiplier_r a_r of the first
# ``count`` listed rows; OK, CYCLES where rounding prevents a solution, or UNMET, after which the rows with multipliers
# are those that contradict each other. Rounding is relative to the largest number in y or ``size``, if that is larger.
nearest = _method(clear, warm_start, meet, solve_envelope)
# For rows that the factor has analysed. CYCLES also where rounding makes independent rows dependent: ``nearest`` may
# still find the point.
nearest_sparse = _method(switch_off, warm_start_sparse, meet_sparse, solve_sparse)


@kernel
def solve(rows: RowTable, listed: Offsets, program: LeastDistance, factor: EnvelopeFactor) -> int:
    """Do ``nearest`` for all rows listed."""
    return nearest(rows, listed, listed.size, program, factor, 0.0)
