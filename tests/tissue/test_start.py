"""The first state of a tissue: where its points are, how old its cells are, and that no hard discs overlap."""

import numpy as np
import pytest
from scipy import stats

import dincl
from tissue.files.parameters import preset
from tissue.runs.start import first_state
from tissue.state.numbers import StartNumbers
from tissue.state.running import contents

RARE = 1e-3
TOUCHING = 1e-10
THESIS = preset("thesis").start_numbers()
WIDE = THESIS._replace(
    cells=1500, width=100.0, nuclei_low=2.0, nuclei_high=7.0, apical_spacing=0.25, basal_spacing=0.2, new_junction=0.7
)
POINTS = (
    preset("thesis").numbers()._replace(hard_radius=0.0, enlarged_radius=0.0)
)  # nuclei without extent stay as drawn
each_preset = pytest.mark.parametrize("name", ["thesis", "published"])


def started(start, numbers, seed=0):
    """The cells and the layers."""
    return contents(first_state(start, numbers, np.random.default_rng(seed)))


def largest_overlap(cells):
    """max R_i + R_j - |X_i - X_j| over all pairs."""
    i, j = np.triu_indices(len(cells.x), 1)
    return (cells.radius[i] + cells.radius[j] - np.hypot(cells.x[i] - cells.x[j], cells.y[i] - cells.y[j])).max()


@pytest.mark.parametrize("nuclei", ["box", "even", "own_basal"])
def test_layers_are_straight_even_and_centred(nuclei):
    cells, layers = started(WIDE._replace(nuclei=nuclei), POINTS)
    place = np.arange(1500) - 749.5
    np.testing.assert_allclose(cells.ax, 0.25 * place, rtol=1e-14)
    np.testing.assert_allclose(cells.bx, 0.2 * place, rtol=1e-14)
    assert (cells.ay == 8.0).all()
    assert (cells.by == 0.0).all()
    assert [layer.tolist() for layer in layers] == [list(range(1500))] * 2
    assert cells.id.tolist() == list(range(1500))
    assert (cells.mother == -1).all()
    assert cells.moves.all()
    assert cells.divides.all()


@pytest.mark.parametrize("nuclei", ["box", "even", "own_basal"])
def test_heights_of_nuclei_are_uniform(nuclei):
    cells, _ = started(WIDE._replace(nuclei=nuclei), POINTS)
    assert stats.kstest(cells.y, stats.uniform(2.0, 5.0).cdf).pvalue > RARE


def test_nuclei_anywhere_in_the_box_in_the_order_of_the_cells():
    cells, _ = started(WIDE._replace(nuclei="box"), POINTS)
    assert stats.kstest(cells.x, stats.uniform(-50.0, 100.0).cdf).pvalue > RARE
    assert (np.diff(cells.x) > 0).all()
    assert stats.pearsonr(cells.x, cells.y).pvalue > RARE


def test_nuclei_near_even_places():
    """x = step (i + 1) - width / 2 + U(-step, step), step = width / (cells + 1)."""
    cells, _ = started(WIDE._replace(nuclei="even"), POINTS)
    step = 100.0 / 1501
    shift = cells.x - (step * np.arange(1, 1501) - 50.0)
    assert stats.kstest(shift / step, stats.uniform(-1.0, 2.0).cdf).pvalue > RARE


def test_nuclei_above_their_basal_points():
    cells, _ = started(WIDE._replace(nuclei="own_basal"), POINTS)
    np.testing.assert_array_equal(cells.x, cells.bx)


@each_preset
def test_ages_are_uniform_on_the_own_cycle(name):
    numbers = preset(name).numbers()
    cells, _ = started(WIDE, numbers._replace(hard_radius=0.0, enlarged_radius=0.0))
    assert stats.kstest(cells.cycle, stats.uniform(10.0, 11.0).cdf).pvalue > RARE
    assert stats.kstest(-cells.birth / cells.cycle, stats.uniform(0.0, 1.0).cdf).pvalue > RARE
    assert stats.pearsonr(cells.cycle, cells.birth / cells.cycle).pvalue > RARE


@each_preset
@pytest.mark.parametrize("from_g2", [False, True])
def test_cells_begin_in_the_phase_of_their_age(name, from_g2):
    numbers = preset(name).numbers()._replace(enlarge_in_g2=from_g2, g2_stiffening=3.0, g2=0.8, mitosis=0.5)
    cells, _ = started(WIDE._replace(cells=400), numbers)
    left = cells.birth + cells.cycle
    enlarged = left <= (1.3 if from_g2 else 0.5)
    assert 5 < enlarged.sum() < 60
    np.testing.assert_array_equal(cells.radius, np.where(enlarged, 0.7, numbers.hard_radius))
    np.testing.assert_array_equal(cells.stiff_aa, np.where(left <= 1.3, 15.0, 5.0))
    assert (cells.stiff_ax == 2.0).all()


@each_preset
@pytest.mark.parametrize("nuclei", ["box", "even", "own_basal"])
def test_no_hard_discs_overlap(name, nuclei):
    parameters = preset(name).changed({"start.nuclei": nuclei})
    for seed in range(20):
        cells, _ = started(parameters.start_numbers(), parameters.numbers(), seed)
        assert largest_overlap(cells) <= TOUCHING
        assert (np.diff(cells.bx) <= parameters.numbers().max_basal_distance + 1e-12).all()


def test_overlapping_discs_part_as_little_as_they_must():
    """Two discs of 1/3 drawn 0.2 apart at one height: one sweep moves each by (2/3 - 0.2) / 2."""
    start = StartNumbers(2, 8.0, 10.0, 0.3, 0.2, "own_basal", 3.0, 3.0, 1.5, 0.3)
    cells, _ = started(start, preset("thesis").numbers(), 1)
    assert (cells.radius == 1 / 3).all()
    np.testing.assert_allclose(cells.x, [-1 / 3, 1 / 3], rtol=1e-14)


def test_more_cells_than_fit():
    start = THESIS._replace(cells=60, nuclei="own_basal", basal_spacing=0.0, nuclei_low=3.0, nuclei_high=3.0)
    with pytest.raises(dincl.InvalidProblem, match=r"tissue\.cells = 60: more than fit"):
        started(start, preset("thesis").numbers())
