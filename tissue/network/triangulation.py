"""Delaunay's triangulation of points on a surface, by Qhull: a plane or a cylinder, each periodic or open, or a sphere.

The plane has the flat chart (z, x), the cylinder (side r angle, z), where r is the mean distance of the points from its
axis: with another one triangles around it would be long, and an apical layer would draw together. A sphere is the
convex hull of the normals at its points. Along a period copies of the points near its ends stand on the other side.
"""

from __future__ import annotations

import heapq
import math

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial import ConvexHull, Delaunay, QhullError

from dincl import checks
from dincl.errors import InvalidProblem
from tissue.state.cells import Floats, Integers
from tissue.state.surface import CYLINDER, SPHERE, Surface, normals

# Points on a lattice have many triangulations of Delaunay. Each is moved by this part of the mean distance, always the
# same way, so that periodic images of four points get the same diagonal.
NUDGE = 1e-7
# Copies are made of the points this many mean distances from an end of a period, and of more where that is too few:
# triangles are seldom longer.
MARGIN = 2.0
# A triangle at a free boundary that is flatter than this, its height over its longest side, is none: a straight
# boundary has none.
FLATTEST = 1e-6
NO_SURFACE = "must be in no line, and more than two around each period or around a sphere, apart from each other"


def triangulate(surface: Surface, points: ArrayLike, longest: float = math.inf) -> tuple[Integers, Integers]:
    """Return the edges (m, 2), pairs i < j in increasing order, and the triangles (T, 3) of points (n, 3).

    Triangles are counterclockwise as seen from the tissue. A surface with a free boundary is the convex hull on the
    chart, from whose boundary edges above ``longest`` in space are taken off, but no point is. A triangle that spans
    half of a period is left out, since its cells are nearer on the other side: there is a hole.

    Raises
    ------
    InvalidProblem
        For points that are too few or in a line: each must have a triangle.
    """
    at = checks.shaped("points", points, (None, 3))
    if surface.bends == SPHERE:
        found, closed = _hull(normals(surface, at)), True
    else:
        chart, periods = _chart(surface, at)
        found, closed = _flat(chart, periods), bool(np.isfinite(periods).all())
    if not closed:
        found = _trimmed(surface, at, found, longest)
    return edges_of(found)[0], found


def edges_of(triangles: Integers) -> tuple[Integers, Integers]:
    """Return the edges (m, 2) of triangles, each once, i < j, in increasing order; and how many triangles each has."""
    n = int(triangles.max(initial=0)) + 1
    begins, ends = triangles.T.ravel(), triangles[:, [1, 2, 0]].T.ravel()
    keys, counts = np.unique(np.minimum(begins, ends) * n + np.maximum(begins, ends), return_counts=True)
    return np.column_stack(np.divmod(keys, n)), counts


def distances(surface: Surface, points: Floats, edges: Integers) -> Floats:
    """Compute the lengths in space of edges (m, 2) between points (n, 3), to the nearest images [R_soft]."""
    apart = points[edges[:, 1]] - points[edges[:, 0]]
    for axis, period in ((0, surface.period_x), (2, surface.period_z)):
        if math.isfinite(period):
            apart[:, axis] -= period * np.round(apart[:, axis] / period)
    lengths: Floats = np.sqrt((apart**2).sum(axis=1))
    return lengths


def _chart(surface: Surface, points: Floats) -> tuple[Floats, Floats]:
    """Return the places (n, 2) of points on the flat chart, and its periods (2,)."""
    x, y, z = points.T
    if surface.bends == CYLINDER:
        radius = float(np.hypot(x, y).mean()) if len(x) else surface.radius
        along = surface.side * radius * np.arctan2(y, x)
        return np.column_stack((along, z)), np.array((2.0 * math.pi * radius, surface.period_z))
    return np.column_stack((z, x)), np.array((surface.period_z, surface.period_x))


def _hull(chart: Floats) -> Integers:
    """Return the triangles of points (n, 3) on the unit sphere."""
    n = len(chart)
    try:
        hull = ConvexHull(chart)
    except (QhullError, ValueError):
        raise InvalidProblem(f"points = {n} points: {NO_SURFACE}") from None
    found = hull.simplices.astype(np.int64)
    # All points are corners, and the middle of the sphere is inside of all planes.
    if len(found) != 2 * n - 4 or not (hull.equations[:, 3] < 0.0).all():
        raise InvalidProblem(f"points = {n} points: {NO_SURFACE}")
    a, b, c = (chart[found[:, k]] for k in range(3))
    left = np.einsum("ij,ij->i", a, np.cross(b, c)) > 0.0
    turned: Integers = np.where(left[:, None], found, found[:, ::-1])
    return turned


def _flat(chart: Floats, periods: Floats) -> Integers:
    """Return the triangles of points (n, 2) on a flat chart with these periods, inf for none."""
    n, along = len(chart), np.flatnonzero(np.isfinite(periods))
    inside = chart.copy()
    inside[:, along] %= periods[along]
    size = np.where(np.isfinite(periods), periods, np.ptp(inside, axis=0)) if n else np.zeros(2)
    spacing = math.sqrt(size.prod() / max(n, 1))
    if not spacing > 0.0:
        raise InvalidProblem(f"points = {n} points: {NO_SURFACE}")
    # No special position: by fractions of the golden ratio and of the root of 2.
    k = np.arange(1, n + 1)[:, None]
    inside += NUDGE * spacing * (k * (0.6180339887498949, 0.4142135623730951) % 1.0 - 0.5)
    most = periods[along].max(initial=0.0)
    margin = max(MARGIN * spacing, most / 64.0)  # doubled six times at most
    if len(along) == 1:
        inside = np.concatenate((inside, _ends(inside, periods, int(along[0]))))
    while True:
        at, cell = _with_copies(inside, periods, along, margin)
        try:
            found = Delaunay(at).simplices
        except (QhullError, ValueError):
            raise InvalidProblem(f"points = {n} points: {NO_SURFACE}") from None
        # Of the images of a triangle the one is taken whose first cell is no copy.
        a, b, c = found.T
        kept = np.where(cell[a] < cell[b], np.where(cell[a] < cell[c], a, c), np.where(cell[b] < cell[c], b, c)) < n
        for i, j in ((a, b), (b, c), (c, a)):
            kept &= cell[i] < n
            for axis in along:
                kept &= abs(at[i, axis] - at[j, axis]) < 0.5 * periods[axis]
        triangles: Integers = cell[found[kept]]
        overlaps, covers = _joined(triangles, n, len(along))
        if margin >= most or (covers and not overlaps):
            break
        margin *= 2.0
    if overlaps or np.bincount(triangles.ravel(), minlength=n).min(initial=1) == 0:
        raise InvalidProblem(f"points = {n} points: {NO_SURFACE}")
    return triangles


def _ends(inside: Floats, periods: Floats, along: int) -> Floats:
    """Return points beyond both ends of a band, in rows: without them its hull would reach from a point to its image.

    They are a quarter of the period away, and nearer to each other, so no circle reaches beyond them.
    """
    far, row = periods[along] / 4.0, (np.arange(16) + 0.5) / 16.0 * periods[along]
    levels = np.array((inside[:, 1 - along].min() - far, inside[:, 1 - along].max() + far)).repeat(16)
    return np.stack((np.tile(row, 2), levels) if along == 0 else (levels, np.tile(row, 2)), axis=1)


def _with_copies(inside: Floats, periods: Floats, along: Integers, margin: float) -> tuple[Floats, Integers]:
    """Return points with copies of those within the margin from an end of a period, and the cell of each."""
    at, cell = inside, np.arange(len(inside))
    for axis in along:
        shift = np.zeros(2)
        shift[axis] = periods[axis]
        low, high = at[:, axis] < margin, at[:, axis] > periods[axis] - margin
        at = np.concatenate((at, at[low] + shift, at[high] - shift))
        cell = np.concatenate((cell, cell[low], cell[high]))
    return at, cell


def _joined(triangles: Integers, n: int, periods: int) -> tuple[bool, bool]:
    """Return whether triangles overlap, and whether they cover a chart of so many periods.

    Each edge is in two triangles, one on each side, or in one at a boundary; on a torus there is none. V - E + F is
    that of a disc, a band or a torus. Where triangles do not overlap, a part of a torus has at most 3 n edges.
    """
    edges, counts = edges_of(triangles)
    begins, ends = triangles.T.ravel(), triangles[:, [1, 2, 0]].T.ravel()
    twice = (np.diff(np.sort(begins * n + ends)) == 0).any()
    overlaps = bool(twice) or len(edges) > 3 * n
    covers = n - len(edges) + len(triangles) == (1 if periods == 0 else 0)
    return overlaps, covers and (periods < 2 or bool(counts.min(initial=2) == 2))


def _trimmed(surface: Surface, points: Floats, triangles: Integers, longest: float) -> Integers:
    """Take triangles off at edges of the boundary that are too long, the longest first, and where they are flat.

    The third corner must be inside, so that no point is lost and the boundary does not touch itself.
    """
    third = {
        (i, j): (k, t)
        for t, corners in enumerate(triangles.tolist())
        for i, j, k in (corners, corners[1:] + corners[:1], corners[2:] + corners[:2])
    }
    sides = distances(surface, points, triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)).reshape(-1, 3)
    length = dict(zip(third, sides.ravel().tolist(), strict=True))
    half = sides.sum(axis=1, keepdims=True) / 2.0
    area = np.sqrt(np.maximum(half[:, 0] * (half - sides).prod(axis=1), 0.0))
    flat = 2.0 * area <= FLATTEST * sides.max(axis=1) ** 2
    heap = [(-length[edge], edge) for edge in third if edge[::-1] not in third]
    outer, gone = {i for _, edge in heap for i in edge}, np.zeros(len(triangles), np.bool_)
    heapq.heapify(heap)
    while heap:
        negative, (i, j) = heapq.heappop(heap)
        k, t = third[i, j]
        if k not in outer and (-negative > longest or flat[t]):
            outer.add(k)
            gone[t] = True
            # Of the triangles behind its other sides.
            for edge in ((k, j), (i, k)):
                heapq.heappush(heap, (-length[edge], edge))
    kept: Integers = triangles[~gone]
    return kept
