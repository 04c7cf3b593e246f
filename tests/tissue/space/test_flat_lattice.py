"""The periods of a sheet are those of its rows and columns, which differ."""

import math

import pytest

from tissue.model.lattice import flat_lattice


@pytest.mark.parametrize(("rows", "columns"), [(4, 12), (12, 4), (6, 6)])
@pytest.mark.parametrize("spacing", [1.0, 0.6])
def test_the_rows_fill_one_period(rows, columns, spacing):
    lattice = flat_lattice(rows * columns, rows, spacing, periodic=True)
    assert lattice.surface.period_x == pytest.approx(columns * spacing)
    assert lattice.surface.period_z == pytest.approx(rows * spacing * math.sqrt(3) / 2)
    free = flat_lattice(rows * columns, rows, spacing, periodic=False)
    assert (free.surface.period_x, free.surface.period_z) == (math.inf, math.inf)
