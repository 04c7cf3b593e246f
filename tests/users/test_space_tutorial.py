"""The tutorial of the tissue in three dimensions: its Python runs, and what its text says is so."""

import numpy as np
import pytest

import tissue
from tests.optional import need_rendering
from tests.pages import ROOT, play
from tissue.files.parameters import load
from tissue.frames.observables import basal_area

PAGE = ROOT / "docs" / "howto" / "space.md"


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    need_rendering()
    folder = tmp_path_factory.mktemp("space")
    return play(PAGE, folder) | {"folder": folder}


def test_the_page_runs(found):
    run = found["run"]
    assert (found["folder"] / "section.png").exists()
    assert (found["folder"] / "sheet.gif").exists()
    assert load(found["folder"] / "sheet.toml").tissue.cells == 182
    drawn = {path.name for path in (found["folder"] / "results" / "leave" / "figures").iterdir()}
    assert {"positions.png", "ratios.png", "at_end.png", "examples_1.png", "examples_2.png"} <= drawn
    assert len(run.final.cells.x) > 196
    assert {"nucleus_z_um", "apical_z_um", "basal_z_um"} <= set(run.table().columns)
    assert f"{2 * len(run.final.layers.apical)} triangles of" in found["printed"]


@pytest.mark.slow
def test_tension_that_is_forgotten_makes_the_apical_layer_rough(found):
    """The spread of its heights in a crowded sheet, of three seeds."""
    given = found["parameters"].changed({"numerics.t_end": "12 h", "numerics.keep": "12 h"})
    mean, distance = (
        [tissue.simulate(given.changed({"space.new_rest": rule}), seed).final.cells.ay.std() for seed in range(3)]
        for rule in ("mean", "distance")
    )
    assert max(mean) < 0.5 < 0.7 < min(distance)


@pytest.mark.parametrize(("most", "least", "largest"), [("1/3 R_soft", 0.5, 0.65), ("1/2 R_soft", 0.75, 0.95)])
def test_a_free_basal_layer_draws_together(found, most, least, largest):
    """How far its basal neighbours may be apart says how far; the root of its area after an hour."""
    short = {"numerics.t_end": "1 h", "space.boundary": "open", "tissue.max_basal_distance": most}
    frames = tissue.simulate(found["parameters"].changed(short), 1).frames
    first, last = (np.sqrt(basal_area(frame.cells, frame.sheets)) for frame in (frames[0], frames[-1]))
    assert least < last / first < largest
