"""Neighbours in space: Delaunay's triangulation on each surface, rest lengths carried over, who comes and goes."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import tissue
from dincl import InvalidProblem
from tests.tissue.space.calls import EULER, KINDS, OPEN, one_point, spread_points
from tissue.kernels import kernel
from tissue.network.lattice import flat_lattice, rows_of
from tissue.network.neighbours import add_daughter, connected, has_room, remove_cell, renew
from tissue.network.triangulation import distances, edges_of, triangulate
from tissue.state import surface as s
from tissue.state.cells import empty
from tissue.state.running import new_state
from tissue.state.space import PRESENT, SPATIAL, SUM, Space, TissueRules, in_use, network_of, no_network, write

every = pytest.mark.parametrize("name", KINDS)


def chart_of(surface, points):
    """Where points (n, 3) are on the chart, to images of their own: (n, 2), of a sphere the normals (n, 3)."""
    x, y, z = points.T
    if surface.bends == s.CYLINDER:
        return np.column_stack((surface.side * surface.radius * np.arctan2(y, x), z))
    return np.column_stack((z, x)) if surface.bends == s.PLANE else s.normals(surface, points)


def apart(surface, arrows):
    """Arrows (..., 2) on the chart to the nearest image."""
    periods = np.array((surface.period_z, surface.period_x))
    if surface.bends == s.CYLINDER:
        periods = np.array((2 * math.pi * surface.radius, surface.period_z))
    whole = np.where(np.isfinite(periods), periods, 1.0)
    return arrows - np.where(np.isfinite(periods), whole * np.round(arrows / whole), 0.0)


def directed(triangles):
    return np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)])


def check(name, edges, triangles, cells):
    """A surface of these cells without a gap, each edge once, whose triangles all turn the same way."""
    found, counts = edges_of(triangles)
    assert sorted(map(tuple, edges.tolist())) == list(map(tuple, found.tolist()))
    assert np.array_equal(np.unique(triangles), np.sort(cells))
    assert len(cells) - len(edges) + len(triangles) == EULER.get(name, 2)
    assert counts.max() == 2
    assert (counts.min() == 2) == (name not in OPEN)
    assert len(np.unique(directed(triangles), axis=0)) == 3 * len(triangles)


def scattered(name, scatter, n, rng):
    """Points at random: anywhere, twenty around each of a few, in rows as on a lattice, or all in one row."""
    points = np.reshape([one_point(name, rng) for _ in range(n)], (n, 3))
    if scatter == "clusters":
        points = points[rng.integers(0, max(1, n // 20), n)] + rng.normal(0.0, 0.05, (n, 3))
    elif scatter == "rows":
        points = np.round(points * 2.0) / 2.0
    elif scatter == "one row":
        points[:, :2] = points[0, :2]
    return points


@every
def test_it_is_the_triangulation_of_delaunay(name):
    """No point is in the circle of a triangle; a sphere has its convex hull. All triangles turn left.

    Of points at random one triangle is several times as large as most, so that a few copies are not enough.
    """
    surface = KINDS[name]
    for seed in range(12):
        points = scattered(name, "anywhere", 60, np.random.default_rng(seed))
        edges, triangles = triangulate(surface, points)
        check(name, edges, triangles, np.arange(60))
        chart = chart_of(surface, points)
        for i, j, k in triangles:
            if surface.bends == s.SPHERE:
                up = np.cross(chart[j] - chart[i], chart[k] - chart[i])
                assert up @ chart[i] > 0.0
                assert ((chart - chart[i]) @ up).max() < 1e-9
            else:
                b, c = apart(surface, chart[[j, k]] - chart[i])
                assert b[0] * c[1] - b[1] * c[0] > 0.0
                centre = np.linalg.solve(2 * np.array((b, c)), np.array((b @ b, c @ c)))
                around = np.linalg.norm(apart(surface, chart - chart[i] - centre), axis=1)
                assert around.min() > (1 - 1e-5) * np.linalg.norm(centre)


@pytest.mark.parametrize("radius", [2.0, 25.0])
def test_neighbours_on_a_cylinder_are_those_where_the_points_are(radius):
    """An apical layer inside of a tube, or far around it, has the neighbours of the plane that it unrolls to."""
    rng = np.random.default_rng(0)
    angle, z = rng.uniform(-math.pi, math.pi, 800), rng.uniform(0.0, 12.0, 800)
    rolled = np.column_stack((radius * np.cos(angle), radius * np.sin(angle), z))
    flat = np.column_stack((radius * angle, np.zeros(800), z))
    edges, _ = triangulate(s.cylinder(10.0, inside=radius < 10.0, period_z=12.0), rolled)
    assert np.array_equal(edges, triangulate(s.plane(period_x=2 * math.pi * radius, period_z=12.0), flat)[0])


@given(
    st.sampled_from(list(KINDS)),
    st.sampled_from(["anywhere", "clusters", "rows", "one row"]),
    st.integers(1, 80),
    st.sampled_from([math.inf, 1.0]),
    st.integers(0, 2**32),
)
def test_any_points_make_a_surface_or_are_refused(name, scatter, n, longest, seed):
    """On either side of an edge is one triangle at most, so that there is room for all; nothing takes forever."""
    points = scattered(name, scatter, n, np.random.default_rng(seed))
    try:
        edges, triangles = triangulate(KINDS[name], points, longest)
    except InvalidProblem:
        return
    assert len(np.unique(directed(triangles), axis=0)) == 3 * len(triangles)
    assert np.array_equal(edges_of(triangles)[0], edges)
    assert np.array_equal(np.unique(edges), np.arange(n))
    assert len(edges) <= 3 * n
    assert len(triangles) <= 2 * n


def lattice(nx, nz):
    return np.array([(i + 0.5, 0.0, k + 0.5) for k in range(nz) for i in range(nx)])


@pytest.mark.parametrize("periods", [(6.0, 5.0), (6.0, math.inf), (math.inf, 5.0), (math.inf, math.inf)])
def test_a_square_lattice_has_sides_and_diagonals(periods):
    points, surface = lattice(6, 5), s.plane(period_x=periods[0], period_z=periods[1])
    lengths = np.unique(np.round(distances(surface, points, triangulate(surface, points)[0]), 9))
    np.testing.assert_allclose(lengths, (1.0, math.sqrt(2)))


@pytest.mark.parametrize("cells", [160, 1764])
def test_a_straight_boundary_has_no_flat_triangles(cells):
    sheet = flat_lattice(cells, rows_of(cells, 0), 1.0, periodic=False)
    points = sheet.basal.T
    lengths = np.unique(np.round(distances(sheet.surface, points, triangulate(sheet.surface, points)[0]), 9))
    np.testing.assert_allclose(lengths, (1.0, math.sqrt(3)))


def test_long_edges_at_a_boundary_are_given_up_and_no_point_is(rng):
    """The notch of a horseshoe is closed by the convex hull, and open if edges may not be so long."""
    points = spread_points("patch", 300, rng)
    points = points[(np.abs(points[:, 0] - 3.0) > 1.2) | (points[:, 2] < 2.0)]
    edges, triangles = triangulate(s.plane(), points, 1.5)
    check("patch", edges, triangles, np.arange(len(points)))
    sides, counts = edges_of(triangles)
    whole = triangulate(s.plane(), points)[0]
    assert distances(s.plane(), points, whole).max() > 2.3
    assert distances(s.plane(), points, sides[counts == 1]).max() <= 1.5
    assert set(map(tuple, edges.tolist())) <= set(map(tuple, whole.tolist()))


def test_a_hole_as_wide_as_the_copies_is_closed(rng):
    """More copies are made where those of a few distances are not enough."""
    surface = s.plane(period_x=60.0, period_z=60.0)
    points = np.column_stack([rng.uniform(0.0, 60.0, 900), np.zeros(900), rng.uniform(0.0, 60.0, 900)])
    points = points[np.hypot(points[:, 0] - 60.0 * (points[:, 0] > 30.0), points[:, 2] - 30.0) > 14.0]
    check("plane", *triangulate(surface, points), np.arange(len(points)))


def test_a_hole_of_half_a_period_stays_open():
    """Junctions across it would pull to the nearer image, the other way."""
    surface, points = s.plane(period_x=9.0, period_z=6.0), lattice(9, 6)
    points = points[np.hypot(points[:, 0] - 4.5, points[:, 2] - 3.0) > 1.7]
    edges, triangles = triangulate(surface, points)
    _, counts = edges_of(triangles)
    assert np.array_equal(np.unique(edges), np.arange(len(points)))
    assert (counts == 1).any()
    ends = chart_of(surface, points)[edges]
    assert (abs(apart(surface, ends[:, 1] - ends[:, 0])) <= (3.0, 4.5)).all()


@pytest.mark.parametrize(
    ("surface", "points", "match"),
    [
        (s.plane(), [[0, 0, 0], [1, 0, 0]], "2 points: must be in no line"),
        (s.plane(), [[0, 0, 0], [1, 0, 0], [2, 0, 0]], "in no line"),
        (s.plane(period_x=8.0), lattice(8, 1), "in no line"),
        (s.plane(period_z=8.0), lattice(5, 1), "in no line"),
        (s.plane(period_x=2.0, period_z=2.0), lattice(2, 1), "more than two around each period"),
        (s.sphere(1.0, inside=False), np.eye(3), "around a sphere"),
        (s.sphere(1.0, inside=False), np.vstack((np.eye(3), [[1, 1, 1]])), "around a sphere"),
        (s.sphere(1.0, inside=False), np.vstack((np.eye(3), [[0, 0, 0]])), "in the middle of the surface"),
        (s.plane(), [[0, 0, math.nan]], "points = nan"),
        (s.plane(), [[0, 0]], r"shape \(n, 3\)"),
    ],
)
def test_points_without_a_triangulation_are_refused(surface, points, match):
    with pytest.raises(InvalidProblem, match=match):
        triangulate(surface, points)


def state_of(surface, points):
    """A tissue whose apical and basal points are these, all in both layers."""
    x, y, z = points.T
    cells = empty(len(points))._replace(ax=x, ay=y, az=z, bx=x, by=y, bz=z, id=np.arange(len(points)))
    networks = (connected(surface, points, length, math.inf, len(points)) for length in (0.5, 0.0))
    space = Space(SPATIAL, surface, *networks, TissueRules())
    return new_state(cells, capacity=2 * len(points), space=space)


def rests_of(network):
    edges, rest, _ = in_use(network)
    return dict(zip(map(tuple, edges.tolist()), rest.tolist(), strict=True))


def test_pairs_that_stay_keep_their_rest_lengths():
    """The diagonal of four points changes: the new one has the mean of what both cells have."""
    points = np.array([(0.0, 0.0, 0.0), (0.0, 0.0, 2.0), (1.1, 0.0, 1.0), (-1.1, 0.0, 1.0)])
    state = state_of(s.plane(), points)
    network, sides = state.space.apical, {(0, 2), (0, 3), (1, 2), (1, 3)}
    assert rests_of(network).keys() == sides | {(0, 1)}
    network.rest[:5] = 0.1 * np.arange(1, 6)
    before, wide = rests_of(network), points * (0.5, 0.0, 2.0)
    state.cells.ax[:4], state.cells.ay[:4], state.cells.az[:4] = wide.T
    renew(state)
    after = rests_of(network)
    assert after.keys() == sides | {(2, 3)}
    assert all(after[pair] == before[pair] for pair in sides)
    assert after[2, 3] == pytest.approx(np.mean([before[pair] for pair in sides]))


@every
def test_renewed_neighbours_are_those_of_the_points(name, rng):
    surface, points = KINDS[name], spread_points(name, 60, rng)
    state = state_of(surface, points)
    moved = points + rng.normal(0.0, 0.3, points.shape)
    state.cells.ax[:60], state.cells.ay[:60], state.cells.az[:60] = moved.T
    renew(state)
    edges, rest, triangles = in_use(state.space.apical)
    check(name, edges, triangles, np.arange(60))
    assert np.array_equal(edges, triangulate(surface, moved)[0])
    assert rest == pytest.approx(np.full(len(edges), 0.5))
    assert (rests_of(state.space.basal).keys() - rests_of(state.space.apical).keys()) != set()


@kernel
def _add(surface, network, x, y, z, i, j, tx, ty, tz, rest):
    add_daughter(surface, network, (x, y, z), i, j, (tx, ty, tz), rest)


@kernel
def _remove(surface, network, x, y, z, i, bridge):
    remove_cell(surface, network, (x, y, z), i, bridge)


@every
def test_daughters_and_gaps_leave_a_surface(name, rng):
    """Inside of the layer: as many edges and triangles as a triangulation of these cells has."""
    surface, points = KINDS[name], spread_points(name, 60, rng)
    network = connected(surface, points, 0.5, math.inf, 90)
    sides, counts = edges_of(in_use(network)[2])
    inner = np.setdiff1d(np.arange(60), sides[counts == 1])
    room = np.vstack((points, np.zeros((30, 3))))
    for j, i in enumerate(inner[:20], 60):
        room[j] = room[i]
        _add(surface, network, *room.T.copy(), i, j, *rng.normal(size=3), 0.2)
        assert rests_of(network)[i, j] == 0.2
    check(name, *in_use(network)[::2], np.arange(60 + len(inner[:20])))
    for i in (inner[0], inner[-1], 62):
        _remove(surface, network, *room.T.copy(), i, SUM)
        assert i not in in_use(network)[0]
        assert i not in in_use(network)[2]
    assert np.isfinite(in_use(network)[1]).all()


TURNS = np.arange(6) * math.pi / 3
HEXAGON = np.vstack(([[0.0] * 3], np.column_stack((np.cos(TURNS), 0.0 * TURNS, np.sin(TURNS)))))


def hexagon(capacity, points=HEXAGON):
    """The network of a hexagon around cell 0, each edge with another rest length."""
    network = connected(s.plane(), points, 0.5, math.inf, capacity)
    network.rest[:12] = np.arange(1, 13)
    return network, rests_of(network)


def test_a_daughter_stands_on_the_edge_ahead():
    """Cell 7 comes between cells 0 and 1, and is joined to both beside."""
    network, before = hexagon(8)
    _add(s.plane(), network, *np.vstack((HEXAGON, [[0.0] * 3])).T.copy(), 0, 7, 1.0, 0.0, 0.1, 0.2)
    after = rests_of(network)
    assert before.keys() - after.keys() == {(0, 1)}
    assert {pair: after[pair] for pair in after.keys() - before.keys()} == {
        (0, 7): 0.2,
        (1, 7): before[0, 1],
        (2, 7): before[0, 2],
        (6, 7): before[0, 6],
    }


@pytest.mark.parametrize("rule", [PRESENT, SUM])
def test_neighbours_of_a_cell_that_leaves_join_the_nearest(rule):
    """Cell 1 is nearest: 3, 4 and 5 join it, 2 and 6 have."""
    points = HEXAGON * np.where(np.arange(7) == 1, 0.9, 1.0)[:, None]
    network, before = hexagon(7, points)
    _remove(s.plane(), network, *points.T.copy(), 0, rule)
    after = rests_of(network)
    assert after.keys() - before.keys() == {(1, 3), (1, 4), (1, 5)}
    assert before.keys() - after.keys() == {(0, k) for k in range(1, 7)}
    for k in (3, 4, 5):
        there = before[0, 1] + before[0, k] if rule == SUM else np.linalg.norm(points[1] - points[k])
        assert after[1, k] == pytest.approx(there)
    assert len(in_use(network).triangles) == 4


def test_room_is_added_and_never_taken():
    """A torus of 30 cells has 90 edges and 60 triangles: all that there is room for."""
    network = connected(s.plane(period_x=6.0, period_z=5.0), lattice(6, 5), 0.5, math.inf, 30)
    larger = network_of(in_use(network), 100)
    assert rests_of(larger) == rests_of(network)
    assert [has_room(*case) for case in ((network, 0), (network, 1), (larger, 70), (larger, 71))] == [1, 0, 1, 0]
    with pytest.raises(InvalidProblem, match="network = 90 edges and 60 triangles: must be at most 87 edges"):
        write(no_network(29), *in_use(network))


def test_a_sheet_in_which_all_cells_divide_again_and_again_has_room():
    """A triangulation with more than 3 n edges would be written behind its arrays."""
    fast = {"tissue.cells": 70, "tissue.two_daughters": 1, "cell.min_cycle": "1.1 h", "cell.max_cycle": "2.5 h"}
    run = tissue.simulate(tissue.preset("sheet").changed({**fast, "numerics.t_end": "2 h"}), 1)
    assert run.status
    assert len(run.final.cells.x) > 2 * 70
    for layer, mesh in zip(run.final.layers, run.final.sheets[1:3], strict=True):
        assert len(mesh.edges) <= 3 * len(layer)
        assert len(mesh.triangles) <= 2 * len(layer)
