"""The tutorial of the tissue in three dimensions: its Python runs, and what its text says is so."""

import pytest

import tissue
from tests.pages import ROOT, play

PAGE = ROOT / "docs" / "tutorials" / "space.md"


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    folder = tmp_path_factory.mktemp("space")
    return play(PAGE, folder) | {"folder": folder}


def test_the_page_runs(found):
    run = found["run"]
    assert (found["folder"] / "section.png").exists()
    assert len(run.final.cells.x) > 196
    assert {"nucleus_z_um", "apical_z_um", "basal_z_um"} <= set(run.table().columns)
    assert f"{2 * len(run.final.layers.apical)} triangles of" in found["printed"]


def test_tension_that_is_forgotten_makes_the_apical_layer_rough(found):
    """The spread of its heights in a crowded sheet, of three seeds."""
    given = found["parameters"].changed({"numerics.t_end": "12 h", "numerics.keep": "12 h"})
    mean, distance = (
        [tissue.simulate(given.changed({"space.new_rest": rule}), seed).final.cells.ay.std() for seed in range(3)]
        for rule in ("mean", "distance")
    )
    assert max(mean) < 0.5 < 0.7 < min(distance)
