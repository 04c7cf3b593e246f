"""A division in space: where both daughters are, on each surface, and what is theirs."""

import math

import numpy as np
import pytest

from tests.tissue.space.in_space import SURFACES, of_surface
from tissue.rules.sheet import split_cell
from tissue.runs.start import started
from tissue.state.checkpoint import streams
from tissue.state.running import CELLS
from tissue.state.surface import normals

OFFSET = 0.05


def divided(name, cell, turn):
    """Nuclei of a tissue before, and the tissue after a division; the surface."""
    given = of_surface(name)
    held, _ = started(given, streams(2))
    before = nuclei(held)
    split_cell(held, cell, turn, given.numbers()._replace(offset=OFFSET))
    return before, held, given.lattice().surface


def basal_of_mother(name, cell):
    """B of a cell of this tissue before she divides."""
    cells = started(of_surface(name), streams(2))[0].cells
    return np.array([getattr(cells, axis)[cell] for axis in ("bx", "by", "bz")])


def nuclei(held):
    """X, (n, 3)."""
    cells, n = held.cells, held.sizes[CELLS]
    return np.column_stack((cells.x, cells.y, cells.z))[:n]


def direction(surface, at, turn):
    """The direction along the surface at a point that is a part of a whole turn from one across the z axis.

    Across is (n_y, -n_x, 0), n the normal: on a plane the direction is (cos, 0, sin).
    """
    n = normals(surface, at)
    across = np.array((n[1], -n[0], 0.0)) / math.hypot(n[0], n[1])
    return math.cos(2.0 * math.pi * turn) * across + math.sin(2.0 * math.pi * turn) * np.cross(across, n)


@pytest.mark.parametrize("turn", [1 / 6, 0.4, 0.9])
@pytest.mark.parametrize("name", ["plane", "open", "cylinder"])
def test_the_nuclei_of_daughters_lie_on_both_sides_of_the_mother(name, turn):
    """At X - offset t the mother and at X + offset t the daughter, both as high as she was; nobody else moves."""
    cell = 37
    before, held, surface = divided(name, cell, turn)
    after, n = nuclei(held), normals(surface, before[cell])
    t = direction(surface, basal_of_mother(name, cell), turn)
    t -= (t @ n) * n  # where the nucleus is beside its basal point
    t /= np.linalg.norm(t)
    assert len(after) == len(before) + 1
    np.testing.assert_allclose(after[cell], before[cell] - OFFSET * t, rtol=0, atol=1e-14)
    np.testing.assert_allclose(after[-1], before[cell] + OFFSET * t, rtol=0, atol=1e-14)
    assert min(abs(OFFSET * t)) > 1e-3 or name != "cylinder"
    np.testing.assert_array_equal(np.delete(after[:-1], cell, axis=0), np.delete(before, cell, axis=0))


@pytest.mark.parametrize("name", SURFACES)
def test_the_nuclei_of_daughters_are_apart_along_the_surface(name):
    """Twice the offset apart, their middle where the mother was, at right angles to the normal there."""
    for cell in (11, 37, 60):
        before, held, surface = divided(name, cell, 0.3)
        mother, daughter = nuclei(held)[[cell, -1]]
        np.testing.assert_allclose((mother + daughter) / 2, before[cell], rtol=0, atol=1e-14)
        assert np.linalg.norm(daughter - mother) == pytest.approx(2 * OFFSET, rel=1e-12)
        assert abs((daughter - mother) @ normals(surface, before[cell])) < 1e-14
