"""Positions on the apical-basal scale (section 3.3.1 of chapter 4), of one nucleus after the other."""

from __future__ import annotations

import math

from dincl.compiled import inner
from tissue.kernels import kernel
from tissue.kernels.curve import height_of
from tissue.kernels.rules import call_position
from tissue.state.cells import Cells, Floats
from tissue.state.running import APICAL, CELLS, TissueState
from tissue.state.surface import Surface, differences, height

Point = tuple[float, float, float]


@inner
def position_in_space(state: TissueState, i: int) -> float:
    """y_AB(X_i) = h(X_i) / h(A^ref), A^ref the point of the apical surface nearest to X_i (section 3.3.1 of chapter 4).

    The apical surface is made of the triangles of the network; where there is none, in a row of cells, of its edges. h
    is the height above the basal surface.
    """
    cells, network, surface = state.cells, state.space.apical, state.space.surface
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
        reference = _nearest_of_row(state, (x, y, z))
    above = height(surface, x + reference[0], y + reference[1], z + reference[2])
    return height(surface, x, y, z) / above


@inner
def _nearest_of_row(state: TissueState, at: Point) -> Point:
    """Return the arrow to the nearest point of the edges of the apical network."""
    cells, network, surface = state.cells, state.space.apical, state.space.surface
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
    """Return the arrow from a point to the apical point of cell j, its nearest image."""
    return differences(surface, cells.ax[j] - at[0], cells.ay[j] - at[1], cells.az[j] - at[2])


@inner
def nearest_to_origin(a: Point, b: Point, c: Point) -> Point:
    """Return the point of the triangle a, b, c that is nearest to the origin.

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
    """Return the point of the line from a to b that is nearest to the origin."""
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


@inner
def ab_position(state: TissueState, i: int) -> float:
    """Compute y_AB(X_i), by the rule of the tissue."""
    found: float = call_position(state.space.rules.position, state, i)
    return found


@inner
def position_in_slice(state: TissueState, i: int) -> float:
    """y_AB(X_i) = h(X_i) / h(A^ref), A^ref the point of the apical path nearest to X_i; as ``ab_positions``.

    h is the height above the basal layer, y above a line.
    """
    cells, layer = state.cells, state.layers.apical
    x, y = cells.x[i], cells.y[i]
    nearest, reference, size = math.inf, (cells.ax[layer[0]], cells.ay[layer[0]]), state.sizes[APICAL]
    for k in range(size if state.curve.ring > 0.0 else size - 1):
        end = layer[k + 1 if k + 1 < size else 0]
        from_x, from_y = cells.ax[layer[k]], cells.ay[layer[k]]
        along_x, along_y = cells.ax[end] - from_x, cells.ay[end] - from_y
        away_x, away_y = x - from_x, y - from_y
        square, part = along_x * along_x + along_y * along_y, 0.0
        if square > 0.0:
            part = min(max((away_x * along_x + away_y * along_y) / square, 0.0), 1.0)
        away_x, away_y = away_x - part * along_x, away_y - part * along_y
        if away_x * away_x + away_y * away_y < nearest:
            nearest = away_x * away_x + away_y * away_y
            reference = from_x + part * along_x, from_y + part * along_y
    position: float = height_of(state.curve, x, y) / height_of(state.curve, reference[0], reference[1])
    return position


@inner
def apical_range(state: TissueState) -> tuple[float, float]:
    """Return the lowest and the highest y of the apical layer, between which A^ref lies; no bounds where the layer
    bends.
    """
    low, high = math.inf, -math.inf
    if state.curve.bent or state.space.surface.bends:
        return -math.inf, math.inf
    for k in range(state.sizes[APICAL]):
        i = state.layers.apical[k]
        low, high = min(low, state.cells.ay[i]), max(high, state.cells.ay[i])
    return low, high


@inner
def side_of(state: TissueState, i: int, low: float) -> int:
    """-1 for y_AB(X_i) < 0, 1 for y_AB(X_i) > 1, else 0 (4.3); ``low`` of ``apical_range``, above the basal line."""
    y = state.cells.y[i]
    if 0.0 <= y <= low:
        return 0
    position = ab_position(state, i)
    return (position > 1.0) - (position < 0.0)


@inner
def watch_sides(state: TissueState, t: float) -> None:
    """Keep since when and where each EMT cell is outside of the tissue."""
    cells, emt = state.cells, state.emt
    if len(emt.side) == 0:
        return
    low, _ = apical_range(state)
    for i in range(state.sizes[CELLS]):
        k = cells.emt[i]
        if k >= 0:
            side = side_of(state, i, low)
            if side != emt.side[k]:
                emt.side[k], emt.since[k], emt.since_x[k] = side, t, cells.x[i]


@kernel
def measure(state: TissueState, positions: Floats, controls: Floats) -> None:
    """y_AB of each EMT cell; of the control cells their number, how many are above 1 and below 0, and the lowest y_AB.

    Most need no look at the apical path: y_AB lies between y / high and y / low.
    """
    cells, n, (low, high) = state.cells, state.sizes[CELLS], apical_range(state)
    controls[0], controls[1], controls[2], controls[3] = 0.0, 0.0, 0.0, math.inf
    for i in range(n):
        k = cells.emt[i]
        if k >= 0:
            positions[k] = ab_position(state, i)
            continue
        controls[0] += 1.0
        if not 0.0 <= cells.y[i] <= low or cells.y[i] < controls[3] * high:
            position = ab_position(state, i)
            controls[1] += position > 1.0
            controls[2] += position < 0.0
            controls[3] = min(controls[3], position)
