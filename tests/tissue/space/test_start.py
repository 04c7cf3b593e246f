"""The network at the start: invariants on every surface, the property of Delaunay, lattices, and what is refused."""

import math

import numpy as np
import pytest

from dincl import InvalidProblem
from tests.tissue.space.invariants import chart_of, check, edges_of, euler, nearest, triangles_of
from tests.tissue.space.tissues import EULER, KINDS, spread_points
from tissue.model.lattice import flat_lattice, rows_of
from tissue.network.halfedges import begins_edge
from tissue.network.start import triangulated
from tissue.state import surface as s
from tissue.state.network import grown, no_network

every = pytest.mark.parametrize("name", KINDS)


@every
def test_it_is_a_network(name, rng):
    points = spread_points(name, 60, rng)
    network = triangulated(KINDS[name], points, np.copy, capacity=65)
    check(KINDS[name], network, points)
    assert euler(network) == EULER[name]
    assert network.capacity == 65
    begin, end = network.corner, network.corner[network.twin]
    for h in range(0, 3 * network.triangles[0], 7):
        if min(begin[h], end[h]) >= 0:
            d = s.differences(KINDS[name], *(points[begin[h]] - points[end[h]]))
            assert network.rest[h] == pytest.approx(math.hypot(*d))


@every
def test_each_edge_begins_once(name, rng):
    network = triangulated(KINDS[name], spread_points(name, 40, rng), np.copy)
    begun = [h for h in range(3 * network.triangles[0]) if begins_edge(network, h)]
    pairs = [sorted((network.corner[h], network.corner[network.twin[h]])) for h in begun]
    assert sorted(pairs) == sorted(edges_of(network).tolist())
    assert not set(begun) & set(network.twin[begun].tolist())


@pytest.mark.parametrize("name", [name for name in KINDS if "sphere" not in name and "band" not in name])
def test_no_point_is_in_the_circle_of_a_triangle(name, rng):
    surface, points = KINDS[name], spread_points(name, 60, rng)
    chart = chart_of(surface, points)
    triangles = triangles_of(triangulated(surface, points, np.copy))
    inside = 0
    for i, j, k in triangles[(triangles >= 0).all(axis=1)]:
        b, c = nearest(surface, chart[[j, k]] - chart[i])
        centre = np.linalg.solve(2 * np.array((b, c)), np.array((b @ b, c @ c)))
        distances = np.linalg.norm(nearest(surface, chart - chart[i] - centre), axis=1)
        inside += (distances < np.linalg.norm(centre) - 1e-9).any()
    assert inside == 0


@every
def test_a_sphere_has_its_hull_and_others_all_their_area(name, rng):
    surface, points = KINDS[name], spread_points(name, 60, rng)
    triangles = triangles_of(triangulated(surface, points, np.copy))
    cells = triangles[(triangles >= 0).all(axis=1)]
    a, b, c = (chart_of(surface, points)[cells[:, k]] for k in range(3))
    if surface.bends == s.SPHERE:
        heights = np.einsum("ij,ij->i", np.cross(b - a, c - a), a)
        above = np.einsum("ij,kj->ik", np.cross(b - a, c - a), chart_of(surface, points)).max(axis=1)
        np.testing.assert_allclose(above, heights, rtol=1e-9)
    elif EULER[name] == 0:
        e, f = nearest(surface, b - a), nearest(surface, c - a)
        whole = (e[:, 0] * f[:, 1] - e[:, 1] * f[:, 0]).sum() / 2
        first = surface.period_x if surface.bends == s.PLANE else 2 * np.pi * surface.radius
        assert whole == pytest.approx(first * surface.period_z)


@pytest.mark.parametrize("name", [name for name in KINDS if "band" in name])
def test_opposite_angles_in_a_band_are_at_most_pi(name, rng):
    surface, points = KINDS[name], spread_points(name, 60, rng)
    network, chart = triangulated(surface, points, np.copy), chart_of(surface, points)
    h = np.arange(3 * network.triangles[0])
    left = network.corner[h - h % 3 + (h + 2) % 3]
    ends = np.column_stack((network.corner[h], network.corner[network.twin[h]]))
    inside = (np.column_stack((ends, left, left[network.twin[h]])) >= 0).all(axis=1)
    e, f = (nearest(surface, chart[ends[inside, k]] - chart[left[inside]]) for k in (0, 1))
    angle = np.zeros(len(h))
    angle[inside] = np.arctan2(e[:, 0] * f[:, 1] - e[:, 1] * f[:, 0], (e * f).sum(axis=1))
    assert inside.sum() > 100
    assert (angle + angle[network.twin[h]])[inside].max() <= np.pi + 1e-9


def lattice(nx, nz):
    return np.array([(i + 0.5, 0.0, k + 0.5) for k in range(nz) for i in range(nx)])


@pytest.mark.parametrize("periods", [(6.0, 5.0), (6.0, math.inf), (math.inf, 5.0), (math.inf, math.inf)])
def test_a_square_lattice_has_no_triangle_without_area(periods):
    points, surface = lattice(6, 5), s.plane(period_x=periods[0], period_z=periods[1])
    network = triangulated(surface, points, np.copy)
    check(surface, network, points)
    lengths = np.unique(np.round(network.rest[: 3 * network.triangles[0]], 9))
    np.testing.assert_allclose(lengths[lengths > 0], (1.0, math.sqrt(2)))


@pytest.mark.slow_with("1302", "1764")
@pytest.mark.parametrize("cells", [160, 430, 1302, 1764])
def test_nudges_of_a_straight_boundary_leave_no_triangle_without_area(cells):
    """Flat triangles lie one upon another there: in these sheets some have all vertices on it."""
    sheet = flat_lattice(cells, rows_of(cells, 0), 1.0, periodic=False)
    network = triangulated(sheet.surface, sheet.basal.T, np.copy)
    check(sheet.surface, network, sheet.basal.T, crossings=False)
    lengths = np.unique(np.round(network.rest[: 3 * network.triangles[0]], 9))
    np.testing.assert_allclose(lengths[lengths > 0], (1.0, math.sqrt(3)))


def test_a_single_row_is_a_band():
    # As in two dimensions: each cell has one neighbour on each side.
    points, surface = lattice(7, 1), s.plane(period_x=7.0)
    network = triangulated(surface, points, np.copy)
    check(surface, network, points)
    assert sorted(edges_of(network).tolist()) == [[0, 1], [0, 6], [1, 2], [2, 3], [3, 4], [4, 5], [5, 6]]


def test_a_larger_capacity_changes_nothing_else(rng):
    points, surface = spread_points("band along x", 40, rng), KINDS["band along x"]
    network = triangulated(surface, points, np.copy)
    larger = grown(network, 100)
    check(surface, larger, points)
    assert edges_of(larger).tolist() == edges_of(network).tolist()
    assert larger.capacity == 100
    with pytest.raises(InvalidProblem, match="capacity = 50: must be at least 100"):
        grown(larger, 50)
    assert no_network(0).capacity == 0


@pytest.mark.parametrize(
    ("surface", "points", "match"),
    [
        (s.plane(), [[0, 0, 0], [1, 0, 0]], "in a line, or fewer than 3"),
        (s.plane(), [[0, 0, 0], [1, 0, 0], [2, 0, 0]], "in a line"),
        (s.plane(), [[0, 0, 0], [1, 0, 1e-7], [2, 0, 0], [3, 0, 1e-7]], "in a line"),
        (s.plane(), [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 0, 1]], "must be apart"),
        (s.plane(period_x=2.0, period_z=2.0), lattice(2, 2), "must be apart, and more than two around each period"),
        (s.plane(period_x=2.0), lattice(2, 1), "more than two around each period"),
        (s.sphere(1.0, inside=False), np.eye(3), "at least 4 around the sphere"),
        (s.sphere(1.0, inside=False), np.vstack((np.eye(3), [[1, 1, 1]])), "must be apart"),
        (s.sphere(1.0, inside=False), np.vstack((np.eye(3), [[0, 0, 0]])), "in the middle of the surface"),
        (s.plane(), [[0, 0, math.nan]], "points = nan"),
        (s.plane(), [[0, 0]], r"shape \(n, 3\)"),
    ],
)
def test_points_without_a_network_are_refused(surface, points, match):
    with pytest.raises(InvalidProblem, match=match):
        triangulated(surface, points, np.copy)


def test_bad_numbers_are_refused(rng):
    points = spread_points("patch", 10, rng)
    with pytest.raises(InvalidProblem, match="capacity = 9"):
        triangulated(s.plane(), points, np.copy, capacity=9)
    with pytest.raises(InvalidProblem, match="rest"):
        triangulated(s.plane(), points, np.negative)
    with pytest.raises(InvalidProblem, match="rest has 2 entries"):
        triangulated(s.plane(), points, lambda lengths: lengths[:2])
