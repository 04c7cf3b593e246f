"""The linear limit of explicit Euler: h/mu times the largest eigenvalue of the Hessian of W must stay below 2."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tissue.model.energy import forces
from tissue.state.cells import CellLayers, Cells, Forces
from tissue.state.numbers import Numbers

Floats = NDArray[np.float64]
# Unknowns of a cell whose basal point is on its line.
UNKNOWNS = ("x", "y", "ax", "ay", "bx")
# Of the complex step: its square is nothing beside any force.
STEP = 1e-20
LIMIT = 2.0


def hessian(cells: Cells, layers: CellLayers, numbers: Numbers) -> Floats:
    """Return d^2 W/dZ dZ, Z = (x_1 ... x_n, y_1 ..., ax_1 ..., ay_1 ..., bx_1 ...), (5n, 5n), by complex steps."""
    n = len(cells.x)
    columns = []
    for name in UNKNOWNS:
        for i in range(n):
            moved = _complex(cells)
            getattr(moved, name)[i] += 1j * STEP
            columns.append(_slopes(forces(moved, layers, numbers)).ravel())
    matrix = np.stack(columns, axis=1)
    return (matrix + matrix.T) / 2


def own_hessians(cells: Cells, numbers: Numbers) -> Floats:
    """Return the same for each cell by itself, without junctions and repulsion, shape (n, 5, 5)."""
    alone, nobody = numbers._replace(repulsion=0.0), CellLayers(np.zeros(0, np.int64), np.zeros(0, np.int64))
    columns = []
    for name in UNKNOWNS:
        moved = _complex(cells)
        getattr(moved, name)[:] += 1j * STEP
        columns.append(_slopes(forces(moved, nobody, alone)).T)
    return np.stack(columns, axis=2)


def largest(matrix: Floats) -> Floats:
    """Return the largest eigenvalue of symmetric matrices (..., m, m)."""
    return np.asarray(np.linalg.eigvalsh(matrix)[..., -1], dtype=np.float64)


def bending(alpha: float, u: float, v: float) -> float:
    """Return 2 alpha (1/u^2 + 1/v^2 + 1/(u v)): the eigenvalue of a straight cell, nucleus u and v away from its ends.

    The angle is off by a sideways move of A, X, B as (1/u, -1/u - 1/v, 1/v), and W by alpha/2 times its square. Springs
    are at rest, so that they do not resist such a move.
    """
    return 2 * alpha * (1 / u**2 + 1 / v**2 + 1 / (u * v))


def _complex(cells: Cells) -> Cells:
    names = (*UNKNOWNS, "by")
    return cells._replace(**{name: getattr(cells, name).astype(np.complex128) for name in names})


def _slopes(at: Forces) -> Floats:
    """Return -d(force)/d(the coordinate moved), shape (5, n)."""
    return -np.stack([getattr(at, name).imag for name in UNKNOWNS]) / STEP
