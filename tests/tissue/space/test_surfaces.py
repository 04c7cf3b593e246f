"""Surfaces in space: heights and normals, directions along them and divisions; where cells stand, and sections."""

import math

import numpy as np
import pytest

import tissue
from dincl import InvalidProblem
from tests.tissue.space.calls import KINDS, feet, spread_points
from tests.tissue.space.in_space import SURFACES, of_surface
from tissue.frames.section import cut, cut_of
from tissue.kernels import kernel
from tissue.network.triangulation import triangulate
from tissue.rules.sheet import direction, split_cell
from tissue.runs.simulate import simulate
from tissue.runs.start import started
from tissue.state import surface as s
from tissue.state.checkpoint import streams
from tissue.state.running import CELLS
from tissue.state.space import Mesh

every = pytest.mark.parametrize("surface", KINDS.values(), ids=KINDS)


@kernel
def measure(surface, points, heights, normals, feet):
    for i in range(len(points)):
        x, y, z = points[i]
        heights[i] = s.height(surface, x, y, z)
        normals[i, 0], normals[i, 1], normals[i, 2] = s.normal(surface, x, y, z)
        feet[i, 0], feet[i, 1], feet[i, 2] = s.onto(surface, x, y, z)


@every
def test_a_point_is_its_foot_and_its_height_along_the_normal(surface, rng):
    """One by one as in arrays."""
    points = rng.normal(size=(50, 3)) * 3
    heights, normals, feet = np.empty(50), np.empty((50, 3)), np.empty((50, 3))
    measure(surface, points, heights, normals, feet)
    np.testing.assert_allclose(heights, s.heights(surface, points), rtol=1e-14, atol=1e-14)
    np.testing.assert_allclose(normals, s.normals(surface, points), rtol=1e-14)
    np.testing.assert_allclose(s.heights(surface, feet), 0.0, atol=1e-14)
    np.testing.assert_allclose(feet + heights[:, None] * normals, points, rtol=1e-13, atol=1e-13)
    further = s.heights(surface, points + 1e-6 * normals)
    np.testing.assert_allclose(further - heights, 1e-6, rtol=1e-6)


@pytest.mark.parametrize(("d", "period", "nearest"), [(2.6, 5.0, -2.4), (-12.6, 5.0, 2.4), (1e9, math.inf, 1e9)])
def test_differences_are_to_the_nearest_image(d, period, nearest):
    assert s.nearest_image(d, period) == pytest.approx(nearest)
    surface = s.plane(period_x=period, period_z=2 * period)
    assert s.differences(surface, d, d, d)[:2] == (s.nearest_image(d, period), d)


def test_the_middle_has_no_normal():
    with pytest.raises(InvalidProblem, match="middle"):
        s.normals(s.sphere(1.0, inside=False), np.zeros((1, 3)))
    with pytest.raises(InvalidProblem, match="middle"):
        s.normals(s.cylinder(1.0, inside=False), [[0.0, 0.0, 3.0]])


# Divisions

# Also near the poles, where the z axis is the normal of the sphere.
PLACES = [*np.random.default_rng(20260120).normal(size=(30, 3)), *np.array([[0.1, 0.2, 3.0], [-0.3, 0.1, -2.0]])]


@pytest.mark.parametrize("turn", [0.0, 1 / 6, 0.4, 0.75])
@every
def test_the_direction_of_a_division_is_along_the_surface_and_turns(surface, turn):
    for X in PLACES:
        normal = s.normals(surface, X)
        first, found = (np.array(direction(surface, part, *map(float, X))) for part in (0.0, turn))
        assert np.linalg.norm(found) == pytest.approx(1.0)
        assert found @ normal == pytest.approx(0.0, abs=1e-12)
        assert found @ first == pytest.approx(math.cos(2 * math.pi * turn))
        assert abs(np.cross(first, found) @ normal) == pytest.approx(abs(math.sin(2 * math.pi * turn)))


@pytest.mark.parametrize("turn", [1 / 6, 0.4, 0.9])
@pytest.mark.parametrize("name", SURFACES)
def test_the_nuclei_of_daughters_lie_on_both_sides_of_the_mother(name, turn):
    """At X - offset t the mother and at X + offset t the daughter, t at right angles to the normal; no other moves."""
    given, offset = of_surface(name), 0.05
    surface = given.lattice().surface
    for cell in (11, 37, 60):
        held = started(given, streams(2))
        cells, n = held.cells, held.sizes[CELLS]
        before = np.column_stack((cells.x, cells.y, cells.z))[:n]
        t = np.array(direction(surface, turn, *(float(line[cell]) for line in (cells.bx, cells.by, cells.bz))))
        split_cell(held, cell, turn, given.numbers()._replace(offset=offset))
        after, normal = np.column_stack((cells.x, cells.y, cells.z))[: n + 1], s.normals(surface, before[cell])
        t -= (t @ normal) * normal  # where the nucleus is beside its basal point
        t *= offset / np.linalg.norm(t)
        np.testing.assert_allclose(after[[cell, -1]], [before[cell] - t, before[cell] + t], rtol=0, atol=1e-14)
        np.testing.assert_array_equal(np.delete(after[:-1], cell, axis=0), np.delete(before, cell, axis=0))


# Cells that are spread evenly


def shares(lattice_points, chosen, periods=(math.inf,) * 3):
    """To how many points each of the chosen ones is nearest, over the mean."""
    d = lattice_points[:, :, None] - lattice_points[:, None, chosen]
    for axis, period in enumerate(periods):
        d[axis] -= period * np.round(d[axis] / period) if np.isfinite(period) else 0.0
    found = np.bincount(np.linalg.norm(d, axis=0).argmin(axis=1))
    return found * len(chosen) / lattice_points.shape[1]


@pytest.mark.parametrize("name", SURFACES)
def test_cells_that_are_apart_have_equal_shares(name):
    lattice = of_surface(name).lattice()
    n, surface = lattice.basal.shape[1], lattice.surface
    for m in (0, 1, 4, 10):
        chosen = lattice.apart(np.arange(n), m)
        assert len(set(chosen.tolist())) == m
        if m > 1:
            found = shares(lattice.basal, chosen, (surface.period_x, math.inf, surface.period_z))
            assert 0.6 < found.min() <= found.max() < 1.6
    free = np.arange(n)[::7]
    assert set(lattice.apart(free, 5)) <= set(free)


def test_a_tissue_that_goes_on_gets_groups_where_its_cells_are():
    short = {"tissue.dimension": 3, "tissue.cells": 64, "space.boundary": "open", "numerics.t_end": "0.2 h"}
    first = tissue.simulate(tissue.preset("published").changed(short), 1)
    types = {"types.far.cells": 4, "types.far.place": "apart"}
    after = tissue.preset("published").changed(short | types | {"numerics.t_end": "0.25 h"})
    cells = tissue.simulate(after, 1, start=first.final).final.cells
    found = shares(np.array([cells.bx, 0.0 * cells.bx, cells.bz]), np.flatnonzero(cells.kind == 2))
    assert len(found) == 4
    assert 0.6 < found.min() <= found.max() < 1.6
    assert first.final.sheets.surface == s.plane()


# The cut of a network by a plane


def mesh_of(name, n, rng):
    points = spread_points(name, n, rng)
    edges, triangles = triangulate(KINDS[name], points)
    return Mesh(edges, np.zeros(len(edges)), triangles), points


def total(pieces):
    return np.linalg.norm(pieces[:, 1] - pieces[:, 0], axis=1).sum()


@pytest.mark.parametrize("z", [0.0, 1.3, -4.4])
def test_the_cut_of_a_flat_sheet_goes_once_through_it(z, rng):
    mesh, points = mesh_of("plane", 70, rng)
    points[:, 1] = 0.0
    away = points + np.array([8.0, 0.0, 9.0]) * rng.integers(-2, 3, (len(points), 3))  # images, as runs have them
    assert total(cut(KINDS["plane"], mesh, away, z)) == pytest.approx(8.0)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["sphere outside", "sphere inside", "cylinder outside"])
def test_the_cut_of_a_round_surface_is_a_circle(name, rng):
    surface, lengths = KINDS[name], []
    for n in (60, 240):
        mesh, points = mesh_of(name, n, rng)
        pieces = cut(surface, mesh, feet(surface, points), 0.1)
        lengths.append(total(pieces))
        ends = np.round(pieces.reshape(-1, 2), 9)
        assert (np.unique(ends, axis=0, return_counts=True)[1] == 2).all()  # a closed curve
    exact = 2.0 * np.pi * np.sqrt(surface.radius**2 - (0.01 if "sphere" in name else 0.0))
    assert abs(lengths[1] - exact) < abs(lengths[0] - exact)
    assert lengths[1] == pytest.approx(exact, rel=0.05)


def test_all_ends_are_on_edges(rng):
    mesh, points = mesh_of("patch", 50, rng)
    pieces, edges = cut(KINDS["patch"], mesh, points, 0.2).reshape(-1, 2), points[mesh.edges]
    crossed = edges[(edges[:, 0, 2] > 0.2) != (edges[:, 1, 2] > 0.2)]
    part = (0.2 - crossed[:, 0, 2]) / (crossed[:, 1, 2] - crossed[:, 0, 2])
    expected = (crossed[:, 0] + part[:, None] * (crossed[:, 1] - crossed[:, 0]))[:, :2]
    assert np.unique(np.round(pieces, 9), axis=0) == pytest.approx(np.unique(np.round(expected, 9), axis=0))


def test_a_section_has_the_cut_of_the_apical_layer():
    first = simulate(of_surface("cylinder", numerics__t_end="0.05 h"), 2).frames[0]
    surface, pieces = first.sheets.surface, cut_of(first)
    away = np.hypot(pieces[..., 0], pieces[..., 1] + surface.side * surface.radius)
    assert surface.side * (away - surface.radius) == pytest.approx(np.full(away.shape, 2.0), abs=0.02)
    slice_ = simulate(of_surface("plane", tissue__dimension=2, numerics__t_end="0.1 h"), 2).frames[0]
    assert cut_of(slice_) is None
