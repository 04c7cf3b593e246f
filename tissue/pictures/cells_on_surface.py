"""Cells as one sees them on the apical surface of a tissue in space: polygons around their apical points."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from tissue.state.cells import Floats, Integers
from tissue.state.mesh import Mesh
from tissue.state.surface import Surface

MAKES_NO_NUMBERS = True


def polygons(surface: Surface, mesh: Mesh, points: Floats) -> Iterator[tuple[int, Floats]]:
    """Each cell that has neighbours all around, with its corners (k, 3), counterclockwise: the dual of the network.

    The corners are the middles of the triangles of the cell, in one period.
    """
    corner, twin = mesh.corner, mesh.twin
    for cell, first in enumerate(mesh.out[: len(points)].tolist()):
        ring = list(_around(twin, first)) if first >= 0 else []
        triangles = [corner[3 * (h // 3) : 3 * (h // 3) + 3] for h in ring]
        if ring and min(min(t) for t in triangles) >= 0:
            at = in_one_period(surface, points[cell])
            yield cell, np.array([at + _apart(surface, points[t] - points[cell]).mean(axis=0) for t in triangles])


def in_one_period(surface: Surface, points: Floats) -> Floats:
    """The images of points (..., 3) that are nearest to the middle of the sheet."""
    return _apart(surface, points)


def _apart(surface: Surface, arrows: Floats) -> Floats:
    found = arrows.copy()
    for axis, period in ((0, surface.period_x), (2, surface.period_z)):
        if math.isfinite(period):
            found[..., axis] -= period * np.round(found[..., axis] / period)
    return found


def _around(twin: Integers, first: int) -> Iterator[int]:
    """The half-edges that leave a vertex, counterclockwise."""
    h = first
    while True:
        yield h
        h = int(twin[h + 2 if h % 3 == 0 else h - 1])
        if h == first:
            return
