"""Runs in space: limits that are known, invariants at all output times, free boundaries."""

import numpy as np
import pytest

import tissue
from dincl.errors import InvalidProblem
from tests.tissue.space.in_space import SURFACES, of_surface, parameters
from tissue.frames.observables import extents, layer_area
from tissue.runs.simulate import simulate

# A run that goes on later may end before an event.
pytestmark = pytest.mark.filterwarnings("ignore:.* never begins")

FREE = {
    "tissue.dimension": 3,
    "tissue.cells": 100,
    "space.boundary": "open",
    "tissue.two_daughters": 1,
    "numerics.t_end": "8 h",
}

EMT = {"emt__cells": 3, "emt__a": "0.5 h", "emt__b": "1 h", "emt__s": "1 h", "emt__p": "1.5 h"}


def test_a_run_counts_its_work():
    """As a run in a slice does: so many substeps in each dt, and what was corrected in them."""
    given = parameters(numerics__t_end="0.5 h")
    stats = simulate(given, 0).stats
    assert stats["substeps"] == given.numbers().substeps * round(0.5 / given.numbers().dt)
    assert stats["corrections"] > 0
    assert stats["basal_corrections"] > 0


@pytest.mark.parametrize("name", SURFACES)
def test_basal_points_stay_on_their_surface(name):
    run = simulate(of_surface(name, numerics__keep="0.5 h", **EMT), 1)
    for frame in run.frames:
        cells, held = frame.cells, frame.layers.basal
        assert np.abs(frame.heights(cells.bx[held], cells.by[held], cells.bz[held])).max() < 1e-12
    assert len(run.final.cells.x) > len(run.frames[0].cells.x)


def test_the_triangles_of_a_periodic_network_cover_the_sheet_once():
    """So no two edges cross, whatever moved, came or left; who has left has none."""
    run = simulate(parameters(numerics__keep="0.1 h", **EMT), 2)
    for frame in run.frames:
        area = frame.sheets.surface.period_x * frame.sheets.surface.period_z
        assert layer_area(frame, "basal") == pytest.approx(area, rel=1e-12)
        assert extents(frame).nuclear_layers == pytest.approx(np.pi * len(frame.cells.x) / area, rel=1e-12)
        for mesh, layer in zip(frame.sheets[1:3], frame.layers, strict=True):
            assert len(mesh.triangles) == 2 * len(layer)
            assert np.array_equal(np.unique(mesh.triangles), layer)
    emt = np.flatnonzero(run.final.cells.emt >= 0)
    assert len(emt) == 3
    assert not any(np.isin(emt, layer).any() for layer in run.final.layers)


def test_triangles_of_a_sphere():
    """Euler characteristic 2, and less area than the sphere, of which they are chords."""
    run = simulate(of_surface("sphere", numerics__keep="0.2 h", **EMT), 2)
    radius = run.final.sheets.surface.radius
    for frame in run.frames:
        assert len(frame.sheets.basal.triangles) == 2 * len(frame.layers.basal) - 4
        assert 0.9 < layer_area(frame, "basal") / (4 * np.pi * radius**2) < 1


def test_a_failed_network_ends_the_run_with_its_status():
    """Two cells that are left in the apical layer have no triangulation."""
    run = simulate(parameters(emt__cells=62, emt__a="0.1 h", tissue__two_daughters=0), 0, throw=False)
    assert run.status.name == "NETWORK_TORN"
    assert run.final.t == pytest.approx(0.1)
    assert len(run.final.layers.apical) == 2
    with pytest.raises(InvalidProblem, match=r"t = 0.1 h: must be a state before the run failed, but its network is"):
        simulate(run.parameters, 0, run.final)


def test_the_edge_of_a_sheet_does_not_fray():
    """It stays about a circle, whose squared perimeter is 4 pi areas; with fingers it was 72 areas."""
    final = simulate(tissue.preset("published").changed(FREE), 0).final
    points, corners = np.column_stack((final.cells.ax, final.cells.az)), final.sheets.apical.triangles
    sides = np.sort(np.concatenate([corners[:, [k, (k + 1) % 3]] for k in range(3)]), axis=1)
    edges, count = np.unique(sides, axis=0, return_counts=True)
    perimeter = np.linalg.norm(np.diff(points[edges[count == 1]], axis=1), axis=2).sum()
    a, b = (points[corners[:, k]] - points[corners[:, 0]] for k in (1, 2))
    area = np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum() / 2
    assert perimeter**2 < 14.0 * area


def test_many_cells_that_leave_at_once_leave_neighbours_where_they_are():
    """A fifth of the basal cells of a periodic sheet let go in one dt: no basal point goes around the period."""
    leaving = tissue.preset("sheet").changed({"emt.cells": 40, "emt.b": "1 h", "numerics.t_end": "2 h"})
    final = tissue.simulate(leaving, 5).final
    held, cells = final.layers.basal, final.cells
    assert np.hypot(cells.ax - cells.bx, cells.az - cells.bz)[held].max() < 3.0


def test_a_periodic_layer_that_covers_little_is_folded():
    """Its height is that of the cells that are left."""
    run = tissue.simulate(
        tissue.preset("sheet").changed({"emt.cells": 160, "emt.a": "1 h", "numerics.t_end": "2 h"}), 0
    )
    assert run.status
    assert "covers" in run.folded


# Free boundaries

# A slice made a sheet, which is crowded.
CROWDED = tissue.preset("published").changed(
    {"tissue.dimension": 3, "tissue.cells": 196, "tissue.two_daughters": 1, "numerics.t_end": "6 h"}
)


@pytest.mark.parametrize(("most", "least", "largest"), [("1/3 R_soft", 0.55, 0.7), ("1/2 R_soft", 0.8, 1.0)])
def test_a_free_basal_layer_draws_together(most, least, largest):
    """How far its basal neighbours may be apart says how far; the root of its area after three hours."""
    short = {"numerics.t_end": "3 h", "space.boundary": "open", "tissue.max_basal_distance": most}
    frames = tissue.simulate(CROWDED.changed(short), 1).frames
    first, last = (np.sqrt(layer_area(frame, "basal")) for frame in (frames[0], frames[-1]))
    assert least < last / first < largest
