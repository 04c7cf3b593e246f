"""Division of cells (section 2.2.5), and what position based dynamics makes of two daughters in nearly one place."""

import numpy as np
import pytest
from scipy import stats

from tests.tissue import kernel_calls as kernels
from tests.tissue.kernel_calls import STILL, both
from tests.tissue.states import layers, tissue
from tests.twins.tissue.state import Tissue

ALWAYS = STILL._replace(two_daughters=1.0)
RARE = 1e-3
POINTS = ("x", "y", "ax", "ay", "bx", "by")


def row(n, due=(), network=None, **fields):
    """Cells 3 apart, age 0 and cycle 12, but those ``due`` of age 12 and in mitosis."""
    place = 3.0 * np.arange(n)
    points = (np.column_stack((place + shift, np.full(n, y))) for shift, y in ((0.0, 5.0), (0.1, 8.0), (0.2, 0.0)))
    birth, radius = np.zeros(n), np.full(n, 1 / 3)
    birth[list(due)], radius[list(due)] = -12.0, 0.7
    given = {"cycle": 12.0, "birth": birth, "radius": radius, "rest_aa": 0.1 * (1 + np.arange(n)), **fields}
    return Tissue(tissue(*points, **given), layers(n) if network is None else network, n)


def divided(model, state, given_numbers=ALWAYS, t=0.0, seed=0):
    return model.apply_rules(state, t, given_numbers, *kernels.generators(seed))


@both
def test_one_daughter_takes_the_place_of_the_mother(model):
    state = row(3, due=[1], id=[5, 7, 9])._replace(next_id=10)
    after = divided(model, state, ALWAYS._replace(two_daughters=0.0, g2_stiffening=2.0))
    draws = kernels.generators(0)[0]
    draws.random()  # whether there are two
    expected = state.cells._replace(
        birth=np.zeros(3), radius=np.full(3, 1 / 3), cycle=np.array([12.0, 10.0 + 11.0 * draws.random(), 12.0])
    )
    for name, found, wanted in zip(expected._fields, after.cells, expected, strict=True):
        np.testing.assert_array_equal(found, wanted, err_msg=name)
    assert after.next_id == 10
    assert [layer.tolist() for layer in after.layers] == [[0, 1, 2], [0, 1, 2]]


@both
def test_two_daughters(model):
    state = row(3, due=[1], id=[5, 7, 9], rest_ax=[1.0, 2.0, 3.0], moves=[True, False, True])._replace(next_id=10)
    after = divided(model, state, t=0.5)
    draws = kernels.generators(0)[0]
    draws.random()
    cycles = [10.0 + 11.0 * draws.random() for _ in range(2)]
    twice = [0, 1, 1, 2]
    expected = type(state.cells)(*(array[..., twice] for array in state.cells))
    for name in ("x", "ax", "bx"):
        getattr(expected, name)[1:3] += (-0.01, 0.01)
    expected.birth[1:3], expected.radius[1:3], expected.cycle[1:3] = 0.5, 1 / 3, cycles
    expected.rest_aa[1] = 1 / 3  # the new junction; that to the right neighbour goes to the right daughter
    expected.id[2], expected.mother[2] = 10, 7
    for name, found, wanted in zip(expected._fields, after.cells, expected, strict=True):
        np.testing.assert_array_equal(found, wanted, err_msg=name)
    assert after.next_id == 11
    assert [layer.tolist() for layer in after.layers] == [[0, 1, 2, 3], [0, 1, 2, 3]]


@both
@pytest.mark.parametrize(
    ("due", "ids"),
    [
        ([0], [0, 4, 1, 2, 3]),
        ([3], [0, 1, 2, 3, 4]),
        ([0, 3], [0, 4, 1, 2, 3, 5]),
        ([1, 2], [0, 1, 4, 2, 5, 3]),
        ([0, 1, 2, 3], [0, 4, 1, 5, 2, 6, 3, 7]),
    ],
)
def test_a_second_daughter_stands_behind_the_first(model, due, ids):
    cells, network, next_id, _ = divided(model, row(4, due))
    assert cells.id.tolist() == ids
    assert next_id == 4 + len(due)
    assert [cells.id[i - 1] for i, mother in enumerate(cells.mother) if mother >= 0] == due
    assert all(layer.tolist() == list(range(len(ids))) for layer in network)
    assert (np.diff(cells.x) > 0).all()


@both
def test_daughters_of_cells_that_left_a_layer_are_not_in_it_either(model):
    network = layers(4, apical=[0, 2, 3], basal=[1, 2])
    cells, network, *_ = divided(model, row(4, [0, 1, 2, 3], network))
    assert cells.id.tolist() == [0, 4, 1, 5, 2, 6, 3, 7]
    assert cells.id[network.apical].tolist() == [0, 4, 2, 6, 3, 7]
    assert cells.id[network.basal].tolist() == [1, 5, 2, 6]


@both
def test_basal_points_of_daughters_stay_on_the_line_or_off_it(model):
    state = row(2, [0, 1], layers(2, basal=[0]))
    cells, network, *_ = divided(model, state)
    moved = model.make_substeps(cells, network, ALWAYS._replace(max_basal_distance=9.0), None)
    assert (moved.by[:2] == 0.0).all()
    assert (moved.by[2:] != 0.0).all()


@both
def test_a_cell_that_may_not_divide_draws_no_number_for_it(model):
    state = row(2, due=[0, 1], divides=[False, True])
    cells = divided(model, state).cells
    draws = kernels.generators(0)[0]
    first = 10.0 + 11.0 * draws.random()
    draws.random()
    assert cells.id.tolist() == [0, 1, 2]
    assert cells.cycle.tolist() == [first, *(10.0 + 11.0 * draws.random() for _ in range(2))]
    assert cells.divides.tolist() == [False, True, True]


@both
@pytest.mark.parametrize("probability", [0.2, 0.5])
def test_two_daughters_come_with_their_probability(model, probability):
    n = 1000
    given_numbers = ALWAYS._replace(two_daughters=probability)
    born = len(divided(model, row(n, range(n)), given_numbers, seed=3).cells.x) - n
    assert stats.binomtest(born, n, probability).pvalue > RARE


# Right after a division the daughters overlap by nearly two radii: the state is not feasible, and no step makes it so
# gently, however short it is. In runs of 30 h of both presets (6 seeds, 254 divisions) the first substep brought most
# pairs to 2 R_hard and the worst to 0.79 of it; at the end of the dt the worst was at 0.95.


@both
@pytest.mark.parametrize("h", [1e-3, 1e-6])
def test_the_first_sweep_throws_daughters_that_are_alone_apart(model, h):
    """Each goes R_hard - offset to its side, to the distance 2 R_hard, however short the substep is."""
    cells, network, *_ = divided(model, row(1, due=[0]))
    moved = model.make_substeps(cells, network, ALWAYS._replace(substeps=1, dt=h), None)
    assert np.hypot(*np.diff((moved.x, moved.y))) == pytest.approx(2 / 3, rel=1e-14)
    np.testing.assert_allclose(np.abs(moved.x - cells.x), 1 / 3 - 0.01, rtol=20 * h)
    np.testing.assert_allclose(moved.y, cells.y, rtol=20 * h)
