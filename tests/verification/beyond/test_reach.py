"""How far the event-driven scheme pays: the error from which on it is the cheapest, and one pile measured anew."""

import pandas as pd
import pytest

from verification.beyond.chart import reach
from verification.instruments.budget import CpuSeconds
from verification.thesis.chapter2.methods import EVENT_DRIVEN, MIDPOINT_ACTIVE

OWN, OTHER = EVENT_DRIVEN.label, MIDPOINT_ACTIVE.label


def rows(discs: int, winners: dict[float, str]) -> pd.DataFrame:
    return pd.DataFrame([{"discs": discs, "target": target, "cheapest": won} for target, won in winners.items()])


def test_it_is_the_cheapest_from_where_nobody_is_cheaper_at_any_finer_error():
    some = rows(10, {1e-2: OWN, 1e-3: OTHER, 1e-4: OWN, 1e-6: OWN})
    never = rows(20, {1e-2: OWN, 1e-4: "tie"})
    found = reach.first(pd.concat([some, never]))
    assert found.loc[0, "target"] == 1e-4
    assert found["target"].isna().tolist() == [False, True]


@pytest.mark.slow
def test_a_pile_of_ten_comes_out_as_kept():
    """Who is the cheapest is told at an error that no other method reaches within this budget."""
    kept, anew = reach.table(), reach.measure(reach.DISCS[0], CpuSeconds(0.1))
    mine = kept[kept["discs"] == reach.DISCS[0]].reset_index(drop=True)
    assert (anew["events"] == mine["events"]).all()
    fine = anew["target"] <= 1e-8
    assert (anew.loc[fine, "cheapest"] == OWN).all()
    assert (mine.loc[fine, "cheapest"] == OWN).all()


def test_the_page_says_what_is_kept():
    said = reach.said()["said"]
    for discs in reach.DISCS:
        assert f" {discs}" in said
