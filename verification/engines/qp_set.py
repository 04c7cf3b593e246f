"""Linearised piles and chains of 10 to 10,000 rows, in the files that qpbenchmark's set of Maros and Meszaros reads."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

import dincl
from dincl.drifts import constant
from dincl.projection import NearestPoint
from dincl.rows.kinds import linearised

ROWS = (10, 30, 100, 300, 1000, 3000, 10_000)
# A bound of this magnitude is none.
INFINITE = 1e20
# Time in which a pile falls, in steps of PBD, and the length of the step that is projected.
FALL, FINE, STEP = 1.0, 0.01, 0.1


def pile(rows: int) -> NearestPoint:
    """Return a step of a pile of discs, linearised, with about as many rows: three for a disc."""
    problem = dincl.scenes.pile(max(rows // 3, 2))
    x = dincl.solve(problem, dincl.PBD(FINE), [FALL]).final
    near = linearised(problem.rows_within(FALL, x, 2 * STEP), x)
    return NearestPoint((x + STEP * problem.velocity(FALL, x)).ravel(), near.matrix, near.bound)


def chain(rows: int) -> NearestPoint:
    """Return a step of a chain of rows - 2 threads and masses of 1 and 100 by turns that falls and is drawn out.

    The first point is fixed by two equalities.
    """
    from scipy.sparse import csr_array, diags_array, eye_array, vstack

    n = rows - 1
    x = np.column_stack((np.arange(n) * 0.99, 0.1 * np.sin(np.arange(n))))
    threads = dincl.MaxDistance([(k, k + 1) for k in range(n - 1)], 1.0)
    near = linearised(dincl.Problem(x, constant([0.0, 0.0]), [threads]).rows_within(0.0, x, np.inf), x)
    moved = x + STEP * np.column_stack((x[:, 0], -np.ones(n)))
    A = vstack((eye_array(2, 2 * n), near.matrix), format="csr")
    equal = np.arange(rows) < 2
    masses = diags_array(np.repeat(np.where(np.arange(n) % 2, 100.0, 1.0), 2))
    return NearestPoint(moved.ravel(), csr_array(A), np.concatenate((x[0], near.bound)), equal, csr_array(masses))


def write(program: NearestPoint, path: Path) -> None:
    """Write min 1/2 v'Pv + q'v, l <= A v <= u to a .mat file; A ends with the identity, without bounds."""
    from scipy.io import savemat
    from scipy.sparse import csc_matrix, eye_array, vstack

    n, m = len(program.c), len(program.b)
    P: Any = eye_array(n) if program.metric is None else program.metric
    free = np.full(n, INFINITE)
    data = {"P": csc_matrix(P), "q": -(P @ program.c)[:, None], "A": csc_matrix(vstack((program.A, eye_array(n))))}
    data |= {"l": np.concatenate((program.b, -free))[:, None], "n": n, "m": m + n}
    data |= {"u": np.concatenate((np.where(program.equal, program.b, INFINITE), free))[:, None]}
    savemat(path, data, do_compression=True)


def make(folder: Path, most: int = ROWS[-1]) -> list[Path]:
    """Write the programs of at most ``most`` rows, and return their files."""
    folder.mkdir(parents=True, exist_ok=True)
    files = []
    for name, program in (("pile", pile), ("chain", chain)):
        for rows in [rows for rows in ROWS if rows <= most]:
            files.append(folder / f"{name}_{rows}.mat")
            write(program(rows), files[-1])
    return files
