"""The energy (3.14) of a tissue in the plane as an expression of CasADi, whose derivatives are exact."""

from __future__ import annotations

from typing import Any

import casadi

from tissue.model import bending, junctions, repulsion, springs
from tissue.model.repulsion import SOFT
from tissue.state.cells import CellLayers, Cells, Floats, Integers
from tissue.state.numbers import Numbers

# The cells at both ends of pairs.
Ends = tuple[Integers, Integers]


def cell_energy(cells: Cells, numbers: Numbers, x: Any, a: Any, b: Any) -> Any:
    """(3.9), (3.10), (3.12), for symbols x, a, b of shape (2, n)."""
    d_ax, d_bx, power = _norms(a - x), _norms(b - x), numbers.power
    cosine = casadi.sum1((a - x) * (b - x)) / (d_ax * d_bx)
    each = springs.energy(d_ax, row(1 + cells.rest_ax), row(cells.stiff_ax), power)
    each += springs.energy(d_bx, row(1 + cells.rest_bx), row(cells.stiff_bx), power)
    return casadi.sum2(each + bending.energy(cosine, row(cells.stiff_axb)))


def pair_energy(cells: Cells, layers: CellLayers, numbers: Numbers, x: Any, a: Any, soft: Ends) -> Any:
    """(3.11) and, of the pairs ``soft``, (3.13)."""
    ends = junctions.pairs(cells, layers, closed=False)
    stiffness = row(junctions.stiffness(cells, ends, numbers.junction_factor))
    apical = junctions.energy(distances(a, ends), row(cells.rest_aa[ends[0]]), stiffness)
    nuclei = repulsion.energy(casadi.fmin(SOFT, distances(x, soft)), numbers.repulsion)
    return casadi.sum2(apical) + casadi.sum2(nuclei)


def arrows(points: Any, ends: Ends) -> Any:
    """From the first ends to the second ones, one column each."""
    return points[:, ends[1].tolist()] - points[:, ends[0].tolist()]


def distances(points: Any, ends: Ends) -> Any:
    """Lengths of the arrows, in a row."""
    return _norms(arrows(points, ends))


def _norms(arrows: Any) -> Any:
    return casadi.sqrt(casadi.sum1(arrows * arrows))


def row(values: Floats) -> Any:
    """Numbers in a row."""
    return casadi.DM(values).T
