"""Lemma 2.8 as measured limits."""

import numpy as np
import pytest

from dincl.geometry import normal_cone
from verification.instruments.order import estimate
from verification.thesis.chapter1 import consistency

ALONE = ["one contact", "two contacts, orthogonal"]
TOGETHER = ["two contacts, oblique", "wedge of two walls", "twelve contacts, redundant"]


@pytest.fixture(scope="module")
def steps():
    return consistency.single_steps()


@pytest.fixture(scope="module")
def settled():
    return consistency.settling()


def at_finest(steps, name):
    mine = steps[steps["configuration"] == name]
    return mine.loc[mine["dt"].idxmin()]


@pytest.mark.slow_with("inclusion-one contact")
@pytest.mark.parametrize("name", ["one contact", "two contacts, orthogonal", "two contacts, oblique", TOGETHER[2]])
@pytest.mark.parametrize("quantity", ["inclusion", "sweep"])
def test_one_step_tends_to_an_element_of_the_inclusion_to_first_order(name, quantity, steps):
    mine = steps[steps["configuration"] == name]
    assert estimate(mine["dt"], mine[quantity]).slope == pytest.approx(1.0, abs=0.05)
    assert mine[quantity].min() < 4e-4


def test_flat_walls_have_no_error_but_rounding(steps):
    mine = steps[steps["configuration"] == "wedge of two walls"]
    assert mine[["inclusion", "sweep"]].to_numpy().max() < 1e-14


@pytest.mark.parametrize("name", ALONE)
def test_contacts_alone_or_orthogonal_give_the_slow_velocity(name, steps):
    mine = steps[steps["configuration"] == name]
    assert estimate(mine["dt"], mine["tangent"]).slope == pytest.approx(1.0, abs=0.05)
    assert at_finest(steps, name)["outside"] < 1e-4


@pytest.mark.parametrize("name", TOGETHER)
def test_one_sweep_over_several_contacts_does_not(name, steps):
    """The limit is neither the slow velocity nor even tangent."""
    finest = at_finest(steps, name)
    assert finest["tangent"] > 0.2
    assert finest["outside"] > 0.2
    assert finest["inclusion"] < 1e-4


def test_many_sweeps_do_not_always_find_the_slow_velocity(steps):
    assert at_finest(steps, "two contacts, oblique")["many"] < 1e-3
    assert at_finest(steps, "twelve contacts, redundant")["many"] > 0.2


@pytest.mark.parametrize("name", ALONE + TOGETHER)
def test_the_sequence_settles_to_the_slow_velocity(name, settled):
    mine = settled[settled["configuration"] == name].sort_values("step")
    assert mine["tangent"].iloc[-1] < 1e-4
    if name in TOGETHER:
        assert mine["tangent"].iloc[0] > 0.2


def test_reaction_stays_in_the_lemma_with_a_smaller_ball(steps):
    """sigma(V - F, w) <= sigma(-N in the ball of radius 2 |F|, w): what Definition 2.7 should ask for."""
    assert steps["excess"].max() <= 0
    assert steps["reaction"].max() <= 2


def test_wedge_by_hand():
    """F = (-1, -1/5); wall 1 leaves (-1, 0), wall 2 turns that along n = (sin 1, -cos 1)."""
    problem = consistency.configurations()["wedge of two walls"]
    gradients = normal_cone(problem, 0.0, problem.x0, 1e-9).generators
    normal = np.array([np.sin(1.0), -np.cos(1.0)])
    by_hand = np.array([[-1.0, 0.0]]) + np.sin(1.0) * normal
    assert consistency.tangent_sweep(gradients, problem.velocity(0.0, problem.x0)) == pytest.approx(by_hand)


def test_summary_has_the_orders(steps, settled):
    table = consistency.summary(steps, settled).set_index("configuration")
    assert table.loc["wedge of two walls", "inclusion_order"] == "exact"
    assert table.loc["two contacts, oblique", "inclusion_order"].startswith("1.00 [")
    assert table.loc["twelve contacts, redundant", "contacts"] == 12
    assert table["settled"].max() < 1e-4
