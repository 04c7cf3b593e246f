"""A cap on the cytoskeleton in whole runs: none changes no bit, one keeps cells short; alone and abreast the same."""

import numpy as np
import pytest

from tests.tissue import kernel_calls as kernels
from tests.tissue.bits import same
from tests.tissue.kernel_calls import aged, compared, with_emt
from tests.tissue.states import numbers
from tissue.files.parameters import preset
from tissue.quasi_steady.minimiser import Judge
from tissue.quasi_steady.run import simulate_quasi_steady
from tissue.runs.simulate import simulate

SHORT = {"numerics.t_end": "6 h"}
CAP = {"cell.max_cytoskeleton": "4 R_soft"}


@pytest.mark.parametrize("name", ["thesis", "published"])
def test_a_cap_that_nothing_reaches_changes_no_bit(name):
    runs = [simulate(preset(name).changed({**SHORT, "cell.max_cytoskeleton": cap})) for cap in ("none", "100 R_soft")]
    assert all(map(same, *(run.frames for run in runs)))


@pytest.mark.parametrize("largest", [2.0, 5.0])
def test_kernels_and_twins(largest):
    state = with_emt(aged(20, 3), [9, 10], a=0.15, b=0.25, p=0.35)
    compared(state, numbers(max_cytoskeleton=largest), 6)


def test_a_capped_tissue_is_lower():
    """Rest lengths tend to 4 in all; without a cap they follow the cells, to 6 and more."""
    free, capped = (simulate(preset("published").changed(SHORT | changes)).final for changes in ({}, CAP))
    rests = [cells.rest_ax + cells.rest_bx for cells in (free.cells, capped.cells)]
    assert rests[0].mean() > 5.5
    assert rests[1].max() < 4.0 + 1e-9
    assert capped.cells.ay.mean() < free.cells.ay.mean() - 0.5


def test_the_judge_knows_the_cap():
    """It is in the rest lengths, which are coefficients of the energy."""
    small = {"tissue.cells": 6, "tissue.width": "10 um", "numerics.t_end": "0.2 h", "tissue.diffusion": "0 um^2/h"}
    run = simulate_quasi_steady(preset("thesis").changed({**small, **CAP}), 0, Judge(tol=1e-6))
    assert run.status
    assert (run.final.cells.rest_ax + run.final.cells.rest_bx <= 4.0 + 1e-9).all()


def test_generators_stand_where_they_stand_without():
    """No draw depends on a cap."""
    free, capped = (simulate(preset("thesis").changed(SHORT | changes)).final for changes in ({}, CAP))
    np.testing.assert_array_equal(free.checkpoint.generators, capped.checkpoint.generators)
    assert kernels.same_events(free, capped)
