"""The EMT events on tissues made by hand (section 2.2 of chapter 4); kernels and twins alike."""

import math

import numpy as np
import pytest

from tests.tissue import kernel_calls as kernels
from tests.tissue.kernel_calls import STILL, aged, both, compared, upright, with_emt
from tests.tissue.states import layers
from tissue.events.known import bit, row, settled
from tissue.files.parameters import preset
from tissue.state.cells import emt_cells

NEVER = math.inf
RELAX = STILL._replace(rate_ax=5.0, rate_bx=2.0, rate_aa=1.0)
PUBLISHED = RELAX._replace(
    freed_stiffness=0.1, bent_stiffness=1.0, spring_gives=True, contraction=1 / 3, forced_below=True
)
# What rounding of a long way of many cells may amount to.
ROUNDING = 1e-9


def ruled(model, state, t, given_numbers=RELAX):
    """The tissue after the rules of one time."""
    return model.apply_rules(state, t, given_numbers, *kernels.generators(0))


# Loss of apical adhesion [A]


@both
@pytest.mark.parametrize(
    ("cell", "left", "junctions"), [(1, [0, 2], (2.0, 0.25, 1.0)), (0, [1, 2], None), (2, [0, 1], None)]
)
def test_a_leaves_the_apical_layer(model, cell, left, junctions):
    """Its neighbours are joined by a junction as long as both before; at the end of the layer nothing is put in."""
    state = with_emt(upright(3, rest_aa=[1.5, 0.5, 1.0]), [cell], a=0.5)
    before, after = ruled(model, state, 0.4, STILL), ruled(model, state, 0.5, STILL)
    assert before.layers.apical.tolist() == [0, 1, 2]
    assert after.layers.apical.tolist() == left
    assert after.layers.basal.tolist() == [0, 1, 2]
    assert after.cells.events.tolist() == [bit("a") * (i == cell) for i in range(3)]
    first = after.cells.rest_aa[left[0]]
    assert first == (2.0 if cell == 1 else state.cells.rest_aa[left[0]])


@both
def test_a_may_be_bridged_at_the_present_distance(model):
    state = with_emt(upright(3), [1], a=0.0)
    state.cells.ay[2] += 2.5
    after = ruled(model, state, 0.0, STILL._replace(bridge_present=True))
    assert after.cells.rest_aa[0] == pytest.approx(6.5, rel=1e-15)  # sqrt(6^2 + 2.5^2)


@both
def test_a_contracts_the_apical_spring(model):
    """eta_ax* = 0 for ever, so eta = 1.5 exp(-5 t), in G2, too; (3.3) goes on."""
    state = with_emt(upright(3, birth=-10.8), [1], a=0.0)
    for k in range(6):
        state = ruled(model, state, 0.1 * k)
    assert state.cells.rest_ax[1] == pytest.approx(1.5 * math.exp(-5 * 0.6), rel=1e-14)
    expected = upright(3, birth=-10.8)
    for k in range(6):
        expected = ruled(model, expected, 0.1 * k)
    assert state.cells.rest_bx[1] == expected.cells.rest_bx[1]
    assert state.cells.rest_ax[0] == expected.cells.rest_ax[0]


@both
def test_a_weakens_the_freed_spring_in_the_published_runs(model):
    """A tenth of alpha_ax, once and not again and again, in G2, too, which doubles what only the layer has."""
    state = with_emt(upright(2, birth=-10.95), [0], a=0.0)
    given = PUBLISHED._replace(g2_stiffening=2.0)
    seen = []
    for k in range(3):
        state = ruled(model, state, 0.1 * k, given)
        seen.append((state.cells.stiff_ax.tolist(), state.cells.stiff_aa.tolist()))
    assert seen == [([0.2, 2.0], [5.0, 5.0]), ([0.2, 2.0], [10.0, 10.0]), ([0.2, 2.0], [10.0, 10.0])]


# Loss of basal adhesion [B]


@both
def test_b_leaves_the_basal_layer(model):
    """The basal point is free in both directions, its spring contracts, (C2) holds for the neighbours."""
    state = with_emt(upright(3, spacing=1.0), [1], b=0.0)
    after = ruled(model, state, 0.0)
    assert after.layers.basal.tolist() == [0, 2]
    assert after.layers.apical.tolist() == [0, 1, 2]
    assert after.cells.rest_bx[1] == pytest.approx(1.5 * math.exp(-0.2), rel=1e-14)
    assert after.cells.rest_ax[1] == ruled(model, upright(3), 0.0).cells.rest_ax[1]
    moved = model.make_substeps(after.cells, after.layers, RELAX, None)
    assert moved.by[1] > 0.1
    assert moved.by[[0, 2]].tolist() == [0.0, 0.0]
    assert moved.bx[2] - moved.bx[0] < 1.0  # they were 2 apart, 1/3 is allowed


# Loss of straightness [S]


# Protrusive activity, [P]


@both
def test_p_waits_for_b(model):
    state = with_emt(upright(2), [0], b=0.5, p=0.2)
    assert state.emt.at[row("p")].tolist() == [0.5]
    assert ruled(model, state, 0.4).cells.events.tolist() == [0, 0]
    assert ruled(model, state, 0.5).cells.events.tolist() == [bit("b") + bit("p"), 0]


def free(y_b, x_b=0.0):
    """One cell whose basal point is free, at (x_b, y_b), its nucleus at (0, 5), beside one far away."""
    state = with_emt(upright(2, spacing=50.0), [0], b=0.0, p=0.0)
    state.cells.bx[0], state.cells.by[0] = x_b, y_b
    return state._replace(layers=layers(2, basal=[1]))


def steps_of(model, state, given, count=1):
    return model.steps(state, 0, count, given, *kernels.generators(0))


@both
def test_p_runs_away_from_the_nucleus_at_its_speed(model):
    """(4.1): from (1.5, 3) along (1.5, -2)/2.5 by 0.3 in 0.1 h, while the nucleus has no force but bending."""
    given = STILL._replace(run_speed=3.0)
    state = free(3.0, 1.5)
    state.cells.stiff_axb[0], state.cells.stiff_ax[0] = 0.0, 0.0
    end = steps_of(model, state, given._replace(alpha_ax=0.0)).cells
    assert (end.x[0], end.y[0]) == (0.0, 5.0)
    np.testing.assert_allclose((end.bx[0], end.by[0]), (1.5 + 0.3 * 0.6, 3.0 - 0.3 * 0.8), rtol=1e-12)


@both
def test_p_has_no_force_above_the_line_and_contracts_below(model):
    """eta = d - 1 with no stiffness for y(B) > 0, eta = 0 at once for y(B) <= 0."""
    above, below = (ruled(model, free(y), 0.0).cells for y in (0.5, -0.5))
    assert (above.stiff_bx[0], above.rest_bx[0]) == (0.0, 3.5)
    assert (below.stiff_bx[0], below.rest_bx[0]) == (2.0, 0.0)


@both
def test_p_in_the_published_runs(model):
    """Above the line eta grows at the running speed, below it tends to 0 with 3 per hour."""
    above, below = (ruled(model, free(y), 0.0, PUBLISHED).cells for y in (0.5, -0.5))
    assert (above.stiff_bx[0], above.rest_bx[0]) == (0.2, pytest.approx(1.6, rel=1e-14))
    assert (below.stiff_bx[0], below.rest_bx[0]) == (0.2, pytest.approx(1.5 * math.exp(-0.3), rel=1e-14))


@both
@pytest.mark.parametrize(("given", "way"), [(STILL, 0.0), (PUBLISHED, 0.1)])
def test_p_at_its_depth(model, given, way):
    """At y(B) <= -2 the point stays for good, or is pulled back by the spring."""
    given = given._replace(junction_factor=0.0)  # so that the cell stays upright
    end = steps_of(model, free(-2.0), given).cells
    assert end.bx[0] == 0.0
    assert end.by[0] == -2.0 if way == 0.0 else end.by[0] > -2.0 + way
    if way == 0.0:
        assert end.y[0] < 4.9  # the nucleus comes instead
        assert steps_of(model, free(-1.9999), given).cells.by[0] == pytest.approx(-2.0999, abs=1e-10)


# Where the nuclei are


@both
def test_onset_is_measured_before_the_first_event(model):
    """y_AB = 5/8 at the first of [A], [B], [S] (4.8), and not again at the second."""
    state = with_emt(upright(3, spacing=1.0), [1], a=0.1, s=0.2)
    first = ruled(model, state, 0.1)
    assert ruled(model, state, 0.0).emt.onset_ab[0] == math.inf
    assert first.emt.onset_ab[0] == 0.625
    first.cells.y[1] = 1.0
    assert ruled(model, first, 0.2).emt.onset_ab[0] == 0.625


@both
@pytest.mark.parametrize(("height", "side"), [(-0.1, -1), (0.1, 0), (7.9, 0), (8.1, 1)])
def test_sides_are_kept_since_when(model, height, side):
    """An unmoved nucleus is there since the first step, at its x."""
    state = with_emt(upright(3, spacing=2.5, stiff_axb=0.0), [1])
    state.cells.y[1] = height
    frozen = STILL._replace(mu=1e12, alpha_ax=0.0, repulsion=0.0)
    emt = steps_of(model, state, frozen, 3).emt
    assert emt.side.tolist() == [side]
    if side:
        assert (emt.since[0], emt.since_x[0]) == (0.1, pytest.approx(2.5, abs=1e-9))


@both
def test_emt_cells_begin_new_cycles_alone(model):
    """Section 2.2.5: at the end of its cycle an EMT cell does not divide, and its neighbour does."""
    state = with_emt(upright(2, birth=-12.0), [1])
    after = ruled(model, state, 0.0, STILL._replace(two_daughters=1.0))
    assert after.cells.emt.tolist() == [-1, -1, 0]
    assert after.cells.birth.tolist() == [0.0, 0.0, 0.0]


# Kernels against twins


@pytest.mark.parametrize("name", ["thesis", "published"])
def test_all_events_in_a_crowd(name):
    """Cells with different events among others that divide."""
    given = preset(name).numbers()._replace(two_daughters=0.7)
    state = eventful(30, 3)
    end = compared(state, given, 12)
    assert set(end.cells.events[end.cells.emt >= 0].tolist()) == {0, 1, 2, 3, 4, 7, 10, 15}
    made = kernels.steps(state, 0, 12, given, *kernels.generators(0))
    for found, expected in zip(made.emt, end.emt, strict=True):
        np.testing.assert_allclose(found, expected, atol=ROUNDING)


def eventful(n, seed):
    """A random tissue with eight EMT cells in the middle: none, A, B, AB, S, ABS, BP, ABSP."""
    state, middle = aged(n, seed), slice((n - 8) // 2, (n - 8) // 2 + 8)
    chosen = np.array([[0, 1, 0, 1, 0, 1, 0, 1], [0, 0, 1, 1, 0, 1, 1, 1], [0, 0, 0, 0, 1, 1, 0, 1], [0] * 6 + [1, 1]])
    times = np.where(chosen, np.random.default_rng(seed).uniform(0.05, 0.6, (4, 8)), NEVER)
    state.cells.emt[middle], state.cells.divides[middle] = np.arange(8), False
    state.cells.moves[middle] = np.arange(8) % 3 > 0
    return state._replace(emt=emt_cells(settled(dict(zip("absp", times, strict=True)))))
