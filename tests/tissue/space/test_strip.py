"""A strip one cell wide, around an open cylinder, is the ring of the plane, cell by cell."""

import numpy as np
import pytest

import tissue
from dincl import InvalidProblem
from tissue.frames.observables import nuclear_layers

COMMON = {
    "layer.shape": "circle",
    "layer.side": "outside",
    "start.nuclei": "own_basal",
    "tissue.diffusion": "0 um^2/h",
    "numerics.keep": "0.5 h",
}
STRIP = {"tissue.dimension": 3, "space.boundary": "open", "space.rows": 1}
EVENTS = ({}, {"emt.a": "1 h"}, {"emt.b": "1 h"}, {"emt.b": "1 h", "emt.p": "1.5 h"}, {"emt.s": "1 h", "emt.inm": 0})


def both(**changes):
    """A ring and a strip of 80 cells from the same start."""
    given = tissue.preset("published").changed(COMMON | {"tissue.cells": 80, "layer.perimeter": "130 um"} | changes)
    ring, strip = given.changed({"layer.closed": True}), given.changed(STRIP)
    return tissue.simulate(ring, seed=1), tissue.simulate(strip, seed=1)


def heights(frame):
    cells = frame.cells
    return np.array([frame.heights(*(getattr(cells, p + x) for x in "xyz")) for p in ("", "a", "b")])


@pytest.mark.parametrize("events", EVENTS)
def test_cell_by_cell_and_event_by_event(events):
    """Up to what curvature makes of basal points in space, and a sweep in another order."""
    twins = {"emt.cells": 2} if events else {}
    ring, strip = both(**{"tissue.two_daughters": 0, "numerics.t_end": "3 h"}, **twins, **events)
    for one, other in zip(ring.frames, strip.frames, strict=True):
        assert heights(one) == pytest.approx(heights(other), abs=5e-3)
        assert one.cells.rest_ax == pytest.approx(other.cells.rest_ax, abs=5e-3)
        assert len(one.layers.apical) == len(other.layers.apical)
        assert nuclear_layers(one) == pytest.approx(nuclear_layers(other), rel=5e-3)
    if "emt.b" in events:
        assert not np.isclose(heights(ring.final)[2], 0.0, atol=1e-6).all()


def test_inside_of_a_cylinder():
    """The order of basal points goes the other way round there."""
    inside = {"layer.side": "inside", "tissue.cells": 160, "layer.perimeter": "260 um"}
    ring, strip = both(**inside, **{"tissue.two_daughters": 0, "numerics.t_end": "0.5 h"})
    assert heights(ring.final) == pytest.approx(heights(strip.final), abs=1e-2)


def test_the_difference_falls_with_curvature():
    """In the plane basal points move along the layer, in space straight, and are then put on it."""
    found = []
    for factor in (1, 2):
        more = {"tissue.cells": 80 * factor, "layer.perimeter": f"{130 * factor} um", "numerics.t_end": "0.05 h"}
        ring, strip = both(**{"tissue.two_daughters": 0}, **more)
        found.append(np.abs(heights(ring.final) - heights(strip.final)).max())
    assert 1.5 < found[0] / found[1] < 2.5


def test_it_stays_a_row_while_cells_divide_and_leave():
    run = both(**{"tissue.two_daughters": 1, "numerics.t_end": "12 h", "emt.cells": 4, "emt.a": "3 h", "emt.b": "5 h"})[
        1
    ]
    assert len(run.final.cells.x) > 120
    for frame in run.frames:
        cells = frame.cells
        assert not np.any((cells.z, cells.az, cells.bz))
        for mesh, layer in zip((frame.sheets.apical, frame.sheets.basal), frame.layers, strict=True):
            assert len(mesh.triangles) == 0
            assert (np.bincount(mesh.edges.ravel(), minlength=len(cells.x))[layer] == 2).all()
            assert len(mesh.edges) == len(layer)


def test_what_is_measured_of_a_strip():
    ring, strip = both(**{"tissue.two_daughters": 0, "numerics.t_end": "0.5 h"})
    one, other = (run.summary().iloc[-1] for run in (ring, strip))
    for name in ("height_um", "nuclear_layers", "mean_y_ab"):
        assert one[name] == pytest.approx(other[name], rel=1e-3)
    inner = tissue.preset("published").changed(COMMON | STRIP | {"tissue.cells": 80, "layer.perimeter": "130 um"})
    assert inner.lattice().basal[2].tolist() == [0.0] * 80


def test_only_an_open_cylinder_has_a_single_row():
    given = tissue.preset("published").changed(COMMON | STRIP | {"tissue.cells": 80, "layer.perimeter": "130 um"})
    for change in ({"space.boundary": "periodic"}, {"layer.shape": "line"}):
        with pytest.raises(InvalidProblem, match="rows = 1"):
            given.changed(change)
    with pytest.raises(InvalidProblem, match=r'tissue.diffusion = .*: must be "0 um\^2/h" with space.rows = 1'):
        given.changed({"tissue.diffusion": "1 um^2/h"})
