"""Cells that are spread evenly over a tissue in space."""

import numpy as np
import pytest

import tissue
from tissue.state import surface as s

LAYERS = {
    "periodic": {},
    "open": {"space.boundary": "open"},
    "cylinder": {"layer.shape": "circle", "layer.perimeter": "30 um", "layer.side": "outside"},
    "sphere": {"layer.shape": "sphere", "layer.perimeter": "40 um", "layer.side": "outside"},
}


@pytest.mark.parametrize("name", LAYERS)
def test_cells_that_are_apart_have_equal_shares(name):
    lattice = tissue.preset("published").changed({"tissue.dimension": 3, "tissue.cells": 400} | LAYERS[name]).lattice()
    everyone = np.arange(400)
    for m in (0, 1, 4, 10):
        chosen = lattice.apart(everyone, m)
        assert len(set(chosen.tolist())) == m
        if m > 1:
            shares = np.bincount(distances(lattice, chosen).argmin(axis=1))
            assert shares.min() > 0.6 * 400 / m
            assert shares.max() < 1.6 * 400 / m
    free = everyone[::7]
    assert set(lattice.apart(free, 5)) <= set(free)


def distances(lattice, chosen):
    """From each basal point to those of the chosen cells, to the nearest image."""
    d = lattice.basal[:, :, None] - lattice.basal[:, None, chosen]
    for axis, period in ((0, lattice.surface.period_x), (2, lattice.surface.period_z)):
        d[axis] -= period * np.round(d[axis] / period) if np.isfinite(period) else 0.0
    return np.linalg.norm(d, axis=0)


def test_a_tissue_that_goes_on_gets_groups_where_its_cells_are():
    short = {"tissue.dimension": 3, "tissue.cells": 64, "space.boundary": "open", "numerics.t_end": "0.2 h"}
    first = tissue.simulate(tissue.preset("published").changed(short), 1)
    types = {"types.far.cells": 4, "types.far.place": "apart"}
    after = tissue.preset("published").changed(short | types | {"numerics.t_end": "0.25 h"})
    cells = tissue.simulate(after, 1, start=first.final).final.cells
    far = np.flatnonzero(cells.kind == 2)
    assert len(far) == 4
    points = np.column_stack((cells.bx, cells.bz))
    shares = np.bincount(np.linalg.norm(points[:, None] - points[far], axis=2).argmin(axis=1))
    assert shares.min() > 0.6 * len(points) / 4
    assert shares.max() < 1.6 * len(points) / 4
    assert first.final.sheets.surface == s.plane()
