"""The nearest point of a polyhedron by the dual active-set method of Goldfarb and Idnani (1983)."""

from typing import NamedTuple

import numpy as np

from dincl.compiled import inner, kernel
from dincl.compiled.arrays import Floats, Offsets
from dincl.rows.table import RowTable
from dincl.solvers.factor import Chosen, add, append, backward, border, clear, drop, forward, times

OK, INFEASIBLE, CYCLES = 0, 1, 2
# A row is met when it is violated by less than this part of the largest violation, or than rounding of coordinates.
MET, ROUNDING = 1e-13, 1e-15
# A row whose part across the chosen ones is shorter than the root of this depends on them.
DEPENDENT = 1e-13
MOST_ROUNDS = 4


class LeastDistance(NamedTuple):
    """min |z - y| subject to a_r . z >= bound_r for listed rows r with unit gradients; all by number of the row."""

    gradient: Floats
    bound: Floats  # (m,)
    multiplier: Floats  # (m,): on entry those of a similar program, on return the solution's
    y: Floats  # (n,)
    z: Floats  # (n,)
    direction: Floats  # (n,)
    answer: Floats  # (3,): iterations so far, the residual of the last solution, projections so far


def least_distance(gradient: Floats, bound: Floats, multiplier: Floats, n: int) -> LeastDistance:
    """A program for n coordinates, from the multipliers of a similar one, with y = 0."""
    return LeastDistance(gradient, bound, multiplier, np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(3))


@inner
def nearest(rows: RowTable, listed: Offsets, count: int, program: LeastDistance, chosen: Chosen, size: float) -> int:
    """Write the nearest point to y into z; OK, INFEASIBLE, or CYCLES where rounding has the last word.

    Rounding is that of numbers as large as y or ``size``, whichever is larger.

    From y a row of largest violation after the other is met exactly, while multipliers that would become negative
    leave: the distance from y grows with every row, so that it ends. z = y + sum_r multiplier_r a_r by its making.
    """
    y, z = program.y, program.z
    for k in range(y.size):
        z[k] = y[k]
        size = max(size, abs(y[k]))
    clear(chosen)
    worst, violation = most_violated(rows, listed, count, program, True)
    allowed = MET * violation + ROUNDING * size
    program.answer[1] = violation
    if violation <= allowed:
        for q in range(count):
            program.multiplier[listed[q]] = 0.0
        return OK
    start(rows, listed, count, program, chosen)
    for _ in range(20 * (count + 1)):
        worst, violation = most_violated(rows, listed, count, program, False)
        if violation <= allowed:
            break
        program.answer[0] += 1.0
        if not meet(rows, worst, program, chosen):
            if violation > 1e4 * allowed:
                return INFEASIBLE
            program.multiplier[worst] = 0.0
            break
    finish(rows, program, chosen, ROUNDING * size)
    worst, violation = most_violated(rows, listed, count, program, True)
    program.answer[1] = max(program.answer[1], violation)
    return OK if violation <= 1e4 * allowed else CYCLES


@inner
def most_violated(
    rows: RowTable, listed: Offsets, count: int, program: LeastDistance, every: bool
) -> tuple[int, float]:
    """Give the row that z violates most, and by how much: of every row, or of those without a multiplier."""
    worst, violation = -1, 0.0
    for q in range(count):
        r = listed[q]
        missing = program.bound[r] - times(rows, r, program.gradient, program.z)
        if missing > violation and (every or program.multiplier[r] <= 0.0):
            worst, violation = r, missing
    return worst, violation


@inner
def start(rows: RowTable, listed: Offsets, count: int, program: LeastDistance, chosen: Chosen) -> None:
    """Choose the rows that had multipliers, less those of which they are now negative."""
    gradient, multiplier = program.gradient, program.multiplier
    for q in range(count):
        r = listed[q]
        if multiplier[r] > 0.0:
            border(rows, r, gradient, chosen)
            square = across(rows, r, gradient, chosen)
            multiplier[r] = 0.0
            if square > DEPENDENT and chosen.number[0] < program.y.size:
                append(rows, chosen, r, square)
    negative = True
    while negative:
        for k in range(chosen.number[0]):
            r = chosen.row[k]
            chosen.right[k] = program.bound[r] - times(rows, r, gradient, program.y)
        forward(chosen, 0)
        backward(chosen)
        for k in range(chosen.number[0]):
            multiplier[chosen.row[k]] = chosen.right[k]
        negative = False
        for k in range(chosen.number[0] - 1, -1, -1):
            r = chosen.row[k]
            if multiplier[r] <= 0.0:
                multiplier[r], negative = 0.0, True
                drop(rows, chosen, k)
    for k in range(chosen.number[0]):
        add(rows, chosen.row[k], gradient, multiplier[chosen.row[k]], program.z)


@inner
def across(rows: RowTable, r: int, gradient: Floats, chosen: Chosen) -> float:
    """|a_r|^2 less the square of its part along the chosen rows, from what ``border`` left."""
    square = 0.0
    for p in range(rows.start[r], rows.stop[r]):
        square += gradient[p] * gradient[p]
    for k in range(chosen.first[chosen.number[0]], chosen.number[0]):
        square -= chosen.right[k] * chosen.right[k]
    return square


@inner
def meet(rows: RowTable, worst: int, program: LeastDistance, chosen: Chosen) -> bool:
    """Move z until the row is met, along the part of its gradient across the chosen rows; False if it cannot be."""
    gradient, multiplier, direction, z = program.gradient, program.multiplier, program.direction, program.z
    while True:
        border(rows, worst, gradient, chosen)
        backward(chosen)
        for k in range(z.size):
            direction[k] = 0.0
        add(rows, worst, gradient, 1.0, direction)
        for k in range(chosen.number[0]):
            add(rows, chosen.row[k], gradient, -chosen.right[k], direction)
        square, total = 0.0, 0.0
        for k in range(z.size):
            square += direction[k] * direction[k]
        for p in range(rows.start[worst], rows.stop[worst]):
            total += gradient[p] * gradient[p]
        missing = program.bound[worst] - times(rows, worst, gradient, z)
        free = square > DEPENDENT * total and chosen.number[0] < z.size
        step, blocking = (missing / square if free else np.inf), -1
        for k in range(chosen.number[0]):
            push = multiplier[chosen.row[k]]
            if chosen.right[k] > 0.0 and push < step * chosen.right[k]:
                step, blocking = push / chosen.right[k], k
        if step == np.inf:
            return False
        for k in range(chosen.number[0]):
            r = chosen.row[k]
            multiplier[r] = max(multiplier[r] - step * chosen.right[k], 0.0)
        multiplier[worst] += step
        if free:
            for k in range(z.size):
                z[k] += step * direction[k]
        if blocking < 0:
            append(rows, chosen, worst, square)
            return True
        multiplier[chosen.row[blocking]] = 0.0
        drop(rows, chosen, blocking)


@inner
def finish(rows: RowTable, program: LeastDistance, chosen: Chosen, allowed: float) -> None:
    """Make z = y + A^T multiplier anew and refine the multipliers until the chosen rows are met to rounding."""
    gradient, multiplier, y, z = program.gradient, program.multiplier, program.y, program.z
    last = np.inf
    for _ in range(MOST_ROUNDS):
        for k in range(z.size):
            z[k] = y[k]
        for k in range(chosen.number[0]):
            add(rows, chosen.row[k], gradient, multiplier[chosen.row[k]], z)
        largest = 0.0
        for k in range(chosen.number[0]):
            r = chosen.row[k]
            chosen.right[k] = program.bound[r] - times(rows, r, gradient, z)
            largest = max(largest, abs(chosen.right[k]))
        program.answer[1] = largest
        if largest <= allowed or not largest < 0.5 * last:
            break
        last = largest
        forward(chosen, 0)
        backward(chosen)
        for k in range(chosen.number[0]):
            r = chosen.row[k]
            multiplier[r] = max(multiplier[r] + chosen.right[k], 0.0)


@kernel
def solve(rows: RowTable, listed: Offsets, program: LeastDistance, chosen: Chosen) -> int:
    """``nearest`` for all rows listed."""
    return nearest(rows, listed, listed.size, program, chosen, 0.0)
