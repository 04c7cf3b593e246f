"""Sweeps of the kernels equal their plain twins bit for bit, alone and in company: no contact is overlooked."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.tissue import kernel_calls as kernels
from tests.tissue.kernel_calls import HEAPS, heap
from tests.tissue.states import cells, layers, numbers
from tests.twins.tissue import steps as twins
from tests.twins.tissue.state import Tissue
from tissue.kernels.workspace import Workspaces
from tissue.model.discs import separate_all
from tissue.state.basal_curve import curve_numbers, ellipse
from tissue.state.running import STRAIGHT

seeds = st.integers(0, 2**32 - 1)
CIRCLE = curve_numbers(ellipse(60.0, 1.0, inside=True, ring=True))


def assert_swept(states, given_numbers):
    """Nuclei and basal points; what the twins make of each."""
    for state, found in zip(states, kernels.swept(states, given_numbers), strict=True):
        expected = twins.swept(state.cells, state.layers, given_numbers)
        for name in kernels.COORDINATES:
            np.testing.assert_array_equal(getattr(found, name), getattr(expected, name))


@pytest.mark.slow
@settings(max_examples=100)
@given(seeds, st.floats(0.3, 8.0), st.sampled_from(HEAPS), st.sampled_from([1, 8]), st.booleans())
def test_sweeps_of_heaps_overlook_no_contact(seed, size, kind, width, bent):
    """Discs on top of each other are pushed far, in some tissues and in others not; by windows and by boxes."""
    rng = np.random.default_rng(seed)
    states = [Tissue(heap(rng, n, size, kind), layers(n), n) for n in (40, 5, 30, 33, 20, 12, 1, 25)[:width]]
    swept = kernels.swept(states, numbers(), CIRCLE if bent else STRAIGHT)
    for state, one in zip(states, swept, strict=True):
        x, y = twins.separate(state.cells.x, state.cells.y, state.cells.radius)
        np.testing.assert_array_equal((one.x, one.y), (x, y))


@pytest.mark.parametrize("n", [2, 9, 30])
def test_sweep_stays_in_its_arrays(n):
    """What lies behind the last cell is not looked at, and stays."""
    state = heap(np.random.default_rng(n), n, 0.6, "square")
    workspaces = Workspaces(n + 1, 1, [[numbers()]], np.zeros(1), STRAIGHT)
    work = workspaces.flat.value
    lines = {name: line for name, line in work._asdict().items() if getattr(line, "shape", None) == work.x.shape}
    for line in lines.values():
        line.view(np.float64)[:] = np.nan
    work.x[:n], work.y[:n], work.radius[:n], work.counts[:] = state.x, state.y, state.radius, 0.0
    assert separate_all(workspaces.flat.address, workspaces.wide.address, n, 0.0, 1) == -1
    np.testing.assert_array_equal((work.x[:n], work.y[:n]), twins.separate(state.x, state.y, state.radius))
    assert len(lines) > 30
    for name, line in lines.items():
        assert np.isnan(line[n:].view(np.float64)).all(), name


def test_a_nucleus_that_many_push_a_little_meets_one_that_was_far():
    """Three to its left push the first one by a seventh each; the last one was farther than is looked at."""
    state = cells(5, 1)
    state.radius[:] = [0.8, 0.1, 0.1, 0.1, 0.5]
    x, y = -0.11, 0.0
    state.x[0], state.y[0], state.x[4], state.y[4] = x, y, x + 0.8 + 0.5 + 0.32, 0.0
    for i, angle in enumerate(np.radians([40, -40, 0]), start=1):
        state.x[i], state.y[i] = x - 0.62 * np.cos(angle), y - 0.62 * np.sin(angle)
        x, y = x + 0.14 * np.cos(angle), y + 0.14 * np.sin(angle)
    found = kernels.swept([Tissue(state, layers(5), 5)], numbers())[0]
    np.testing.assert_array_equal((found.x, found.y), twins.separate(state.x, state.y, state.radius))
    assert found.x[4] > state.x[4]


@pytest.mark.slow
@given(seeds, st.floats(0.05, 1.0))
def test_basal_sweeps(seed, largest):
    """Alone and side by side, where cells have left the layer, one or all of them."""
    rng = np.random.default_rng(seed)
    states = []
    for n, share in zip((1, 40, 17, 2, 3, 9, 12, 30), (0.8, 0.8, 0.5, 1.0, 1.0, 0.0, 0.1, 0.8), strict=True):
        state = cells(n, 0, radius=0.0)._replace(bx=np.cumsum(rng.normal(0.3, 0.5, n)))
        states.append(Tissue(state, layers(n, basal=np.flatnonzero(rng.uniform(size=n) < share)), n))
    assert_swept(states, numbers(max_basal_distance=largest))
    for state in states:
        assert_swept([state], numbers(max_basal_distance=largest))
