"""Where the plane z = const. cuts a network of a tissue in space: exact, triangle by triangle."""

from __future__ import annotations

import math

import numpy as np

from tissue.space.mesh import Mesh
from tissue.space.surface import Surface
from tissue.state.cells import Floats


def cut(surface: Surface, mesh: Mesh, points: Floats, z: float = 0.0) -> Floats:
    """The pieces of the cut, (m, 2, 2): x and y of both ends of each, in the triangles that the plane goes through.

    Parameters
    ----------
    mesh
        The network.
    points
        Of all cells, (n, 3).
    z
        Of the plane; along a period, of all its images.
    """
    corners = points[mesh.triangles]
    for axis, period in ((0, surface.period_x), (2, surface.period_z)):
        if math.isfinite(period):
            apart = corners[:, :, axis] - corners[:, :1, axis]
            corners[:, :, axis] = corners[:, :1, axis] + apart - period * np.round(apart / period)
            middle = corners[:, :, axis].mean(axis=1, keepdims=True) - (z if axis == 2 else 0.0)
            corners[:, :, axis] -= period * np.round(middle / period)
    above = corners[:, :, 2] > z
    count = above.sum(axis=1)
    crossed = (count == 1) | (count == 2)
    corners, above, count = corners[crossed], above[crossed], count[crossed]
    alone = np.argmax(above == (count == 1)[:, None], axis=1)  # the corner that is alone on its side
    rows = np.arange(len(corners))
    ends = []
    for k in (1, 2):
        a, b = corners[rows, alone], corners[rows, (alone + k) % 3]
        part = (z - a[:, 2]) / (b[:, 2] - a[:, 2])
        ends.append(a[:, :2] + part[:, None] * (b - a)[:, :2])
    pieces: Floats = np.stack(ends, axis=1)
    return pieces
