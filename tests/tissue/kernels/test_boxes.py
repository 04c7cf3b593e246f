"""On a bent layer blocks of cells are compared by boxes: discs in a row touch across the ends of blocks alone."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.tissue import kernel_calls as kernels
from tests.tissue.kernel_calls import HEAPS, heap
from tests.tissue.states import cells, layers, numbers
from tests.twins.tissue import steps as twins
from tests.twins.tissue.state import Tissue
from tissue.runs.group import Group
from tissue.state.basal_curve import curve_numbers, ellipse
from tissue.state.running import STRAIGHT

RING = curve_numbers(ellipse(60.0, 1.0, inside=True, ring=True))
GIVEN = numbers()


def row(n, angle):
    """Discs that overlap the next one by a tenth of their diameter, and no other."""
    state, along = cells(n, 0), 0.9 * 2 * GIVEN.hard_radius * np.arange(n)
    return state._replace(x=along * np.cos(angle), y=along * np.sin(angle), radius=np.full(n, GIVEN.hard_radius))


@pytest.mark.parametrize("width", [1, 8])
@pytest.mark.parametrize("angle", np.arange(8) * np.pi / 4)
def test_the_ends_of_blocks_overlook_no_contact(angle, width):
    found = [Tissue(row(n, angle), layers(n), n) for n in (40, 17, 33, 25, 9, 16, 2, 24)[:width]]
    for state, one in zip(found, kernels.swept(found, GIVEN, RING), strict=True):
        expected = twins.separate(state.cells.x, state.cells.y, state.cells.radius)
        np.testing.assert_array_equal([one.x, one.y], expected)
        assert len(one.x) < 3 or np.abs(one.x - state.cells.x).max() + np.abs(one.y - state.cells.y).max() > 0.01


@pytest.mark.parametrize("curve", [RING, STRAIGHT], ids=["ring", "straight"])
@pytest.mark.parametrize("width", [1, 8])
def test_the_pairs_that_are_looked_at_are_counted(width, curve):
    """Those that are near, at most all; in a company they are those of the widest window of all."""
    n = 160
    group = Group([kernels.held(Tissue(row(n, 0.0), layers(n), n), curve=curve) for _ in range(width)], GIVEN)
    assert group.make_substeps()
    assert n - 1 <= group.pairs / GIVEN.substeps < n * (n - 1) / 4


@settings(max_examples=60)
@given(st.integers(0, 2**32 - 1), st.floats(0.3, 8.0), st.sampled_from(HEAPS), st.sampled_from([1, 8]))
def test_boxes_overlook_no_contact(seed, size, kind, width):
    """Of a bent layer blocks are compared: nuclei in any order, alone and in company."""
    rng = np.random.default_rng(seed)
    found = [Tissue(heap(rng, n, size, kind), layers(n), n) for n in (40, 5, 30, 33, 20, 12, 1, 25)[:width]]
    for state, one in zip(found, kernels.swept(found, numbers(), RING), strict=True):
        x, y = twins.separate(state.cells.x, state.cells.y, state.cells.radius)
        np.testing.assert_array_equal([one.x, one.y], [x, y])
