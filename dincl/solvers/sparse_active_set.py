"""The dual active-set method of ``active_set`` for many rows, with a sparse factor that is recomputed at every change.

In a run from event to event the rows that push are nearly those of the last event, so that changes are few.
"""

import numpy as np

from dincl.compiled import inner
from dincl.compiled.arrays import Floats, Offsets
from dincl.rows.table import RowTable
from dincl.solvers.active_set import (
    CYCLES,
    DEPENDENT,
    INFEASIBLE,
    MET,
    MOST_ROUNDS,
    OK,
    ROUNDING,
    LeastDistance,
    most_violated,
)
from dincl.solvers.factor import add, times
from dincl.solvers.sparse_factor import SparseGram, refactor, solve_sparse

# A pivot up to this is rounding.
NO_PIVOT = 1e-15


@inner
def nearest_sparse(
    rows: RowTable, listed: Offsets, count: int, program: LeastDistance, gram: SparseGram, size: float
) -> int:
    """Do what ``active_set.nearest`` does, for rows that ``gram`` has analysed.

    CYCLES also where rounding makes rows dependent that were not: ``active_set.nearest`` may still find an answer.
    """
    y, z = program.y, program.z
    for k in range(y.size):
        z[k] = y[k]
        size = max(size, abs(y[k]))
    for k in range(gram.number[0]):
        gram.used[k] = 0
    gram.number[1] = 0
    worst, violation = most_violated(rows, listed, count, program, True)
    allowed = MET * violation + ROUNDING * size
    program.answer[1] = violation
    if violation <= allowed:
        for q in range(count):
            program.multiplier[listed[q]] = 0.0
        return OK
    start_sparse(rows, listed, count, program, gram)
    for _ in range(20 * (count + 1)):
        worst, violation = most_violated(rows, listed, count, program, False)
        if violation <= allowed:
            break
        program.answer[0] += 1.0
        code = meet_sparse(rows, worst, program, gram)
        if code == CYCLES:
            return CYCLES
        if code == INFEASIBLE:
            if violation > 1e4 * allowed:
                return INFEASIBLE
            program.multiplier[worst] = 0.0
            break
    finish_sparse(rows, program, gram, ROUNDING * size)
    worst, violation = most_violated(rows, listed, count, program, True)
    program.answer[1] = max(program.answer[1], violation)
    return OK if violation <= 1e4 * allowed else CYCLES


@inner
def start_sparse(rows: RowTable, listed: Offsets, count: int, program: LeastDistance, gram: SparseGram) -> None:
    """Use the rows that had multipliers, less those of which they are now negative, and those that depend on others."""
    gradient, multiplier = program.gradient, program.multiplier
    for q in range(count):
        gram.used[gram.place[listed[q]]] = 1 if multiplier[listed[q]] > 0.0 else 0
    negative = True
    while negative:
        refactor(rows, gradient, gram, DEPENDENT)
        missing(rows, program, gram, program.y)
        solve_sparse(gram)
        negative = False
        for k in range(gram.number[0]):
            multiplier[gram.row[k]] = gram.right[k]
            if gram.used[k] != 0 and gram.right[k] <= 0.0:
                multiplier[gram.row[k]], gram.used[k], negative = 0.0, 0, True
    push_out(rows, program, gram)


@inner
def missing(rows: RowTable, program: LeastDistance, gram: SparseGram, x: Floats) -> float:
    """Write how much the rows in use miss of their bounds at x into ``right``; the largest of it."""
    largest = 0.0
    for k in range(gram.number[0]):
        gram.right[k] = 0.0
        if gram.used[k] != 0:
            r = gram.row[k]
            gram.right[k] = program.bound[r] - times(rows, r, program.gradient, x)
            largest = max(largest, abs(gram.right[k]))
    return largest


@inner
def push_out(rows: RowTable, program: LeastDistance, gram: SparseGram) -> None:
    """Write y + A^T multiplier into z."""
    for k in range(program.z.size):
        program.z[k] = program.y[k]
    for k in range(gram.number[0]):
        if gram.used[k] != 0:
            add(rows, gram.row[k], program.gradient, program.multiplier[gram.row[k]], program.z)


@inner
def meet_sparse(rows: RowTable, worst: int, program: LeastDistance, gram: SparseGram) -> int:
    """Move z until the row is met, along the part of its gradient across the rows in use; or why it cannot be."""
    gradient, multiplier, direction, z = program.gradient, program.multiplier, program.direction, program.z
    while True:
        for k in range(z.size):
            direction[k] = 0.0
        add(rows, worst, gradient, 1.0, direction)
        total = times(rows, worst, gradient, direction)
        for k in range(gram.number[0]):
            gram.right[k] = times(rows, gram.row[k], gradient, direction) if gram.used[k] != 0 else 0.0
        solve_sparse(gram)
        for k in range(gram.number[0]):
            if gram.used[k] != 0:
                add(rows, gram.row[k], gradient, -gram.right[k], direction)
        square = 0.0
        for k in range(z.size):
            square += direction[k] * direction[k]
        free = square > DEPENDENT * total and gram.number[1] < z.size
        step, blocking = (program.bound[worst] - times(rows, worst, gradient, z)) / square if free else np.inf, -1
        for k in range(gram.number[0]):
            push = multiplier[gram.row[k]]
            if gram.right[k] > 0.0 and push < step * gram.right[k]:
                step, blocking = push / gram.right[k], k
        if step == np.inf:
            return INFEASIBLE
        for k in range(gram.number[0]):
            if gram.used[k] != 0:
                multiplier[gram.row[k]] = max(multiplier[gram.row[k]] - step * gram.right[k], 0.0)
        multiplier[worst] += step
        if free:
            for k in range(z.size):
                z[k] += step * direction[k]
        if blocking >= 0:
            multiplier[gram.row[blocking]], gram.used[blocking] = 0.0, 0
        else:
            gram.used[gram.place[worst]] = 1
        if refactor(rows, gradient, gram, NO_PIVOT) > 0:
            return CYCLES
        if blocking < 0:
            return OK


@inner
def finish_sparse(rows: RowTable, program: LeastDistance, gram: SparseGram, allowed: float) -> None:
    """Compute z = y + A^T multiplier and refine the multipliers until the rows in use are met to rounding."""
    last = np.inf
    for _ in range(MOST_ROUNDS):
        push_out(rows, program, gram)
        largest = missing(rows, program, gram, program.z)
        program.answer[1] = largest
        if largest <= allowed or not largest < 0.5 * last:
            break
        last = largest
        solve_sparse(gram)
        for k in range(gram.number[0]):
            if gram.used[k] != 0:
                r = gram.row[k]
                program.multiplier[r] = max(program.multiplier[r] + gram.right[k], 0.0)
