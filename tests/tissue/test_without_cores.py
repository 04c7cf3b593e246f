"""Nuclei without hard cores: with radius 0 they overlap as they like, in all of a tissue or in one type."""

import numpy as np
import pytest

from dincl.errors import InvalidProblem
from tests.tissue.space.in_space import of_surface
from tissue.files.parameters import preset
from tissue.runs.simulate import simulate, simulate_many

NONE = {"cell.hard_radius": "0 um", "cell.enlarged_radius": "0 um"}
SOFT = {"types.soft.cells": 20, "types.soft.hard_radius": "0 um", "types.soft.enlarged_radius": "0 um"}
# Without soft repulsion nothing else parts nuclei.
SHORT = {"numerics.t_end": "2 h", "numerics.keep": "1 h", "cell.alpha_xx": 0}


def gaps(cells, mine):
    """Distances of the nearest nuclei among some cells."""
    x, y = cells.x[mine], cells.y[mine]
    apart = np.hypot(x[:, None] - x, y[:, None] - y)
    return apart[np.triu_indices(len(x), 1)].min()


@pytest.mark.parametrize("name", ["thesis", "published", "chick", "gastrulation"])
def test_no_pair_is_corrected(name):
    given = preset(name).changed(NONE | SHORT)
    runs = simulate_many(given, range(2))
    for run in runs:
        assert run.status
        assert run.stats["corrections"] == 0
        assert run.separation.sweeps == 0
    hard = simulate(preset(name).changed(SHORT), 0).final
    assert gaps(runs[0].final.cells, slice(None)) < 0.5 * gaps(hard.cells, slice(None))


def test_a_type_without_cores_among_others():
    """Its nuclei overlap one another, but not the cores of others."""
    final = simulate(preset("thesis").changed(SOFT | SHORT), 1).final
    soft = final.cells.kind == 2
    assert gaps(final.cells, soft) < 0.4
    assert gaps(final.cells, ~soft) > 0.5
    assert (final.cells.radius[soft] == 0).all()


def test_in_space():
    run = simulate(of_surface("plane").changed(NONE), 1)
    assert run.status
    assert run.stats["corrections"] == 0


def test_enlarged_discs_without_hard_ones_are_refused():
    with pytest.raises(InvalidProblem, match=r'enlarged_radius = "0 um": must be at least cell.hard_radius'):
        preset("thesis").changed({"cell.enlarged_radius": "0 um"})
