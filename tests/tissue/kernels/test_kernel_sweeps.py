"""Sweeps of the kernels equal their plain twins bit for bit: no contact is overlooked."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.tissue import kernel_calls as kernels
from tests.tissue.kernel_calls import heap
from tests.tissue.states import cells, layers, numbers, tissue
from tests.twins.tissue import steps as twins
from tests.twins.tissue.state import Tissue
from tissue.kernels import advance, sweeps

seeds = st.integers(0, 2**32 - 1)


@given(seeds, st.integers(1, 30), st.floats(0.3, 8.0), st.sampled_from(["square", "column", "row", "two heaps"]))
def test_sweep_of_heaps_overlooks_no_contact(seed, n, size, kind):
    rng = np.random.default_rng(seed)
    kept = kernels.held(Tissue(heap(rng, n, size, kind), layers(n), n))
    for _ in range(3):
        expected = twins.separate(*(getattr(kept.cells, name)[:n] for name in ("x", "y", "radius")))
        assert kernels.separate(kept)
        np.testing.assert_array_equal((kept.cells.x[:n], kept.cells.y[:n]), expected)


@pytest.mark.parametrize("n", [2, 9, 30])
def test_sweep_stays_in_its_arrays(n):
    """Run by Python, which sees an index beyond the end of an array, in a store without room to spare."""
    kept = kernels.held(Tissue(heap(np.random.default_rng(n), n, 0.6, "square"), layers(n), n), n)
    expected = twins.separate(*(getattr(kept.cells, name)[:n] for name in ("x", "y", "radius")))
    sweeps.refresh(kept.cells, n, kept.scratch)
    assert sweeps.separate.py_func(kept.cells, n, kept.scratch)
    np.testing.assert_array_equal((kept.cells.x[:n], kept.cells.y[:n]), expected)


@settings(max_examples=40)
@given(seeds, st.sampled_from([1, 2, 7, 8, 9, 60, 200]), st.floats(0.0, 3.0))
def test_sweep_after_nuclei_ran(seed, n, speed):
    """The lists made for one state serve, or are made again, after all nuclei have moved as they please."""
    rng = np.random.default_rng(seed)
    kept = kernels.held(Tissue(cells(n, seed % 100), layers(n), n))
    for _ in range(3):
        expected = twins.separate(*(getattr(kept.cells, name)[:n] for name in ("x", "y", "radius")))
        assert kernels.separate(kept)
        np.testing.assert_array_equal((kept.cells.x[:n], kept.cells.y[:n]), expected)
        kept.cells.x[:n] += speed * rng.uniform(-1.0, 1.0, n) * (rng.uniform(size=n) < 0.2)
        kept.cells.y[:n] += speed * rng.uniform(-0.3, 0.3, n)


@pytest.mark.parametrize("n", [2, 9, 60])
def test_sweep_after_discs_grew(n):
    """All cells enter mitosis at once: discs that were out of reach of each other overlap."""
    state = Tissue(cells(n, 1, radius=0.05, birth=0.0, cycle=10.0), layers(n), n)
    given_numbers = numbers(hard_radius=0.05, enlarged_radius=0.7, variance=0.0)
    kept = kernels.held(state)
    assert kernels.separate(kept)
    advance.apply_rules(kept, 9.6, given_numbers, *kernels.generators(0))
    grown = kernels.taken(kept).cells
    assert (grown.radius == 0.7).all()
    assert kernels.separate(kept)
    moved = kernels.taken(kept).cells
    np.testing.assert_array_equal((moved.x, moved.y), twins.separate(grown.x, grown.y, grown.radius))
    assert n == 2 or not np.array_equal(moved.x, grown.x)


@given(seeds, st.integers(1, 40), st.floats(0.05, 1.0))
def test_basal_sweeps(seed, n, largest):
    rng = np.random.default_rng(seed)
    state = cells(n, 0)._replace(bx=np.cumsum(rng.normal(0.3, 0.5, n)))
    network = layers(n, basal=np.flatnonzero(rng.uniform(size=n) < 0.8))
    expected = twins.swept(state._replace(radius=0.0 * state.radius), network, numbers(max_basal=largest)).bx
    np.testing.assert_array_equal(kernels.order_basal(state, network, largest), expected)


def test_sweep_after_a_division():
    """The second daughter comes where the lists had nobody, to a place that they take for where it was."""
    kept = kernels.held(Tissue(tissue([(0.1, 0.1)], [(0.0, 8.0)], [(0.0, 0.0)], birth=-15.0), layers(1), 1))
    assert kernels.separate(kept)
    advance.apply_rules(kept, 0.0, numbers(two_daughters=1.0, variance=0.0), *kernels.generators(0))
    assert kernels.separate(kept)
    np.testing.assert_allclose(kept.cells.x[:2], (0.1 - 1 / 3, 0.1 + 1 / 3), rtol=1e-14)
