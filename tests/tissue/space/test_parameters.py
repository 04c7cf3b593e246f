"""What a file must say of a tissue in three dimensions, and what it must not."""

import re

import pytest

from dincl.errors import InvalidProblem
from tests.tissue.space.in_space import OF_CYLINDER, OF_SPHERE, parameters
from tissue.files.parameters import load, preset
from tissue.study.plan import load_study, shipped


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"tissue.dimension": 4}, "tissue.dimension = 4: must be 2 or 3"),
        ({"layer.shape": "ellipse"}, 'layer.shape = "ellipse": must be "line" or "circle" or "sphere" in three dim'),
        (
            {"tissue.dimension": 2, "layer.shape": "sphere"},
            'must be "line" or "circle" or "ellipse" or "points" in a slice',
        ),
        (
            {"tissue.cells": 45},
            "tissue.cells = 45: must be columns times an even number of rows, 4 or more of each, such as 44 or 48",
        ),
        ({"space.rows": 7}, "space.rows = 7: must be 4 or 8 or 16, or 0"),
        ({"tissue.apical_spacing": "0.6 R_soft"}, 'tissue.apical_spacing = "0.6 R_soft": must be tissue.basal_spacing'),
        (
            OF_CYLINDER | {"tissue.max_basal_distance": "1/3 R_soft"},
            "tissue.cells = 256: must be at least 480: of fewer",
        ),
        (OF_SPHERE | {"tissue.cells": 50}, "tissue.cells = 50: must be at least 187: of fewer the basal points do not"),
        (OF_SPHERE | {"layer.side": "inside", "tissue.height": "3 R_soft"}, "must be below 2.387 R_soft, the radius"),
        ({"space.rows": 4}, "tissue.cells = 64: must be more, in more rows or columns: the sheet repeats after 2.309"),
        ({"emt.cells": 2, "emt.ac": "1 h"}, 'emt.ac = "1 h": must be "never" in three dimensions'),
        ({"space.flip_margin": 1.5}, "space.flip_margin = 1.5: must be a number from 0 to 1"),
    ],
)
def test_what_does_not_go_together(changes, message):
    with pytest.raises(InvalidProblem) as error:
        parameters().changed(changes)
    assert message in str(error.value)


def test_a_slice_has_no_rows():
    """Keys of [space] are without effect in a slice, where any number of cells is right."""
    assert preset("published").changed({"tissue.cells": 47, "space.rows": 6}).curve().pieces == 0


@pytest.mark.parametrize(("cells", "rows"), [(400, 20), (64, 8), (100, 10), (2000, 50)])
def test_rows_of_a_square_sheet(cells, rows):
    surface = parameters(tissue__cells=cells).lattice().surface
    assert surface.period_z == pytest.approx(rows * 3**0.5 / 3)
    assert surface.period_x == pytest.approx(cells / rows * 2 / 3)


@pytest.mark.slow_with("published-changes3")
@pytest.mark.parametrize(
    ("name", "changes", "cells"),
    [
        ("thesis", {}, 182),
        ("published", {"space.boundary": "open"}, 48),
        ("cuboidal", {}, 48),
        ("published", {"layer.shape": "circle", "space.boundary": "open"}, 724),
    ],
)
def test_a_slice_becomes_a_tissue_in_space_by_one_key(name, changes, cells):
    """It has the fewest cells that fill it; one cell less, or fewer rows, would be refused."""
    made = preset(name).changed({"tissue.dimension": 3, **changes})
    assert made.in_space
    assert made.tissue.cells == cells >= preset(name).tissue.cells
    for fewer in range(preset(name).tissue.cells, cells):
        with pytest.raises(InvalidProblem):
            preset(name).changed({"tissue.dimension": 3, "tissue.cells": fewer, **changes})


def test_a_file_makes_a_sheet_of_its_base_by_one_key(tmp_path):
    (tmp_path / "sheet.toml").write_text('base = "thesis"\n[tissue]\ndimension = 3\n')
    assert load(tmp_path / "sheet.toml") == preset("thesis").changed({"tissue.dimension": 3})


@pytest.mark.slow_with("curved_published")
@pytest.mark.parametrize("name", [name for name in shipped() if name != "space_published"])
def test_a_study_of_slices_becomes_one_of_sheets_by_one_key(name, tmp_path):
    """Without the cells of a slice in the same table."""
    slices = load_study(name)
    head, *scenarios = slices.text.split("\n[", 1)
    key = "[overrides.tissue]\ndimension = 3\n"
    own = re.sub("(?m)^cells = 51.*\n", "", slices.text)
    text = own.replace("[overrides.tissue]\n", key) if "[overrides.tissue]" in own else None
    (tmp_path / "sheets.toml").write_text(text or f"{head}\n{key}\n[{scenarios[0]}")
    sheets = load_study(tmp_path / "sheets.toml")
    assert sheets.scenarios.keys() == slices.scenarios.keys()
    assert all(one.in_space for one in sheets.scenarios.values())


STUDY = """
title = "s"
base = "published"
replicates = 1
seed = 1
"""


def test_a_table_with_dimension_and_cells_that_fill_no_rows_is_refused(tmp_path):
    study = tmp_path / "study.toml"
    study.write_text(STUDY + "[scenarios.sheet.tissue]\ndimension = 3\ncells = 51\n", "utf-8")
    with pytest.raises(
        InvalidProblem, match=r"scenario 'sheet': tissue\.cells = 51: must be columns times an even number"
    ):
        load_study(study)
    study.write_text(STUDY + "[overrides.tissue]\ncells = 51\n[scenarios.sheet.tissue]\ndimension = 3\n", "utf-8")
    found = load_study(study)
    assert found.scenarios["sheet"].tissue.cells > 51
    taken = f"tissue.cells = {found.scenarios['sheet'].tissue.cells} fill the rows in three dimensions"
    assert found.remarks == [f"scenario 'sheet': {taken}; 51 are those of a slice"]
