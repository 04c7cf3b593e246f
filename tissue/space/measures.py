"""What is measured of a tissue in space at one time."""

from __future__ import annotations

import numpy as np

from tissue.kernels import kernel
from tissue.kernels.store import CELLS, Store, stored
from tissue.space.mesh import Sheets, network_of
from tissue.space.scale import position_in_space
from tissue.space.state import SPATIAL, no_space
from tissue.state.cells import Cells, Floats


def positions_in_space(cells: Cells, sheets: Sheets) -> Floats:
    """y_AB of all cells, (n,); see ``tissue.space.scale``."""
    n = len(cells.x)
    space = no_space()._replace(dimension=SPATIAL, surface=sheets.surface, apical=network_of(sheets.apical, n))
    found = np.empty(n)
    _measure_all(stored(cells, capacity=n, space=space), found)
    return found


@kernel
def _measure_all(store: Store, found: Floats) -> None:
    for i in range(store.sizes[CELLS]):
        found[i] = position_in_space(store, i)


def basal_area(cells: Cells, sheets: Sheets) -> float:
    """The area of all triangles of the basal network [R_soft^2]."""
    points = np.column_stack((cells.bx, cells.by, cells.bz))[sheets.basal.triangles]
    sides = points[:, 1:] - points[:, :1]
    for axis, period in ((0, sheets.surface.period_x), (2, sheets.surface.period_z)):
        if np.isfinite(period):
            sides[..., axis] -= period * np.round(sides[..., axis] / period)
    return float(np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1).sum() / 2)


def basal_length(cells: Cells, sheets: Sheets) -> float:
    """The length of all edges of the basal network of a strip, which has no periods [R_soft]."""
    i, j = sheets.basal.edges.T
    points = np.column_stack((cells.bx, cells.by, cells.bz))
    return float(np.linalg.norm(points[j] - points[i], axis=1).sum())
