"""Positions on the apical-basal scale (section 3.3.1 of chapter 4), of one nucleus after the other."""

from __future__ import annotations

import math

from dincl.compiled import inner
from tissue.kernels.curve import height_of
from tissue.state.cells import Cells
from tissue.state.running import APICAL, CELLS, IN_SPACE, ON_LINE, Kind, TissueState
from tissue.state.space import SPATIAL, TRIANGLES
from tissue.state.surface import Surface, differences, height

Point = tuple[float, float, float]


@inner
def position_in_space(state: TissueState, i: int) -> float:
    """y_AB(X_i) = h(X_i) / h(A^ref), A^ref the point of the apical surface nearest to X_i (section 3.3.1 of chapter 4).

    The apical surface is made of the triangles of the network, as it is between two renewals, and h is the height above
    the basal surface. Looks at all triangles: for one cell; ``tissue.model.measures`` has all.
    """
    cells, network, surface = state.cells, state.space.apical, state.space.surface
    at = cells.x[i], cells.y[i], cells.z[i]
    nearest, reference = math.inf, (math.nan, math.nan, math.nan)
    for t in range(network.sizes[TRIANGLES]):
        a = _beside(surface, cells, at, network.triangles[t, 0])
        b, c = (
            _beside(surface, cells, a, network.triangles[t, 1]),
            _beside(surface, cells, a, network.triangles[t, 2]),
        )
        square, point = nearest_on_triangle(at, a, b, c)
        if square < nearest:
            nearest, reference = square, point
    above = height(surface, reference[0], reference[1], reference[2])
    return height(surface, at[0], at[1], at[2]) / above


@inner
def _beside(surface: Surface, cells: Cells, at: Point, j: int) -> Point:
    """Return the image of the apical point of cell j that is nearest to a point."""
    away = differences(surface, cells.ax[j] - at[0], cells.ay[j] - at[1], cells.az[j] - at[2])
    return at[0] + away[0], at[1] + away[1], at[2] + away[2]


@inner
def nearest_on_triangle(at: Point, a: Point, b: Point, c: Point) -> tuple[float, Point]:
    """Return the squared distance from a point to a triangle, and the nearest point of the triangle."""
    p = nearest_to_origin(minus(a, at), minus(b, at), minus(c, at))
    return dot(p, p), (at[0] + p[0], at[1] + p[1], at[2] + p[2])


@inner
def nearest_on_junction(at: Point, a: Point, b: Point) -> tuple[float, Point]:
    """Return the squared distance from a point to the line from a to b, and the nearest point of the line."""
    along, away = minus(b, a), minus(at, a)
    square, part = dot(along, along), 0.0
    if square > 0.0:
        part = min(max(dot(away, along) / square, 0.0), 1.0)
    away = away[0] - part * along[0], away[1] - part * along[1], away[2] - part * along[2]
    return dot(away, away), _along(a, along, part)


@inner
def nearest_to_origin(a: Point, b: Point, c: Point) -> Point:
    """Return the point of the triangle a, b, c that is nearest to the origin.

    It is the foot of the plane where that lies inside, else the nearest point of the three sides.
    """
    u, v = minus(b, a), minus(c, a)
    uu, uv, vv, au, av = dot(u, u), dot(u, v), dot(v, v), -dot(a, u), -dot(a, v)
    area = uu * vv - uv * uv
    p, q = vv * au - uv * av, uu * av - uv * au
    if area > 0.0 and p >= 0.0 and q >= 0.0 and p + q <= area:
        return _along(_along(a, u, p / area), v, q / area)
    best, found = math.inf, a
    for side in ((a, b), (b, c), (c, a)):
        square, point = nearest_on_junction((0.0, 0.0, 0.0), side[0], side[1])
        if square < best:
            best, found = square, point
    return found


@inner
def minus(a: Point, b: Point) -> Point:
    """Compute a - b."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@inner
def _along(a: Point, u: Point, part: float) -> Point:
    return a[0] + part * u[0], a[1] + part * u[1], a[2] + part * u[2]


@inner
def dot(a: Point, b: Point) -> float:
    """Compute a . b."""
    total: float = a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    return total


@inner
def ab_position(state: TissueState, i: int, kind: Kind) -> float:
    """Compute y_AB(X_i)."""
    if len(kind) == IN_SPACE and state.space.dimension == SPATIAL:
        return position_in_space(state, i)
    return position_in_slice(state, i, kind)


@inner
def position_in_slice(state: TissueState, i: int, kind: Kind) -> float:
    """y_AB(X_i) = h(X_i) / h(A^ref), A^ref the point of the apical path nearest to X_i, of several the first one.

    h is the height above the basal layer, y above a line. Looks at all junctions: for one cell;
    ``tissue.model.measures`` has all.
    """
    cells, layer, size = state.cells, state.layers.apical, state.sizes[APICAL]
    at = cells.x[i], cells.y[i], 0.0
    nearest, reference = math.inf, (cells.ax[layer[0]], cells.ay[layer[0]], 0.0)
    for k in range(size if state.curve.ring > 0.0 else size - 1):
        j, end = layer[k], layer[k + 1 if k + 1 < size else 0]
        square, point = nearest_on_junction(at, (cells.ax[j], cells.ay[j], 0.0), (cells.ax[end], cells.ay[end], 0.0))
        if square < nearest:
            nearest, reference = square, point
    position: float
    if len(kind) == ON_LINE:
        position = at[1] / reference[1]
        return position
    position = height_of(state.curve, at[0], at[1]) / height_of(state.curve, reference[0], reference[1])
    return position


@inner
def crossing_of_ray(x: float, y: float, from_x: float, from_y: float, to_x: float, to_y: float) -> int:
    """Return whether a line crosses the ray from a point to the right: upwards 1, downwards -1, else 0.

    An end on the ray counts as above it, so that of two lines that meet there one crosses it.
    """
    if (from_y <= y) == (to_y <= y):
        return 0
    left = (to_x - from_x) * (y - from_y) - (x - from_x) * (to_y - from_y)
    if from_y <= y:
        return int(left > 0.0)
    return -int(left < 0.0)


@inner
def junctions_cross(a: Point, b: Point, c: Point, d: Point) -> bool:
    """Return whether two lines in the plane cross: the ends of each lie on different sides of the other."""
    one = _hand(a, b, c) * _hand(a, b, d)
    return one < 0.0 and _hand(c, d, a) * _hand(c, d, b) < 0.0


@inner
def _hand(a: Point, b: Point, c: Point) -> float:
    """Compute on which side of the line from a to b the point c is: a number with this sign."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


@inner
def beyond_apical(state: TissueState, around: int) -> bool:
    """Return whether a point is beyond the apical layer of a tube, in its lumen or outside of it.

    ``around``: how often the apical layer goes around the point, counterclockwise. It goes around the lumen once.
    """
    return around > 0 if state.curve.hollow else around >= 0


@inner
def lowest_apical(state: TissueState) -> float:
    """Return the lowest y of the apical layer, above which A^ref lies; no bound where the layer bends."""
    low = math.inf
    if state.curve.bent or state.space.surface.bends:
        return -math.inf
    for k in range(state.sizes[APICAL]):
        low = min(low, state.cells.ay[state.layers.apical[k]])
    return low


@inner
def side_of(state: TissueState, i: int, low: float, kind: Kind) -> int:
    """-1 for y_AB(X_i) < 0, 1 for y_AB(X_i) > 1, else 0 (4.3); ``low`` of ``lowest_apical``, above the basal line.

    In a tube a nucleus is at 1 if it is beyond the apical layer as a whole: the layer encloses a lumen.
    """
    x, y = state.cells.x[i], state.cells.y[i]
    if 0.0 <= y <= low:
        return 0
    if len(kind) != ON_LINE and state.curve.ring > 0.0:
        if beyond_apical(state, winding_around(state, x, y)):
            return 1
        return -int(height_of(state.curve, x, y) < 0.0)
    position = ab_position(state, i, kind)
    return (position > 1.0) - (position < 0.0)


@inner
def winding_around(state: TissueState, x: float, y: float) -> int:
    """Return how often the closed apical layer goes around a point, counterclockwise."""
    cells, layer, size, around = state.cells, state.layers.apical, state.sizes[APICAL], 0
    for k in range(size):
        i, j = layer[k], layer[k + 1 if k + 1 < size else 0]
        around += crossing_of_ray(x, y, cells.ax[i], cells.ay[i], cells.ax[j], cells.ay[j])
    return around


@inner
def watch_sides(state: TissueState, t: float, kind: Kind) -> None:
    """Keep since when each EMT cell is outside of the tissue."""
    cells, emt = state.cells, state.emt
    if len(emt.side) == 0:
        return
    low = lowest_apical(state)
    for i in range(state.sizes[CELLS]):
        k = cells.emt[i]
        if k >= 0:
            side = side_of(state, i, low, kind)
            if side != emt.side[k]:
                emt.side[k], emt.since[k] = side, t
