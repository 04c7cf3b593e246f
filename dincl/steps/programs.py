"""Least-distance programs of near rows, as solvers in Python take them; and single projections."""

import numpy as np

from dincl.compiled import kernel
from dincl.compiled.arrays import Floats, Indices
from dincl.solvers.factor import times
from dincl.steps.catch_up import project
from dincl.system.arrays import system_at

Program = tuple[Indices, Indices, Floats, Floats, Floats, Floats]


@kernel
def near_program(place: int) -> Program:
    """Collect min |z - y| subject to a_k . z >= b_k for the near rows of the system, with rows of length 1.

    Returns
    -------
    indptr, indices, data : (m + 1,), (e,), (e,)
        The rows a_k in compressed sparse row form.
    missing : (m,)
        b_k - a_k . y.
    length : (m,)
        The lengths of the gradients in the table, 1 for one that vanishes.
    multiplier : (m,)
        Those of a similar program.
    """
    system = system_at(place)
    rows, near, program = system.rows, system.near, system.program
    m, entries = near.number[0], 0
    for q in range(m):
        entries += rows.stop[near.row[q]] - rows.start[near.row[q]]
    indptr, indices, data = np.zeros(m + 1, np.int32), np.empty(entries, np.int32), np.empty(entries)
    missing, length, multiplier = np.empty(m), np.empty(m), np.empty(m)
    p = 0
    for q in range(m):
        r, square = near.row[q], 0.0
        for e in range(rows.start[r], rows.stop[r]):
            square += program.gradient[e] * program.gradient[e]
        length[q] = np.sqrt(square) if square > 0.0 else 1.0
        for e in range(rows.start[r], rows.stop[r]):
            indices[p], data[p] = rows.column[e], program.gradient[e] / length[q]
            p += 1
        indptr[q + 1] = p
        missing[q] = (program.bound[r] - times(rows, r, program.gradient, program.y)) / length[q]
        multiplier[q] = program.multiplier[r] * length[q]
    return indptr, indices, data, missing, length, multiplier


@kernel
def take_solution(place: int, move: Floats, multiplier: Floats) -> float:
    """Write z = y + move and the multipliers of the near rows, of length 1, into the system; the residual of z.

    The residual is the largest of |z - y - A^T multiplier|, the violations, and |min(multiplier, a . z - b)|, for the
    rows as the table has them.
    """
    system = system_at(place)
    rows, near, program = system.rows, system.near, system.program
    y, z, misfit, residual = program.y, program.z, program.direction, 0.0
    for k in range(y.size):
        z[k], misfit[k] = y[k] + move[k], move[k]
    for q in range(near.number[0]):
        r, square = near.row[q], 0.0
        for e in range(rows.start[r], rows.stop[r]):
            square += program.gradient[e] * program.gradient[e]
        length = np.sqrt(square) if square > 0.0 else 1.0
        program.multiplier[r] = multiplier[q] / length
        for e in range(rows.start[r], rows.stop[r]):
            misfit[rows.column[e]] -= program.gradient[e] * program.multiplier[r]
        value = times(rows, r, program.gradient, z) - program.bound[r]
        residual = max(residual, -value, abs(min(program.multiplier[r], value)))
    for k in range(y.size):
        residual = max(residual, abs(misfit[k]))
    return residual


@kernel
def project_once(place: int, t: float, around: Floats, reach: float, later: float, exact: bool, tol: float) -> int:
    """Project y of the system onto S(t), or onto its linearisation at ``around`` (n,), carried to a later time."""
    return project(place, t, around, reach, later, exact, tol)
