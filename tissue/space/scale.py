"""Positions on the apical-basal scale in space, against the triangles of the apical network."""

from __future__ import annotations

import math

from dincl.compiled import inner
from tissue.kernels.store import Store
from tissue.space.surface import Surface, differences, height
from tissue.state.cells import Cells

Point = tuple[float, float, float]


@inner
def position_in_space(store: Store, i: int) -> float:
    """y_AB(X_i) = h(X_i) / h(A^ref), A^ref the point of the apical surface nearest to X_i (section 3.3.1 of chapter 4).

    The apical surface is made of the triangles of the network; where there is none, in a row of cells, of its edges. h
    is the height above the basal surface.
    """
    cells, network, surface = store.cells, store.space.apical, store.space.surface
    x, y, z = cells.x[i], cells.y[i], cells.z[i]
    nearest, reference = math.inf, (math.nan, math.nan, math.nan)
    for t in range(network.triangles[0]):
        first, second, third = network.corner[3 * t], network.corner[3 * t + 1], network.corner[3 * t + 2]
        if first < 0 or second < 0 or third < 0:
            continue
        a = _from(surface, cells, (x, y, z), first)
        b = _from(surface, cells, (x, y, z), second)
        c = _from(surface, cells, (x, y, z), third)
        p = nearest_to_origin(a, b, c)
        square = _dot(p, p)
        if square < nearest:
            nearest, reference = square, p
    if nearest == math.inf:
        reference = _nearest_of_row(store, (x, y, z))
    above = height(surface, x + reference[0], y + reference[1], z + reference[2])
    return height(surface, x, y, z) / above


@inner
def _nearest_of_row(store: Store, at: Point) -> Point:
    """The arrow to the nearest point of the edges of the apical network."""
    cells, network, surface = store.cells, store.space.apical, store.space.surface
    nearest, reference = math.inf, (math.nan, math.nan, math.nan)
    for h in range(3 * network.triangles[0]):
        first, second = network.corner[h], network.corner[network.twin[h]]
        if 0 <= first < second:
            p = _nearest_on(_from(surface, cells, at, first), _from(surface, cells, at, second))
            square = _dot(p, p)
            if square < nearest:
                nearest, reference = square, p
    return reference


@inner
def _from(surface: Surface, cells: Cells, at: Point, j: int) -> Point:
    """The arrow from a point to the apical point of cell j, its nearest image."""
    return differences(surface, cells.ax[j] - at[0], cells.ay[j] - at[1], cells.az[j] - at[2])


@inner
def nearest_to_origin(a: Point, b: Point, c: Point) -> Point:
    """The point of the triangle a, b, c that is nearest to the origin.

    It is the foot of the plane where that lies inside, else the nearest point of the three sides.
    """
    u, v = _minus(b, a), _minus(c, a)
    uu, uv, vv, au, av = _dot(u, u), _dot(u, v), _dot(v, v), -_dot(a, u), -_dot(a, v)
    area = uu * vv - uv * uv
    p, q = vv * au - uv * av, uu * av - uv * au
    if area > 0.0 and p >= 0.0 and q >= 0.0 and p + q <= area:
        return _along(_along(a, u, p / area), v, q / area)
    best, found = math.inf, a
    for side in ((a, b), (b, c), (c, a)):
        point = _nearest_on(side[0], side[1])
        square = _dot(point, point)
        if square < best:
            best, found = square, point
    return found


@inner
def _nearest_on(a: Point, b: Point) -> Point:
    """The point of the line from a to b that is nearest to the origin."""
    u = _minus(b, a)
    square = _dot(u, u)
    part = min(max(-_dot(a, u) / square, 0.0), 1.0) if square > 0.0 else 0.0
    return _along(a, u, part)


@inner
def _minus(a: Point, b: Point) -> Point:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@inner
def _along(a: Point, u: Point, part: float) -> Point:
    return a[0] + part * u[0], a[1] + part * u[1], a[2] + part * u[2]


@inner
def _dot(a: Point, b: Point) -> float:
    total: float = a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    return total
