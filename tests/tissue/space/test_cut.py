"""The cut of a network by a plane, and the cells on it."""

import numpy as np
import pytest

from tests.tissue.space.in_space import of_surface
from tests.tissue.space.tissues import KINDS, spread_points
from tissue.frames.section import cut, cut_of
from tissue.network.triangulation import triangulate
from tissue.runs.simulate import simulate
from tissue.state import surface as s
from tissue.state.mesh import Mesh


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
    radius = KINDS[name].radius
    lengths = []
    for n in (60, 240):
        mesh, points = mesh_of(name, n, rng)
        pieces = cut(KINDS[name], mesh, s.laid(KINDS[name], points), 0.1)
        lengths.append(total(pieces))
        ends = np.round(pieces.reshape(-1, 2), 9)
        assert (np.unique(ends, axis=0, return_counts=True)[1] == 2).all()  # a closed curve
    exact = 2.0 * np.pi * np.sqrt(radius**2 - (0.01 if "sphere" in name else 0.0))
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
