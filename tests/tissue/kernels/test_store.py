"""Stores of running tissues: they grow without a trace, and say when a step cannot be made."""

import numpy as np
import pytest

from tests.tissue import kernel_calls as kernels
from tests.tissue.bits import same_cells
from tests.tissue.kernel_calls import aged
from tests.tissue.states import numbers
from tissue.files.parameters import preset
from tissue.kernels.workspace import LOST
from tissue.runs.group import Group
from tissue.step import advance

each_preset = pytest.mark.parametrize("name", ["thesis", "published"])


def grown_to(state, given_numbers, capacity, wanted):
    """The tissue after these steps in a store of this capacity, and the capacity at the end."""
    group = Group([kernels.held(state, capacity)], given_numbers, [kernels.Random(*kernels.generators(1))])
    group.advance(0, wanted)
    return kernels.taken(group.states[0]), len(group.states[0].cells.x)


@each_preset
def test_growing_store_loses_nothing(name):
    given_numbers = preset(name).numbers()._replace(two_daughters=1.0, min_cycle=1.0, max_cycle=3.0, dt=0.1)
    small, room = grown_to(aged(6, 0), given_numbers, 6, 60)
    large, same = grown_to(aged(6, 0), given_numbers, 600, 60)
    assert room >= 24
    assert same == 600
    assert small.next_id == large.next_id
    assert same_cells(small, large)


def test_full_store_stops_before_the_step():
    """No room for a daughter that may come: nothing is changed, and nothing drawn."""
    state = aged(8, 0, divides=False)
    state.cells.birth[3] = -state.cells.cycle[3]
    kept, draws = kernels.held(state, 8), kernels.generators(0)
    before = [generator.bit_generator.state for generator in draws]
    assert Group([kept], numbers(), [kernels.Random(*draws)]).call(0, 5) == (0, advance.FULL)
    assert all(np.array_equal(a, b) for a, b in zip(kernels.taken(kept).cells, state.cells, strict=True))
    assert [generator.bit_generator.state for generator in draws] == before


@pytest.mark.parametrize("where", [0.3 * LOST, 0.4 * LOST, 1e3 * LOST, 1e30, np.inf, np.nan])
def test_cells_far_out_are_lost(where):
    """Of nucleus, apical and basal point, the magnitudes count together."""
    kept = kernels.held(aged(60, 0), 60)
    for points in (kept.cells.x, kept.cells.ax, kept.cells.bx):
        points[:60] += where
    group = Group([kept], numbers(variance=0.0), [kernels.Random(*kernels.generators(0))])
    group.advance(0, 3)
    assert group.ended[0] == (0 if 3 * where < LOST else 1)
