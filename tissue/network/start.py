"""The network at the start: Delaunay's triangulation of the points, laid on the surface; that of a band."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial import ConvexHull, Delaunay, QhullError

from dincl import checks
from dincl.errors import InvalidProblem
from tissue.network.chart import between, period_u, period_v, turn
from tissue.network.exchange import make_delaunay, measure_lengths, measure_turns, place
from tissue.state.cells import Floats, Integers
from tissue.state.network import GHOSTS, Network, no_network
from tissue.state.surface import CYLINDER, SPHERE, Surface

# A new edge of a boundary goes at most this part of the period along the band, so that its triangle goes not around.
LONGEST = 0.25
# A notch of a band, or a triangle at the boundary of a patch, that is flatter than this, its height over its longest
# side, is none: a straight boundary has none.
FLATTEST = 1e-6


def band_triangles(surface: Surface, network: Network, n: int, along: int, period: float) -> Integers:
    """Return all triangles of a band of n vertices, which are on the chart already, and of its ghosts -1 and -2.

    The vertices in the order along the period are a closed line. On both sides its notches are filled, as in Graham's
    scan for a convex hull; what is left of the two sides are boundaries of which each point sees its ghost.
    """
    position = (network.u if along == 0 else network.v)[:n]
    ring = np.argsort(position - period * np.floor(position / period), kind="stable")
    # So that the ghost -2 is on the right.
    order = (ring if along == 0 else ring[::-1]).tolist()
    limit = LONGEST * period
    right, first = _filled(surface, network, order, along, limit)
    left, second = _filled(surface, network, order[::-1], along, limit)
    ends = [(b, a, -2) for a, b in _pairs(right)] + [(b, a, -1) for a, b in _pairs(left)]
    return np.array(first + second + ends, np.int64).reshape(-1, 3)


def _pairs(line: list[int]) -> list[tuple[int, int]]:
    """Return the edges of a closed line."""
    return list(zip(line, line[1:] + line[:1], strict=True))


def _filled(
    surface: Surface, network: Network, line: list[int], along: int, limit: float
) -> tuple[list[int], list[tuple[int, int, int]]]:
    """Return what is left of a closed line when all notches on its right are filled, and the triangles that
    fill them.
    """
    line, triangles, place, since = list(line), [], 0, 0
    while since < len(line) and len(line) > 3:
        before, tip, after = (line[(place + k) % len(line)] for k in range(3))
        width = abs(between(surface, network, before, after)[along])
        if width <= limit and turn(surface, network, before, after, tip) > FLATTEST * width**2:
            triangles.append((before, after, tip))
            line.remove(tip)
            place, since = max(0, place - 2), 0
        else:
            place, since = (place + 1) % len(line), since + 1
    return line, triangles


# Points on a lattice have many triangulations of Delaunay. Each is moved by this part of the mean distance, always the
# same way, so that periodic images of four points get the same diagonal.
NUDGE = 1e-7
NO_SURFACE = "points = points in a line, or fewer than 3: must span a surface"

Triangles = Integers  # (m, 3)


def triangulated(
    surface: Surface, points: ArrayLike, rest: Callable[[Floats], Floats], capacity: int | None = None
) -> Network:
    """Return the network of points (n, 3).

    A plane with two periods and a cylinder with one have no boundary, nor has a sphere, which must have its middle
    inside of the points. A plane with one period, and a cylinder without that is surrounded by points, are bands with
    two boundaries, as narrow as a single row. All else is a patch, the convex hull on the chart; points on a cylinder
    that leave half of it empty are one. ``relax`` takes the long edges off its boundary.

    Parameters
    ----------
    rest
        Gives the rest lengths (m,) of junctions for their distances in space (m,): both [R_soft].
    capacity
        Room for cells; None: for those that there are.

    Raises
    ------
    InvalidProblem
        For points that coincide, are too few or in a line; for periods that are too short: two points must have one
        edge at most, and triangles must not go around.
    """
    at = checks.shaped("points", points, (None, 3))
    room = len(at) if capacity is None else checks.integer("capacity", capacity, least=len(at))
    network, (x, y, z) = no_network(room), np.array(at.T, order="C")
    place(surface, network, x, y, z)
    chart = np.stack((network.u, network.v, network.w))[:, : len(at)]
    if not np.isfinite(chart).all():
        raise InvalidProblem("points = a point in the middle of the surface: must be apart from it, to have a place")
    _connect(network, _triangles(surface, network, chart), len(at), flat=surface.bends != SPHERE)
    if network.out[-2] >= 0:
        make_delaunay(surface, network)
        place(surface, network, x, y, z)
    _check_turns(surface, network)
    distances = np.empty(3 * int(network.triangles[0]))
    measure_lengths(surface, network, x, y, z, distances)
    _set_rest_lengths(network, distances, rest)
    return network


def _triangles(surface: Surface, network: Network, chart: Floats) -> Triangles:
    """Return all triangles, with ghosts, whose places are set."""
    if surface.bends == SPHERE:
        return _hull(chart)
    periods = (period_u(surface), period_v(surface))
    if surface.bends == CYLINDER and math.isinf(periods[1]) and _is_arc(surface, chart[0]):
        return _patch(network, chart, surface)
    around = np.isfinite(periods)
    if around.all():
        return _torus(chart[:2], periods)
    if not around.any():
        return _patch(network, chart, surface)
    along = int(np.argmax(around))
    for ghost, sign in ((-1, 1.0), (-2, -1.0)):
        network.u[ghost], network.v[ghost], network.w[ghost] = (0.0, sign, 0.0) if along == 0 else (sign, 0.0, 0.0)
    n, width = chart.shape[1], float(np.ptp(chart[1 - along]))
    network.u[:n], network.v[:n] = _nudged(chart[:2], periods[along] * max(width, periods[along] / n))
    return band_triangles(surface, network, n, along, periods[along])


def _hull(chart: Floats) -> Triangles:
    """Return the convex hull of points on a sphere."""
    try:
        found = ConvexHull(chart.T).simplices.astype(np.int64)
    except (QhullError, ValueError):
        raise InvalidProblem(f"points = {chart.shape[1]} points: must be at least 4 around the sphere") from None
    a, b, c = (chart[:, found[:, k]] for k in range(3))
    left = np.einsum("ij,ij->j", a, np.cross(b, c, axis=0)) > 0.0
    turned: Triangles = np.where(left[:, None], found, found[:, ::-1])
    return turned


def _is_arc(surface: Surface, u: Floats) -> bool:
    """Return whether points leave half of a cylinder empty."""
    period = period_u(surface)
    ahead = np.sort(u)
    return bool(np.diff(np.append(ahead, ahead[0] + period)).max() >= 0.5 * period)


def _nudged(flat: Floats, area: float) -> Floats:
    """Return points (2, n) in no special position, by fractions of the golden ratio and of the root of 2."""
    k = np.arange(1, flat.shape[1] + 1)
    steps = np.stack((k * 0.6180339887498949 % 1.0, k * 0.4142135623730951 % 1.0)) - 0.5
    return flat + NUDGE * math.sqrt(area / flat.shape[1]) * steps


def _delaunay(flat: Floats) -> Triangles:
    """Triangles of points (2, n), counterclockwise."""
    try:
        found = Delaunay(flat.T).simplices.astype(np.int64)
    except (QhullError, ValueError):
        raise InvalidProblem(NO_SURFACE) from None
    a, b, c = (flat[:, found[:, k]] for k in range(3))
    left = _turn(b - a, c - a) > 0.0
    turned: Triangles = np.where(left[:, None], found, found[:, ::-1])
    return turned


def _torus(flat: Floats, periods: tuple[float, float]) -> Triangles:
    """Choose one image of each triangle in three times three periods: its smallest index is in the middle period."""
    n, period = flat.shape[1], np.array(periods)[:, None]
    inside = flat - period * np.floor(flat / period)
    shifts = np.array([(0, 0)] + [(a, b) for a in (-1, 0, 1) for b in (-1, 0, 1) if a or b])
    nudged = _nudged(inside, periods[0] * periods[1])
    found = _delaunay(np.hstack([nudged + period * shift[:, None] for shift in shifts]))
    index = found % n
    first = np.take_along_axis(found, index.argmin(axis=1)[:, None], axis=1)[:, 0]
    chosen: Triangles = index[first < n]
    return chosen


def _patch(network: Network, chart: Floats, surface: Surface) -> Triangles:
    """Return the convex hull without flat triangles, and a ghost behind its boundary."""
    flat = chart[:2].copy()
    if surface.bends == CYLINDER:
        sine, cosine = (float(np.mean(f(flat[0] / surface.radius))) for f in (np.sin, np.cos))
        middle = math.atan2(sine, cosine) * surface.radius
        period = period_u(surface)
        flat[0] -= period * np.round((flat[0] - middle) / period)
    network.u[-1], network.v[-1], network.w[-1] = flat[0].mean(), flat[1].mean(), -1.0
    if surface.bends == CYLINDER:
        network.u[-1] = middle
    found = _delaunay(_nudged(flat, float(np.prod(np.ptp(flat, axis=1)))))
    return _closed(_peeled(flat, found), -1)


def _peeled(flat: Floats, triangles: Triangles) -> Triangles:
    """Take away flat triangles at the boundary, as long as there are some.

    Points of a straight boundary are nudged out of line: flat triangles lie on it, one upon another. No point is lost
    with them: one that only a flat triangle has would be inside of the circle around the triangle below.
    """
    while len(triangles):
        edges, others = _boundary(triangles)
        corners = np.column_stack((edges, others))
        a, b, c = (flat[:, corners[:, k]] for k in range(3))
        sides = np.stack((b - a, c - b, a - c))
        flat_ones = _turn(b - a, c - a) <= FLATTEST * (sides**2).sum(axis=1).max(axis=0)
        if not flat_ones.any():
            return triangles
        gone = {tuple(sorted(corner)) for corner in corners[flat_ones].tolist()}
        triangles = np.array([t for t in triangles.tolist() if tuple(sorted(t)) not in gone])
    raise InvalidProblem(NO_SURFACE)


def _turn(v: Floats, w: Floats) -> Floats:
    turn: Floats = v[0] * w[1] - v[1] * w[0]
    return turn


def _boundary(triangles: Triangles) -> tuple[Integers, Integers]:
    """Edges (m, 2) that have a triangle on their left only, and the third vertex of that."""
    edges = np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)])
    others = np.concatenate([triangles[:, (k + 2) % 3] for k in range(3)])
    there = set(map(tuple, edges.tolist()))
    alone = np.array([(j, i) not in there for i, j in edges.tolist()])
    return edges[alone], others[alone]


def _closed(triangles: Triangles, ghost: int) -> Triangles:
    """Close a patch: add a triangle from each edge of the boundary to a ghost."""
    edges, _ = _boundary(triangles)
    return np.vstack((triangles, np.column_stack((edges[:, ::-1], np.full(len(edges), ghost)))))


def _connect(network: Network, triangles: Triangles, n: int, *, flat: bool) -> None:
    """Write triangles as half-edges; raises InvalidProblem if they are no closed surface of all points."""
    used = 3 * len(triangles)
    corner = triangles.ravel()
    place = {
        (i, j): h
        for h, (i, j) in enumerate(zip(corner.tolist(), triangles[:, [1, 2, 0]].ravel().tolist(), strict=True))
    }
    twins = [place.get((j, i), -1) for i, j in place]
    vertices = n + len(set(corner.tolist()) & set(range(-GHOSTS, 0)))
    euler = 0 if vertices == n and flat else 2
    closed = len(place) == used and min(twins) >= 0 and len(np.unique(corner)) == vertices
    if not closed or vertices - len(triangles) // 2 != euler:
        raise InvalidProblem(
            f"points = {n} points: must be apart, and more than two around each period, around a sphere, or wide"
        )
    network.corner[:used], network.twin[:used], network.triangles[0] = corner, twins, len(triangles)
    network.out[corner] = np.arange(used)


def _check_turns(surface: Surface, network: Network) -> None:
    """Raise InvalidProblem unless all triangles turn left."""
    turns = np.empty(int(network.triangles[0]))
    measure_turns(surface, network, turns)
    if not (turns > 0.0).all():
        first = 3 * int(np.argmin(turns > 0.0))
        wrong = network.corner[first : first + 3].tolist()
        raise InvalidProblem(
            f"points = a triangle of the points {wrong} without area, or around a period: must be apart, in no line"
        )


def _set_rest_lengths(network: Network, distances: Floats, rest: Callable[[Floats], Floats]) -> None:
    """Rest lengths of all junctions by the distances along half-edges; both twins have the same."""
    h = np.arange(len(distances))
    g = network.twin[h]
    junctions = h[(h < g) & (np.minimum(network.corner[h], network.corner[g]) >= 0)]
    lengths = checks.lengths("rest", rest(distances[junctions]), positive=False)
    network.rest[junctions] = network.rest[g[junctions]] = checks.spread("rest", lengths, len(junctions), "junctions")
