"""Apical constriction [AC]: cells leave the apical layer as chains of their own; kernels and twins alike."""

from itertools import pairwise

import numpy as np
import pytest

from dincl.errors import InvalidProblem
from tests.tissue import kernel_calls as kernels
from tests.tissue.kernel_calls import STILL, aged, both, compared, upright, with_emt
from tissue.events.known import bit, settled
from tissue.files.parameters import load, preset
from tissue.runs.compiled_rules import rules_pointer
from tissue.runs.simulate import simulate
from tissue.state.basal_curve import curve_numbers, ellipse
from tissue.state.cells import emt_cells
from tissue.state.numbers import numbers_pointer
from tissue.step.advance import apply_rules
from verification.thesis.quasi_steady.frozen import frozen_problem

NEVER = np.inf
GROUP = {"cells": 4, "place": 0.8, "ac": "1 h to 9 h"}


def ruled(model, state, t, given=STILL):
    """The tissue after the rules of one time."""
    return model.apply_rules(state, t, given, *kernels.generators(0))


def chains(state):
    """The cells of each chain apart from the layer."""
    numbers = state.cells.chain
    return [np.flatnonzero(numbers == number).tolist() for number in sorted(set(numbers.tolist()) - {0})]


def timed(state, cells, **times):
    """EMT cells each with its own times."""
    m = len(cells)
    state.cells.emt[cells], state.cells.divides[cells] = np.arange(m), False
    at = {name: np.array(some, dtype=np.float64) for name, some in times.items()}
    return state._replace(emt=emt_cells(settled(at)))


@both
def test_a_cell_is_cut_out_and_its_neighbours_are_joined(model):
    """At their present distance: 6 apart, one 2.5 higher."""
    state = with_emt(upright(4, rest_aa=[1.5, 0.5, 1.0, 1.0]), [1], ac=0.5)
    state.cells.ay[2] += 2.5
    before, after = ruled(model, state, 0.4), ruled(model, state, 0.5)
    assert before.layers.apical.tolist() == [0, 1, 2, 3]
    assert after.layers.apical.tolist() == [0, 2, 3]
    assert after.layers.basal.tolist() == [0, 1, 2, 3]
    assert after.cells.events.tolist() == [0, bit("ac"), 0, 0]
    assert after.cells.rest_aa[[0, 2]].tolist() == [6.5, 1.0]
    assert chains(after) == [[1]]
    assert (after.cells.stiff_ax == state.cells.stiff_ax).all()


@both
@pytest.mark.parametrize(
    ("cells", "times", "layer", "found"),
    [
        ([1, 2, 3], [0.5, 0.5, 0.5], [0, 4, 5], [[1, 2, 3]]),
        ([1, 3, 4], [0.5, 0.5, 0.5], [0, 2, 5], [[1], [3, 4]]),
        ([1, 2], [0.2, 0.5], [0, 3, 4, 5], [[1], [2]]),
        ([1, 2, 3], [0.5, 0.2, 0.5], [0, 4, 5], [[1, 3], [2]]),
        ([0, 1], [0.5, 0.5], [2, 3, 4, 5], [[0, 1]]),
        ([4, 5], [0.5, 0.5], [0, 1, 2, 3], [[4, 5]]),
    ],
)
def test_those_that_constrict_together_stay_together(model, cells, times, layer, found):
    """Only junctions to others are cut, of the layer as it is then; at the ends nothing is joined."""
    rest = np.arange(6) + 0.25
    state = timed(upright(6, rest_aa=rest), cells, ac=times)
    for t in (0.2, 0.5):
        state = ruled(model, state, t)
    assert state.layers.apical.tolist() == layer
    assert chains(state) == found
    inner = [i for chain in found for i in chain[:-1] if i + 1 in chain]
    assert state.cells.rest_aa[inner].tolist() == rest[inner].tolist()
    gaps = [(a, b) for a, b in pairwise(layer) if b > a + 1]
    assert [state.cells.rest_aa[a] for a, _ in gaps] == [3.0 * (b - a) for a, b in gaps]


@pytest.mark.parametrize("cells", [[0, 1, 2], [4, 5, 6], [9, 10, 11]])
def test_a_gap_in_a_ring_is_closed_wherever_it_is(cells):
    """At its beginning, too, the neighbours are joined, and those that constrict together are one chain."""
    curve, along = ellipse(36.0, 1.0, inside=False, ring=True), 3.0 * np.arange(12) - 16.5
    state = with_emt(upright(12, rest_aa=0.5), cells, ac=0.0)
    points = (curve.above(along, np.full(12, height)) for height in (4.0, 8.0, 0.0))
    (x, y), (ax, ay), (bx, by) = points
    state = state._replace(cells=state.cells._replace(x=x, y=y, ax=ax, ay=ay, bx=bx, by=by, along=along))
    held = kernels.held(state, curve=curve_numbers(curve))
    rules = rules_pointer([held])
    apply_rules(held, 0.0, numbers_pointer(STILL), rules, *kernels.generators(0))
    after = kernels.taken(held)
    left, right = (cells[0] - 1) % 12, (cells[-1] + 1) % 12
    assert chains(after) == [cells]
    assert after.cells.rest_aa[left] == pytest.approx(np.hypot(ax[right] - ax[left], ay[right] - ay[left]), rel=1e-15)
    assert (np.delete(after.cells.rest_aa, left) == 0.5).all()


@both
def test_a_chain_pulls_itself_together(model):
    """Two upright cells 3 apart, their junction at rest at 1: the first substep, without other forces on A."""
    given = STILL._replace(substeps=1, junction_factor=0.5)
    state = with_emt(upright(4, rest_aa=1.0, stiff_axb=0.0, rest_ax=2.0), [1, 2], ac=0.0)
    state = ruled(model, state, 0.0, given)
    moved = model.make_substeps(state.cells, state.layers, given, None)
    step = given.dt / given.mu * 0.5 * 5.0 * (3.0 - 1.0)
    np.testing.assert_allclose(moved.ax[1:3], [3.0 + step, 6.0 - step], rtol=1e-13)
    np.testing.assert_allclose(moved.ax[[0, 3]], [0.0, 9.0], atol=1e-13)  # their junction is as long as they are apart


@both
def test_a_daughter_belongs_to_the_chain_of_its_mother(model):
    """Cells of the EMT do not divide; what is let divide splits within its chain, by a junction as any other's."""
    state = with_emt(upright(4, rest_aa=0.5), [1, 2], ac=0.0)
    state = ruled(model, state, 0.0)
    state.cells.divides[1], state.cells.birth[1] = True, -20.0
    after = ruled(model, state, 0.1, STILL._replace(two_daughters=1.0))
    assert chains(after) == [[1, 2, 3]]
    assert after.layers.apical.tolist() == [0, 4]
    assert after.cells.rest_aa[[1, 2]].tolist() == [STILL.new_junction, 0.5]


@both
@pytest.mark.parametrize(("present", "rest"), [(False, 1.0), (True, 6.0)])
def test_loss_of_adhesion_takes_a_cell_out_of_its_chain(model, present, rest):
    """[A] after [AC]: its neighbours in the chain are joined, as in the layer; [AC] after [A] has nothing to cut."""
    given = STILL._replace(bridge_present=present, freed_stiffness=0.1)
    state = timed(upright(5, rest_aa=0.5), [1, 2, 3], ac=[0.0] * 3, a=[NEVER, 0.1, NEVER])
    state = ruled(model, ruled(model, state, 0.0, given), 0.1, given)
    assert chains(state) == [[1, 3]]
    assert state.layers.apical.tolist() == [0, 4]
    assert state.cells.rest_aa[1] == rest
    assert state.cells.stiff_ax[2] == pytest.approx(0.2, rel=1e-15)
    free = timed(upright(4, rest_aa=0.5), [1], ac=[0.1], a=[0.0])
    free = ruled(model, ruled(model, free, 0.0), 0.1)
    assert chains(free) == []
    assert free.cells.rest_aa[0] == 1.0


def constricting(n, seed):
    """A random tissue with eight EMT cells in the middle, most of which constrict, some at once."""
    state = aged(n, seed)
    middle, rng = np.arange((n - 8) // 2, (n - 8) // 2 + 8), np.random.default_rng(seed)
    times = rng.choice([0.15, 0.35, 0.55, NEVER], 8, p=[0.4, 0.3, 0.1, 0.2])
    some = np.where(rng.random(8) < 0.3, rng.uniform(0.1, 0.9, 8), NEVER)
    return timed(state, middle, ac=times, a=some, b=some[::-1])


@pytest.mark.parametrize("name", ["thesis", "published"])
def test_a_crowd_by_kernels_and_by_twins(name):
    given = preset(name).numbers()._replace(two_daughters=0.7)
    end = compared(constricting(30, 3), given, 12)
    assert max(map(len, chains(end))) > 1
    assert len(chains(end)) > 1


def test_a_group_constricts(tmp_path):
    """From a file: the group's apical points come together, and the layer closes above them."""
    file = tmp_path / "constricting.toml"
    file.write_text('base = "published"\nemt = {cells = 6, ac = "2 h"}\nnumerics.t_end = "6 h"\n', "utf-8")
    run = simulate(load(file), seed=2)
    group = run.final.cells.emt >= 0
    assert set(run.table().query("emt >= 0 and time_h >= 2")["events"]) == {"AC"}
    assert chains(run.final) == [np.flatnonzero(group).tolist()]
    before = run.frames[1].cells
    assert np.ptp(run.final.cells.ax[group]) < 0.7 * np.ptp(before.ax[before.emt >= 0])
    assert not np.isin(np.flatnonzero(group), run.final.layers.apical).any()
    with pytest.raises(InvalidProblem, match=r"cells.chain\[\d+\] = \d+: must be 0, the energy has"):
        frozen_problem(run.final.cells, run.final.layers, run.parameters.numbers())
