"""Second derivatives of the energy of a cell, by complex steps."""

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


def own_hessians(cells: Cells, numbers: Numbers) -> Floats:
    """Return d^2 W/dZ dZ of each cell by itself, without junctions and repulsion: Z its UNKNOWNS, shape (n, 5, 5)."""
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


def _complex(cells: Cells) -> Cells:
    names = (*UNKNOWNS, "by")
    return cells._replace(**{name: getattr(cells, name).astype(np.complex128) for name in names})


def _slopes(at: Forces) -> Floats:
    """Return -d(force)/d(the coordinate moved), shape (5, n)."""
    return -np.stack([getattr(at, name).imag for name in UNKNOWNS]) / STEP
