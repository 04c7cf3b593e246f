"""Stores of running tissues: they grow without a trace, and say when a step cannot be made."""

import numpy as np
import pytest

from tests.tissue import kernel_calls as kernels
from tests.tissue.kernel_calls import COORDINATES, aged, distance, heap, same_events
from tests.tissue.states import layers, numbers
from tests.twins.tissue.state import Tissue
from tissue.files.parameters import preset
from tissue.kernels import advance, store, substeps
from tissue.kernels.neighbours import LOST

each_preset = pytest.mark.parametrize("name", ["thesis", "published"])


def in_pieces(state, given_numbers, capacity, wanted):
    """As many steps as asked for, in a store that grows when it has to; how often it grew."""
    kept, made, times = kernels.held(state, capacity), 0, 0
    draws = kernels.generators(1)
    while True:
        made, end = advance.advance(kept, made, wanted, given_numbers, *draws)
        if end != advance.FULL:
            assert end == advance.DONE
            return kernels.taken(kept), times
        kept, times = store.grown(kept), times + 1


@each_preset
def test_growing_store_loses_nothing(name):
    given_numbers = preset(name).numbers()._replace(two_daughters=1.0, min_cycle=1.0, max_cycle=3.0, dt=0.1)
    small, times = in_pieces(aged(6, 0), given_numbers, 6, 60)
    large, none = in_pieces(aged(6, 0), given_numbers, 600, 60)
    assert times >= 2
    assert none == 0
    assert same_events(small, large)
    assert small.next_id == large.next_id == len(small.cells.id)


def test_room_changes_nothing_but_rounding():
    """A store may grow when no cell divides in two: its lists are made anew, and forces added up in another order."""
    given_numbers = preset("published").numbers()
    for seed in range(4):
        state = aged(40, seed)
        (small, times), (large, _) = (in_pieces(state, given_numbers, capacity, 30) for capacity in (40, 400))
        assert times > 0
        assert same_events(small, large)
        assert distance(small.cells, large.cells) < 1e-9


def test_full_store_stops_before_the_step():
    """No room for a daughter that may come: nothing is changed, and nothing drawn."""
    state = aged(8, 0, divides=False)
    state.cells.birth[3] = -state.cells.cycle[3]
    kept, draws = kernels.held(state, 8), kernels.generators(0)
    before = [generator.bit_generator.state for generator in draws]
    assert advance.advance(kept, 0, 5, numbers(), *draws) == (0, advance.FULL)
    assert all(np.array_equal(a, b) for a, b in zip(kernels.taken(kept).cells, state.cells, strict=True))
    assert [generator.bit_generator.state for generator in draws] == before


@pytest.mark.parametrize("where", [0.9 * LOST, 1.1 * LOST, 1e3 * LOST, 1e30, np.inf, np.nan])
def test_nuclei_far_out_are_lost(where):
    """Lists are made within bounds only: nothing is looked for behind the end of an array."""
    kept = kernels.held(aged(60, 0), 60)
    kept.cells.x[:60] += where
    assert kernels.separate(kept) == (where < LOST)


def test_cells_on_top_of_each_other_are_crowded():
    n = 200
    rng = np.random.default_rng(0)
    kept = kernels.held(Tissue(heap(rng, n, 0.5, "square"), layers(n), n))
    assert not substeps.make_substeps(kept, numbers())
    assert advance.advance(kept, 0, 1, numbers(variance=0.0), rng, rng) == (0, advance.CROWDED)


def test_who_is_lost_is_found():
    state = aged(5, 0)
    for name in COORDINATES:
        for bad in (np.nan, np.inf, -LOST):
            kept = kernels.held(state)
            assert advance.find_lost(kept.cells, 5) == -1
            getattr(kept.cells, name)[3] = bad
            assert advance.find_lost(kept.cells, 5) == 3
            assert advance.find_lost(kept.cells, 3) == -1
