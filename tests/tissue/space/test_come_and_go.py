"""A daughter beside her mother, a cell that leaves: as the plain twins, on every surface, with rest lengths."""

import numpy as np
import pytest

from tests.tissue.space.by_address import follow, insert, remove
from tests.tissue.space.invariants import chart_of, check
from tests.tissue.space.tissues import KINDS
from tests.tissue.space.walk import Walk
from tests.twins.tissue.space import network as twin
from tissue.network.start import triangulated
from tissue.state import surface as s
from tissue.state.space import PRESENT, SUM

every = pytest.mark.parametrize("name", KINDS)


def inner_cells(walk):
    """Cells that neither a boundary nor the end of a period is near."""
    chart = chart_of(walk.surface, walk.points[walk.members])
    if walk.surface.bends == s.SPHERE:
        return walk.members
    low, high = chart.min(axis=0), chart.max(axis=0)
    inside = ((chart > low + 0.3 * (high - low)) & (chart < high - 0.3 * (high - low))).all(axis=1)
    return walk.members[inside]


@every
def test_a_cell_leaves_as_in_the_twin(name):
    walk = Walk(name, 60, 5)
    cells = inner_cells(walk)[:6]
    assert len(cells) > 2
    for i in cells:
        before = twin.triangles_of(walk.network)
        chart = chart_of(walk.surface, walk.points)
        edges = remove(walk.surface, walk.network, *walk.columns, i, PRESENT)
        assert edges == len(twin.neighbours_around(before, i)) - 3
        assert twin.triangles_of(walk.network) == twin.remove(walk.surface, chart, walk.points, before, i)
        assert walk.network.out[i] == -1
        walk.check()


def test_a_cell_leaves_a_hole_that_is_not_convex_as_in_the_twin(rng):
    """Its five neighbours are at any distance: the shortest new edge may cut off an ear with another one in it."""
    covered = 0
    for _ in range(300):
        angles, points = np.sort(rng.uniform(0, 2 * np.pi, 5)), np.zeros((14, 3))
        if np.diff(angles, append=angles[0] + 2 * np.pi).max() > 2.5:
            continue
        points[:5], points[5:13] = on_circle(angles, 1.0), on_circle(np.arange(8) * np.pi / 4, 9.0)
        network = triangulated(s.plane(), points, np.copy)
        points[:5] = on_circle(angles, 4.0 ** rng.uniform(-2.0, 1.0, 5))
        chart, before = chart_of(s.plane(), points), twin.triangles_of(network)
        network.u[:14], network.v[:14] = chart.T
        ring = twin.neighbours_around(before, 13)
        assert len(ring) == 5
        covered += any(has_another_in_it(chart[ring], tip) for tip in range(5))
        expected = twin.remove(s.plane(), chart, points, before, 13)
        assert remove(s.plane(), network, *np.array(points.T, order="C"), 13, PRESENT) == 2
        assert twin.triangles_of(network) == expected
    assert covered > 20


def on_circle(angle, radius):
    """Points of the plane, counterclockwise in its chart."""
    return np.column_stack((radius * np.sin(angle), 0 * angle, radius * np.cos(angle)))


def has_another_in_it(ring, tip):
    """Whether the triangle at a corner of a polygon, which turns left, has another corner of it inside."""
    before, at, after = (ring[k % len(ring)] for k in (tip - 1, tip, tip + 1))
    sides = np.column_stack((at - before, after - before))
    weights = np.linalg.solve(sides, (ring - before).T)
    inside = (weights > 1e-9).all(axis=0) & (weights.sum(axis=0) < 1 - 1e-9)
    return np.linalg.det(sides) > 0 and inside.any()


@every
def test_a_daughter_comes_as_in_the_twin(name):
    walk = Walk(name, 60, 6)
    surface, points = walk.surface, walk.points
    cells = inner_cells(walk)[:5]
    for daughter, mother in enumerate(cells, start=60):
        before, chart = twin.triangles_of(walk.network), chart_of(surface, points)
        middle = points[mother].copy()
        direction = direction_on_chart(surface, middle, walk.rng.uniform(0, 2 * np.pi))
        used = insert(
            surface, walk.network, *walk.columns, mother, daughter, *in_space(surface, middle, direction), 0.2, 0.4
        )
        points = walk.points
        assert used in (0.2, 0.1, 0.05)
        assert twin.triangles_of(walk.network) == twin.insert(chart, before, mother, daughter, direction)
        np.testing.assert_allclose((points[mother] + points[daughter]) / 2, middle, atol=1e-12)
        assert np.linalg.norm(points[daughter] - points[mother]) == pytest.approx(used)
        walk.check()


def direction_on_chart(surface, point, angle):
    """A direction at a point, of the length 1: of two coordinates, or of three on a sphere."""
    if surface.bends != s.SPHERE:
        return np.array((np.cos(angle), np.sin(angle)))
    normal = point / np.linalg.norm(point)
    one = np.cross(normal, np.roll(normal, 1))
    one /= np.linalg.norm(one)
    return np.cos(angle) * one + np.sin(angle) * np.cross(normal, one)


def in_space(surface, point, direction):
    """A direction of the chart as one in space."""
    if surface.bends == s.SPHERE:
        return surface.side * direction
    if surface.bends == s.PLANE:
        return direction[1], 0.0, direction[0]
    x, y, _ = point / np.hypot(point[0], point[1])
    # At a height, the chart is narrower than the tissue: the direction is not as long as it looks.
    du = direction[0] * np.hypot(point[0], point[1]) / surface.radius * surface.side
    d = np.array((-y * du, x * du, direction[1]))
    return d / np.linalg.norm(d)


@every
def test_rest_lengths_of_a_daughter_and_what_she_leaves_behind(name):
    walk = Walk(name, 60, 7)
    before = twin.lengths_of(walk.network)
    mother = inner_cells(walk)[0]
    direction = s.normals(walk.surface, walk.points[mother])[[1, 2, 0]]
    normal = s.normals(walk.surface, walk.points[mother])
    direction = direction - (direction @ normal) * normal
    direction /= np.linalg.norm(direction)
    assert insert(walk.surface, walk.network, *walk.columns, mother, 70, *direction, 0.1, 0.4) > 0
    after = twin.lengths_of(walk.network)
    assert after.pop((mother, 70)) == after.pop((70, mother)) == 0.4
    for (i, j), length in after.items():
        assert length == before[(mother if i == 70 else i), (mother if j == 70 else j)]
    kept = {(i, j): length for (i, j), length in after.items() if 70 not in (i, j)}
    remove(walk.surface, walk.network, *walk.columns, 70, SUM)
    final = twin.lengths_of(walk.network)
    new = set(final) - set(kept)
    # From mother to the neighbours that the daughter had: over her.
    for i, j in new - {(mother, 70), (70, mother)}:
        if min(i, j) >= 0:
            assert final[i, j] >= min(after.get((i, 70), 0.4), after.get((70, j), 0.4))
    walk.check()


def test_a_new_junction_is_the_sum_of_the_two_whose_place_it_takes():
    # A cell in the middle of four neighbours: it has two ways to leave, and takes the shorter one.
    points = np.array([[1.0, 0, 0], [0, 0, 0.8], [-1.0, 0, 0], [0, 0, -0.8], [0.1, 0, 0.1], [3.0, 0, 0.1]])
    columns = np.array(points.T, order="C")
    network = triangulated(s.plane(), points, np.ones_like)
    assert remove(s.plane(), network, *columns, 4, SUM) == 1
    assert twin.lengths_of(network)[1, 3] == 2.0
    check(s.plane(), network, points)
    network = triangulated(s.plane(), points, np.ones_like)
    assert remove(s.plane(), network, *columns, 4, PRESENT) == 1
    assert twin.lengths_of(network)[1, 3] == pytest.approx(1.6)


@every
def test_cells_leave_until_no_more_can(name):
    walk = Walk(name, 60, 8)
    refused = 0
    for i in range(60):
        before = twin.triangles_of(walk.network), twin.lengths_of(walk.network)
        if remove(walk.surface, walk.network, *walk.columns, i, SUM) < 0:
            refused += 1
            assert (twin.triangles_of(walk.network), twin.lengths_of(walk.network)) == before
        walk.check()
    # A tetrahedron is the least, with ghosts among its vertices; two of a band are; a torus needs seven.
    least = {"patch": 3, "patch of a cylinder": 3, "band along x": 3, "band along z": 3, "band around a cylinder": 3}
    assert refused >= least.get(name, 4 if "sphere" in name else 7)


def test_a_daughter_without_room_gets_less_distance():
    # The line of two neighbours is 0.3 away: the daughter must stay before it.
    points = np.array([[0.3, 0, 1.0], [0.3, 0, -1.0], [-2.0, 0, 0.1], [0, 0, 0]])
    columns = np.array(np.vstack((points, np.full((1, 3), np.nan))).T, order="C")
    network = triangulated(s.plane(), points, np.copy, capacity=5)
    assert insert(s.plane(), network, *columns, 3, 4, 1.0, 0.0, 0.0, 1.0, 0.5) == 0.5
    np.testing.assert_allclose(columns[:, 3:], [[-0.25, 0.25], [0, 0], [0, 0]])
    check(s.plane(), network, columns.T)
    for bad in (np.nan, 0.0):
        network = triangulated(s.plane(), points, np.copy, capacity=5)
        columns[:, 3], columns[:, 4] = 0.0, np.nan
        assert insert(s.plane(), network, *columns, 3, 4, 1.0, 0.0, 0.0, bad, 0.5) == 0.0
        assert (network.out[:5] >= 0).tolist() == [True] * 4 + [False]
        assert follow(s.plane(), network, *columns, 0) == 0
