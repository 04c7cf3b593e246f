"""What is true of every network, looked at without the code that makes it so."""

import numpy as np

from tissue.state.network import GHOSTS
from tissue.state.surface import CYLINDER, PLANE, SPHERE


def check(surface, network, points, *, crossings=True):
    """Half-edges, degrees, Euler's characteristic, orientation, and on request that no two edges cross."""
    triangles = check_half_edges(network)
    check_vertices(network, triangles)
    chart = chart_of(surface, points)
    check_chart(surface, network, chart, points)
    check_orientation(surface, network, chart, triangles)
    if crossings:
        check_crossings(surface, chart, edges_of(network))


def triangles_of(network):
    return network.corner[: 3 * network.triangles[0]].reshape(-1, 3)


def edges_of(network):
    """The pairs i < j of cells that are joined, (m, 2), in the order of the half-edges."""
    triangles = triangles_of(network)
    ends = np.column_stack((triangles.ravel(), triangles[:, [1, 2, 0]].ravel()))
    return ends[(ends[:, 0] < ends[:, 1]) & (ends[:, 0] >= 0)]


def check_half_edges(network):
    triangles = triangles_of(network)
    n = triangles.size
    begin, end = triangles.ravel(), triangles[:, [1, 2, 0]].ravel()
    twin, rest = network.twin[:n], network.rest[:n]
    assert ((twin >= 0) & (twin < n)).all()
    assert (twin[twin] == np.arange(n)).all()
    assert (begin[twin] == end).all()
    assert (end[twin] == begin).all()
    assert (rest[twin] == rest).all()
    assert (begin != end).all()
    assert len(np.unique((begin + GHOSTS) * 2**31 + end + GHOSTS)) == n, "two edges with the same ends"
    ghostly = (begin < 0) | (end < 0)
    assert (rest[ghostly] == 0.0).all()
    assert np.isfinite(rest).all()
    assert not ((begin < 0) & (end < 0)).any()
    return triangles


def check_vertices(network, triangles):
    names, degrees = np.unique(triangles, return_counts=True)
    assert (degrees >= 3).all(), "a vertex with fewer than three neighbours"
    members = np.flatnonzero(network.out >= 0)
    assert set(members.tolist()) == set((names % len(network.out)).tolist())
    assert (network.corner[network.out[members]] % len(network.out) == members).all()
    # One turn around each vertex meets all of its half-edges: no two surfaces touch in a point.
    for name, degree in zip(names.tolist(), degrees.tolist(), strict=True):
        h, turns = network.out[name], 0
        while turns == 0 or h != network.out[name]:
            h, turns = network.twin[3 * (h // 3) + (h - 1) % 3], turns + 1
        assert turns == degree
    ghosts = int((names < 0).sum())
    return ghosts, len(names) - len(triangles) // 2


def euler(network):
    """The characteristic of the closed surface, with ghosts."""
    return check_vertices(network, triangles_of(network))[1]


def chart_of(surface, points):
    """The chart again, (n, 2) or (n, 3)."""
    x, y, z = points.T
    if surface.bends == PLANE:
        return np.column_stack((z, x))
    if surface.bends == CYLINDER:
        return np.column_stack((surface.side * surface.radius * np.arctan2(y, x), z))
    return surface.side * points / np.linalg.norm(points, axis=1, keepdims=True)


def periods(surface):
    if surface.bends == PLANE:
        return np.array((surface.period_z, surface.period_x))
    return np.array((2 * np.pi * surface.radius, surface.period_z))


def nearest(surface, d):
    """Differences to the nearest image."""
    finite = np.where(np.isfinite(periods(surface)), periods(surface), 1.0)
    return d - np.where(np.isfinite(periods(surface)), finite * np.round(d / finite), 0.0)


def check_chart(surface, network, chart, points):
    """The network is where the points are."""
    members = np.flatnonzero(network.out[:-GHOSTS] >= 0)
    kept = np.column_stack((network.u, network.v, network.w))[members]
    np.testing.assert_allclose(kept[:, : chart.shape[1]], chart[members], rtol=0, atol=1e-12)


def check_orientation(surface, network, chart, triangles):
    inside = triangles[(triangles >= 0).all(axis=1)]
    a, b, c = (chart[inside[:, k]] for k in range(3))
    if surface.bends == SPHERE:
        assert (np.einsum("ij,ij->i", a, np.cross(b - a, c - a)) > 0).all()
        return
    sides = [nearest(surface, q - p) for p, q in ((a, b), (b, c), (c, a))]
    assert np.abs(sum(sides)).max(initial=0.0) < 1e-9, "a triangle goes around a period"
    # The areas as the network sees them may be of either sign when they are as small as rounding.
    area = sides[0][:, 0] * sides[1][:, 1] - sides[0][:, 1] * sides[1][:, 0]
    assert (area > -1e-13 * (1 + np.nanmax(np.abs(chart))) ** 2).all()
    check_boundary(surface, network, chart, triangles)


def check_boundary(surface, network, chart, triangles):
    """A boundary is seen from the middle of a patch, or from the open end of a band."""
    bands = network.out[-2] >= 0
    for ghost in (-1, -2):
        rows = triangles[(triangles == ghost).any(axis=1)]
        if not len(rows):
            continue
        place = (rows == ghost).argmax(axis=1)
        p, q = (chart[rows[np.arange(len(rows)), (place + k) % 3]] for k in (1, 2))
        if bands:
            end = np.array((network.u[ghost], network.v[ghost]))
            along = nearest(surface, q - p)
            assert (along[:, 0] * end[1] - along[:, 1] * end[0] > 0).all()
        else:
            middle = np.array((network.u[ghost], network.v[ghost]))
            e, f = nearest(surface, p - middle), nearest(surface, q - middle)
            assert (e[:, 0] * f[:, 1] - e[:, 1] * f[:, 0] < 0).all()


def check_crossings(surface, chart, edges, slack=1e-12):
    """No two edges without a common end cross, whatever their orientation: all pairs are looked at."""
    k, m = np.triu_indices(len(edges), 1)
    apart = (edges[k][:, :, None] != edges[m][:, None, :]).all(axis=(1, 2))
    k, m = edges[k[apart]], edges[m[apart]]
    crossing = cross_on_sphere if surface.bends == SPHERE else cross_on_plane
    bad = crossing(surface, chart, k, m, slack)
    assert not bad.any(), f"edges {k[bad][0]} and {m[bad][0]} cross"


def cross_on_plane(surface, chart, first, second, slack):
    """Whether edges cross, each straight to its nearest image, the second one in the image nearest to the first."""
    a = chart[first[:, 0]]
    b = a + nearest(surface, chart[first[:, 1]] - a)
    c = a + nearest(surface, chart[second[:, 0]] - a)
    d = c + nearest(surface, chart[second[:, 1]] - chart[second[:, 0]])

    def turn(p, q, r):
        return (q - p)[:, 0] * (r - p)[:, 1] - (q - p)[:, 1] * (r - p)[:, 0]

    return (turn(a, b, c) * turn(a, b, d) < -slack) & (turn(c, d, a) * turn(c, d, b) < -slack)


def cross_on_sphere(surface, chart, first, second, slack):
    """Whether arcs of great circles cross."""
    a, b, c, d = chart[first[:, 0]], chart[first[:, 1]], chart[second[:, 0]], chart[second[:, 1]]
    ab, cd = np.cross(a, b), np.cross(c, d)

    def dot(p, q):
        return np.einsum("ij,ij->i", p, q)

    apart = (dot(ab, c) * dot(ab, d) < -slack) & (dot(cd, a) * dot(cd, b) < -slack)
    # The two great circles meet in two points; both arcs must have the same one.
    meet = np.cross(ab, cd)
    return apart & (dot(meet, a + b) * dot(meet, c + d) > 0)
