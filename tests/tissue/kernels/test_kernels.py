"""The kernels of the tissue equal their plain twins: noise and events bit for bit, forces to rounding."""

import numpy as np
import pytest

from tests.tissue import kernel_calls as kernels
from tests.tissue.kernel_calls import SUBSTEP, aged, compared, distance, freed, same_events, with_emt
from tests.tissue.states import cells, layers, numbers, tissue
from tests.twins.tissue import steps as twins
from tissue.files.parameters import preset

SIZES = (1, 2, 7, 8, 9, 60, 200)
each_preset = pytest.mark.parametrize("name", ["thesis", "published"])
each_size = pytest.mark.parametrize("n", SIZES)


# Forces: one substep in which no discs touch


def assert_equal_substep(state, network, given_numbers):
    """Also that it moves something, unless there is nothing that could act."""
    made = kernels.make_substeps(state, network, given_numbers, None)
    expected = twins.make_substeps(state, network, given_numbers, None)
    assert distance(made, expected) < SUBSTEP
    return distance(made, state)


@each_size
@pytest.mark.parametrize("power", [1, 2])
@pytest.mark.parametrize("network", [layers, freed])
def test_forces(n, power, network):
    for seed in range(3):
        state = cells(n, seed, radius=0.0)
        assert assert_equal_substep(state, network(n), numbers(substeps=1, dt=0.005, spring_power=power)) > 1e-3


@each_size
@pytest.mark.parametrize("only", ["stiff_ax", "stiff_bx", "stiff_axb", "stiff_aa", "repulsion"])
def test_each_force_alone(n, only):
    off = {name: 0.0 for name in ("stiff_ax", "stiff_bx", "stiff_axb", "stiff_aa") if name != only}
    given_numbers = numbers(substeps=1, dt=0.005, repulsion=float(only == "repulsion"))
    moved = assert_equal_substep(cells(n, 4, radius=0.0, **off), layers(n), given_numbers)
    assert n <= 2 or moved > 1e-4


@pytest.mark.parametrize("distance_of_centres", [1.999, 2.0, 2.001, 1e-3])
def test_repulsion_at_the_ends_of_its_range(distance_of_centres):
    x = [(0.0, 4.0), (distance_of_centres, 4.0)]
    state = tissue(x, [(0.0, 8.0), (0.0, 8.0)], [(0.0, 0.0), (0.0, 0.0)], radius=0.0, rest_ax=3.0, rest_bx=3.0)
    given_numbers = numbers(substeps=1, dt=0.005, junction_factor=0.0)
    state = state._replace(ax=np.array([0.0, 1.0]), bx=np.array([0.0, 0.3]))
    assert assert_equal_substep(state, layers(2), given_numbers) > 1e-3


# Rules


@each_size
@each_preset
@pytest.mark.parametrize("network", [layers, freed])
def test_rules(n, name, network):
    given_numbers = preset(name).numbers()._replace(two_daughters=0.7)
    for seed in range(3):
        state = aged(n, seed, network, moves=np.arange(n) % 3 > 0, divides=np.arange(n) % 4 > 0)
        a, b = state, state
        draws = kernels.generators(seed), kernels.generators(seed)
        for k in range(12):
            a = kernels.apply_rules(a, 0.25 * k, given_numbers, *draws[0])
            b = twins.apply_rules(b, 0.25 * k, given_numbers, *draws[1])
            assert same_events(a, b)
            assert a.next_id == b.next_id
            assert distance(a.cells, b.cells) == 0.0
            for rest in ("rest_ax", "rest_bx", "rest_aa"):
                np.testing.assert_allclose(getattr(a.cells, rest), getattr(b.cells, rest), rtol=0, atol=1e-14)
    assert n < 60 or a.next_id > n


# Whole steps


@pytest.mark.parametrize("n", [1, 9, 30])
@each_preset
def test_ten_steps(n, name):
    """Divisions, mitosis and contacts that come and go."""
    state = aged(n, 3, freed)
    state.cells.birth[n // 2] = 0.22 - state.cells.cycle[n // 2]
    given_numbers = preset(name).numbers()._replace(two_daughters=1.0)
    assert compared(state, given_numbers, 10, seed=2).next_id > n


@each_preset
def test_noise_in_substeps(name):
    given_numbers = preset(name).numbers()._replace(noise_in_substeps=True, variance=2.0)
    compared(aged(25, 6), given_numbers, 2)


@pytest.mark.parametrize("largest", [2.0, 5.0])
def test_a_cap_of_rest_lengths(largest):
    state = with_emt(aged(20, 3), [9, 10], a=0.15, b=0.25, p=0.35)
    compared(state, numbers(max_cytoskeleton=largest), 6)
