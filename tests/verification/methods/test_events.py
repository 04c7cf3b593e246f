"""Midpoint catch-up across events of a pile: order 2 where a contact begins or ends alone, order 1 where two depend."""

import numpy as np
import pytest

import dincl
from verification.methods.chart import events
from verification.site.store import shipped


def test_events_of_a_pile_of_ten():
    """One contact of the 21 events of this pile ends another one."""
    pile = events.solved(events.FEW)
    assert len(pile.t) == 20
    assert pile.coupled.sum() == 1
    around = np.column_stack((pile.t - pile.room, pile.t, pile.t + 2 * pile.room)).ravel()
    assert (np.diff(around) > 0).all()
    exact = dincl.solve(pile.scene, dincl.EventDriven(1e-9), pile.t + 2 * pile.room)
    assert np.abs(exact.x - pile.behind).max() < 1e-9


def test_smallest_runs_have_the_order_of_their_event():
    rows = events.local_study(smallest=True).rows()
    found = events.orders(rows).dropna()
    assert found.loc[found["coupled"], "order"].to_numpy() == pytest.approx([1.0], abs=0.05)
    assert found.loc[~found["coupled"], "order"].to_numpy() == pytest.approx(2.0, abs=0.05)
    assert set(rows) == set(shipped("events_local"))


@pytest.mark.slow
def test_adaptive_steps_keep_to_their_tolerance_and_equal_ones_do_not_fall_with_order_two():
    rows = events.study(smallest=True).rows()
    assert set(rows) == set(shipped("events"))
    worst = shipped("events").query("discs == 100").groupby(["method", "setting"])["error"].max()
    steps = worst["midpoint_active"].sort_index(ascending=False)
    slopes = np.diff(np.log(steps)) / np.diff(np.log(steps.index))
    assert (slopes < 1.7).all()
    adaptive = worst["adaptive"]
    assert (adaptive <= 10 * adaptive.index).all()


def test_shipped_orders_are_two_and_one():
    orders = events.orders(shipped("events_local"))
    found = events.summary(orders[orders["discs"] == events.MANY]).set_index("coupled")
    assert found.loc["alone", ["low", "high"]].tolist() == pytest.approx([2.0, 2.0], abs=0.02)
    assert found.loc["coupled", "median"] == pytest.approx(1.0, abs=0.02)
