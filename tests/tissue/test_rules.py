"""The rules of sections 2.2.1 to 2.2.4 on single cells, worked out by hand; kernels and twins alike."""

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from tests.tissue import kernel_calls as kernels
from tests.tissue.kernel_calls import STILL, both, upright
from tests.tissue.states import layers, tissue
from tests.twins.tissue import steps as twins
from tests.twins.tissue.state import Tissue
from tissue.events.known import bit, settled
from tissue.state.cells import emt_cells

# With fixed seeds a test either passes always or never; a sound one fails for one seed in a thousand.
RARE = 1e-3
FAST = 1e6  # rates at which rest lengths arrive within a dt


def ruled(model, state, t, given_numbers=STILL, seed=0):
    """The cells after the rules of one time."""
    return model.apply_rules(state, t, given_numbers, *kernels.generators(seed)).cells


# 2.2.1 Cell cycle and age


@both
def test_cycles_are_uniform(model):
    n = 4000
    cells = ruled(model, upright(n, birth=-12.0), 0.0)
    assert (cells.birth == 0.0).all()
    assert stats.kstest(cells.cycle, stats.uniform(10.0, 11.0).cdf).pvalue > RARE
    assert 10.0 <= cells.cycle.min() < 10.02
    assert 20.98 < cells.cycle.max() < 21.0


@both
def test_phases_begin_to_the_step(model):
    """Age 11.25 begins G2, 11.5 mitosis, 12 division, in steps of 1/8 h; junctions stiffen, the disc grows."""
    given_numbers = STILL._replace(dt=0.125, g2=0.25, mitosis=0.5, g2_stiffening=3.0)
    state, seen = upright(birth=-10.75), []
    for k in range(12):
        cells = ruled(model, state, 0.125 * k, given_numbers)
        seen.append((cells.stiff_aa[0], cells.radius[0], cells.birth[0]))
        state = state._replace(cells=cells)
    resting, late, mitotic = (5.0, 1 / 3, -10.75), (15.0, 1 / 3, -10.75), (15.0, 0.7, -10.75)
    assert seen == [resting] * 4 + [late] * 2 + [mitotic] * 4 + [(5.0, 1 / 3, 1.25)] * 2


@given(st.floats(-21.0, 0.0), st.floats(10.0, 21.0), st.sampled_from([0.1, 0.05, 0.3]))
def test_division_is_the_first_step_of_sufficient_age(birth, cycle, dt):
    """In numbers without rounding; where they say that the age is reached exactly, rounding may decide."""
    exact = (Fraction(birth) + Fraction(cycle)) / Fraction(dt)
    first = max(math.ceil(exact), 0)
    if abs(exact - round(exact)) < 1e-9:
        return
    for k in (first - 1, first):
        if k >= 0:
            for model in (kernels, twins):
                cells = ruled(model, upright(birth=birth, cycle=cycle), k * dt)
                assert cells.birth[0] == (k * dt if k == first else birth)


@both
def test_times_are_whole_multiples_of_dt(model):
    """t_k = k dt, not the sum of k steps, which would be 0.1 h ten times = 0.9999999999999999 h."""
    state = upright(birth=-11.0)
    end = model.steps(state, 0, 15, STILL, *kernels.generators(0)).cells
    assert end.birth[0] == 10 * 0.1 == 1.0


# 2.2.2, 2.2.3 Rest lengths and interkinetic nuclear movement


@both
@pytest.mark.parametrize("age", [0.0, 10.9])
def test_rest_lengths_follow_the_present_extension(model, age):
    """|X - A| = 5 and |X - B| = 13 of a bent cell, each less R_soft."""
    points = [[0.0, 5.0]], [[3.0, 9.0]], [[12.0, 0.0]]
    state = Tissue(tissue(*points, birth=-age, cycle=12.0), layers(1), 1)
    cells = ruled(model, state, 0.0, STILL._replace(rate_ax=FAST, rate_bx=FAST))
    assert (cells.rest_ax[0], cells.rest_bx[0]) == (4.0, 12.0)


@both
@pytest.mark.parametrize("age", [11.0, 11.9])
def test_from_g2_on_the_springs_rest_with_the_nucleus_at_the_apical_side(model, age):
    """eta_ax = 0 and eta_bx = |A - B| - 2 of a bent cell with |A - B| = 13; not without INM."""
    points = [[0.0, 5.0]], [[4.0, 12.0]], [[9.0, 0.0]]
    state = Tissue(tissue(*points, birth=-age, cycle=12.0), layers(1), 1)
    rates = STILL._replace(rate_ax=FAST, rate_bx=FAST)
    cells = ruled(model, state, 0.0, rates)
    assert (cells.rest_ax[0], cells.rest_bx[0]) == (0.0, 11.0)
    resting = ruled(model, state._replace(cells=state.cells._replace(moves=np.array([False]))), 0.0, rates)
    np.testing.assert_allclose(
        (resting.rest_ax[0], resting.rest_bx[0]), (math.hypot(4, 7) - 1, math.hypot(9, 5) - 1), rtol=1e-15
    )


@both
@pytest.mark.parametrize(("floor", "wanted"), [(False, (-0.75, -0.25)), (True, (0.0, 0.0))])
def test_floor_of_rest_lengths(model, floor, wanted):
    """A cell of height 1: the nucleus is nearer than R_soft to both ends."""
    state = upright(height=1.0, nucleus=0.75)
    cells = ruled(model, state, 0.0, STILL._replace(rate_ax=FAST, rate_bx=FAST, floor_rest_length=floor))
    assert (cells.rest_ax[0], cells.rest_bx[0]) == wanted
    cells = ruled(model, state, 11.5, STILL._replace(rate_ax=FAST, rate_bx=FAST, floor_rest_length=floor))
    assert (cells.rest_ax[0], cells.rest_bx[0]) == (0.0, 0.0 if floor else -1.0)


# A cap on the cytoskeleton: |X - A| = 5 and |X - B| = 13 of a bent cell want 4 and 12


@both
@pytest.mark.parametrize(
    ("largest", "age", "events", "wanted"),
    [
        (math.inf, 0.0, 0, (4.0, 12.0)),
        (16.0, 0.0, 0, (4.0, 12.0)),
        (4.0, 0.0, 0, (1.0, 3.0)),
        (4.0, 11.5, 0, (0.0, 4.0)),
        (6.0, 0.0, bit("a"), (0.0, 6.0)),
        (2.0, 0.0, bit("b"), (2.0, 0.0)),
        (6.0, 0.0, bit("b"), (4.0, 0.0)),
        (1.0, 0.0, bit("a") | bit("b"), (0.0, 0.0)),
    ],
)
def test_a_cap_scales_what_both_springs_want(model, largest, age, events, wanted):
    """In G2 they want 0 and |A - B| - 2 > 4; the spring to a point that is free wants 0, and counts as 0."""
    points = [[0.0, 5.0]], [[3.0, 9.0]], [[12.0, 0.0]]
    at = {name: np.array([0.0 if events & bit(name) else np.inf]) for name in "ab"}
    cells = tissue(*points, birth=-age, cycle=12.0, events=events, emt=0)
    state = Tissue(cells, layers(1), 1, emt_cells(settled(at)))
    cells = ruled(model, state, 0.0, STILL._replace(rate_ax=FAST, rate_bx=FAST, max_cytoskeleton=largest))
    assert (cells.rest_ax[0], cells.rest_bx[0]) == pytest.approx(wanted, rel=1e-15)


@both
def test_a_capped_cell_is_an_elastic_spring(model):
    """Height 20, all points held: in place of 18 the rest lengths end at 3 in all, parted as the springs are long."""
    state = upright(height=20.0, nucleus=8.0)
    given_numbers = STILL._replace(rate_ax=5.0, rate_bx=5.0, max_cytoskeleton=3.0)
    for k in range(60):
        state = state._replace(cells=ruled(model, state, 0.1 * k, given_numbers))
        assert state.cells.rest_ax[0] + state.cells.rest_bx[0] <= 3.0 + 1e-14
    assert state.cells.rest_ax[0] + state.cells.rest_bx[0] == pytest.approx(3.0, rel=1e-12)
    assert state.cells.rest_ax[0] == pytest.approx(3.0 * 11.0 / 18.0, rel=1e-12)


@both
def test_rest_lengths_relax_exponentially(model):
    """eta(t) = eta* + (eta(0) - eta*) exp(-k t) with eta*: 2 apical, 4 basal, whatever the steps are."""
    for dt, count in ((0.1, 6), (0.3, 2), (0.6, 1)):
        state = upright()
        for k in range(count):
            given_numbers = STILL._replace(dt=dt, rate_ax=5.0, rate_bx=0.5, rate_aa=1.0)
            state = state._replace(cells=ruled(model, state, dt * k, given_numbers))
        found = [getattr(state.cells, name)[0] for name in ("rest_ax", "rest_bx", "rest_aa")]
        expected = (2 - 0.5 * math.exp(-3.0), 4 - 2.5 * math.exp(-0.3), math.exp(-0.6) / 3)
        np.testing.assert_allclose(found, expected, rtol=1e-14)


@both
@pytest.mark.parametrize(
    ("moving", "variant", "at_rest", "in_g2", "in_mitosis"),
    [
        (True, {}, (1 / 3, 5.0), (1 / 3, 5.0), (0.7, 5.0)),
        (True, {"enlarge_in_g2": True}, (1 / 3, 5.0), (0.7, 5.0), (0.7, 5.0)),
        (True, {"g2_stiffening": 2.0}, (1 / 3, 5.0), (1 / 3, 10.0), (0.7, 10.0)),
        (False, {"resting_cells_enlarge": True, "g2_stiffening": 2.0}, (1 / 3, 5.0), (1 / 3, 10.0), (0.7, 10.0)),
        (False, {"resting_cells_enlarge": False, "g2_stiffening": 2.0}, (1 / 3, 5.0), (1 / 3, 5.0), (1 / 3, 5.0)),
        (False, {"resting_cells_enlarge": True, "enlarge_in_g2": True}, (1 / 3, 5.0), (0.7, 5.0), (0.7, 5.0)),
        (False, {"resting_cells_enlarge": False, "enlarge_in_g2": True}, (1 / 3, 5.0), (1 / 3, 5.0), (1 / 3, 5.0)),
    ],
)
def test_radius_and_stiffness_by_phase(model, moving, variant, at_rest, in_g2, in_mitosis):
    for age, expected in ((10.9, at_rest), (11.0, in_g2), (11.4, in_g2), (11.5, in_mitosis), (11.9, in_mitosis)):
        state = upright(birth=-age, moves=moving)
        cells = ruled(model, state, 0.0, STILL._replace(**variant))
        assert (cells.radius[0], cells.stiff_aa[0]) == expected
        assert (cells.stiff_ax[0], cells.stiff_bx[0], cells.stiff_axb[0]) == (2.0, 2.0, 15.0)


# 2.2.4 Apical junctions


@both
def test_rules_leave_alone_what_they_do_not_mention(model):
    state = upright(3, birth=-5.0)
    cells = ruled(model, state, 0.0, STILL._replace(rate_aa=1.0))
    for name, after, before in zip(cells._fields, cells, state.cells, strict=True):
        np.testing.assert_array_equal(after, before * math.exp(-0.1) if name == "rest_aa" else before, err_msg=name)
