"""A section through a tissue in space, as a tissue in the plane: what one sees of a slice under a microscope."""

from __future__ import annotations

import math

import numpy as np

from tissue.frames.frame import Frame
from tissue.state.basal_curve import LINE, ellipse
from tissue.state.cells import CellLayers, Cells, Floats
from tissue.state.space import Mesh
from tissue.state.surface import PLANE, Surface


def in_one_period(surface: Surface, corners: Floats, z: float = 0.0) -> Floats:
    """Move the corners of polygons (m, k, 3) together, and their middles into the period around x = 0 and this z."""
    found = corners.copy()
    for axis, period, middle in ((0, surface.period_x, 0.0), (2, surface.period_z, z)):
        if math.isfinite(period):
            x = found[..., axis]  # a view
            x -= period * np.round((x - x[:, :1]) / period)
            x -= period * np.round((x.mean(axis=1, keepdims=True) - middle) / period)
    return found


def cut(surface: Surface, mesh: Mesh, points: Floats, z: float = 0.0) -> Floats:
    """Cut the triangles with a plane; return x and y of both ends of each piece, (m, 2, 2).

    Parameters
    ----------
    mesh
        The network.
    points
        Of all cells, (n, 3).
    z
        Of the plane; along a period, of all its images.
    """
    corners = in_one_period(surface, points[mesh.triangles], z)
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


def section(frame: Frame, z: float = 0.0) -> Frame:
    """Return the cells whose nuclei, the hard balls, are cut by the plane z = const., from left to right, or around.

    A frame of a tissue in the plane is its own section. The layers of a section are these cells in their order, not the
    neighbours of the networks; ``cut_of`` is the apical layer. Of a sheet it is one period in x. Nothing can be started
    from it.
    """
    if frame.sheets is None:
        return frame
    cells, surface = frame.cells, frame.sheets.surface
    deep = cells.z - z
    if math.isfinite(surface.period_z):
        deep = deep - surface.period_z * np.round(deep / surface.period_z)
    chosen = np.flatnonzero(np.abs(deep) <= cells.radius)
    if surface.bends == PLANE:
        cells = _wrapped(cells, surface.period_x)
    across = cells.bx if surface.bends == PLANE else np.arctan2(surface.side * cells.bx, surface.side * cells.by)
    ordered = chosen[np.argsort(surface.side * across[chosen], kind="stable")]
    kept = Cells._make(array[..., ordered] for array in cells)
    layers = CellLayers(*(np.flatnonzero(np.isin(ordered, layer)) for layer in frame.layers))
    if surface.bends == PLANE:
        return Frame(frame.t, kept, layers, LINE)
    down = _down(surface)
    kept = kept._replace(y=kept.y - down, ay=kept.ay - down, by=kept.by - down)
    around = 2.0 * math.pi * surface.radius
    return Frame(frame.t, kept, layers, ellipse(around, 1.0, inside=surface.side < 0.0, ring=True))


def cut_of(frame: Frame, z: float = 0.0) -> Floats | None:
    """Return the pieces of the apical layer that the plane cuts, (m, 2, 2), beside ``section``; None in a slice."""
    if frame.sheets is None:
        return None
    cells, surface = frame.cells, frame.sheets.surface
    pieces = cut(surface, frame.sheets.apical, np.column_stack((cells.ax, cells.ay, cells.az)), z)
    if surface.bends != PLANE:
        pieces[..., 1] -= _down(surface)
    return pieces


def _wrapped(cells: Cells, period: float) -> Cells:
    """Return each cell in the period around x = 0: its nucleus, and the images of its points that are nearest to it."""
    if not math.isfinite(period):
        return cells
    x = cells.x - period * np.round(cells.x / period)
    ax, bx = (at - period * np.round((at - x) / period) for at in (cells.ax, cells.bx))
    return cells._replace(x=x, ax=ax, bx=bx)


def _down(surface: Surface) -> float:
    """Return the shift that puts the point of arclength 0 of the circle of a section at the origin."""
    return surface.side * surface.radius
