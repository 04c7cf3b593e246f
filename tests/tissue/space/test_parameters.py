"""What a file must say of a tissue in three dimensions, and what it must not."""

import re

import pytest

from dincl.errors import InvalidProblem
from tests.tissue.space.in_space import OF_CYLINDER, OF_SPHERE, parameters
from tissue.files.parameters import preset


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
            "tissue.cells = 45: must be a size that fits, the nearest is 56: columns times an even number",
        ),
        (
            {"tissue.cells": 66},
            "= 66: must be a size that fits, the nearest are 64 and 70: the sheet repeats after 3.4",
        ),
        ({"space.rows": 7}, "space.rows = 7: must be an even number, 4 or more, or 0"),
        ({"space.rows": 6}, "space.rows = 6: must be at least 8, or 0: the sheet repeats after 3.464 R_soft, and must"),
        ({"tissue.apical_spacing": "0.6 R_soft"}, 'tissue.apical_spacing = "0.6 R_soft": must be tissue.basal_spacing'),
        (
            OF_CYLINDER | {"tissue.max_basal_distance": "1/3 R_soft"},
            "tissue.cells = 256: must be a size that fits: of so few the basal points do not go around (C2)",
        ),
        (OF_SPHERE | {"tissue.cells": 50}, "= 50: must be a size that fits, the nearest is 187: of so few the basal"),
        (OF_SPHERE | {"layer.side": "inside", "tissue.height": "3 R_soft"}, "must be below 2.387 R_soft, the radius"),
        ({"emt.cells": 2, "emt.ac": "1 h"}, 'emt.ac = "1 h": must be "never" in three dimensions'),
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


@pytest.mark.parametrize(
    ("name", "changes"),
    [
        ("published", {}),
        ("sheet", {}),
        ("cuboidal", {}),
        ("published", {"space.rows": 14}),
        ("published", {"emt.cells": 190, "space.boundary": "open"}),
        ("published", {"layer.shape": "circle", "tissue.max_basal_distance": "1 R_soft"}),
        ("chick", {"layer.shape": "sphere", "layer.perimeter": "15 R_soft", "layer.side": "outside"}),
    ],
)
def test_a_size_that_does_not_fit_gets_the_nearest_that_do(name, changes):
    """Of 1 to 419 cells those that are refused name those that are accepted, on both sides if there are some."""

    def sheet(cells):
        return preset(name).changed({"tissue.dimension": 3, "tissue.cells": cells, **changes})

    accepted, named = [], {}
    for cells in range(1, 420):
        try:
            accepted.append(sheet(cells).tissue.cells)
        except InvalidProblem as error:
            if "tissue.cells" in str(error):  # fewer cells than EMT cells are refused for that
                named[cells] = [int(n) for n in re.findall(r"\d+", str(error).split("nearest")[1].split(":")[0])]
    assert named
    for cells, near in named.items():
        below, above = [n for n in accepted if n < cells][-1:], [n for n in accepted if n > cells][:1]
        assert near == below + above or (not above and near[:-1] == below)
    for cells in {n for near in named.values() for n in near} - set(accepted):
        assert sheet(cells).tissue.cells == cells
