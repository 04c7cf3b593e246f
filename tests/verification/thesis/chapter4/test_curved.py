"""Curved layers: what is kept, and what the chapter says of it."""

import pandas as pd
import pytest

from verification.page.prose import fill
from verification.thesis.chapter4 import curved, page_curved


def test_ways_out_are_counted_with_their_intervals():
    table = curved.table("ways_out")
    assert (table["low"] <= table["value"]).all()
    assert (table["value"] <= table["high"]).all()
    assert table["value"].to_numpy() == pytest.approx((table["count"] / table["of"]).to_numpy())
    assert set(table["layer"]) == set(curved.LAYERS)
    assert len(table) == 2 * 6 * 3


def test_curvature_matters_on_both_sides():
    table = curved.table("ways_out").query("events == '[A]' and side == 'basal'").set_index("layer")
    assert table.loc["inside", "low"] > 2 * table.loc["line", "high"]
    assert table.loc["outside", "high"] < 0.7 * table.loc["line", "low"]


def test_large_circles_become_the_line():
    """At the last doubling of the perimeter the distance halves, or nearly so."""
    table = curved.table("limit")
    for _, rows in table.groupby("side"):
        assert 1.5 < page_curved.rate(rows) < 2.5
        assert rows["away_um"].abs().iloc[-1] < 0.01 * rows["line_um"].iloc[-1]


def test_rate_is_that_of_the_last_doubling():
    rows = pd.DataFrame({"perimeter_um": [4, 1, 2], "away_um": [-1.0, 9.0, -2.0]})
    assert page_curved.rate(rows) == 2.0


def test_the_page_says_what_is_kept():
    one = (0.5, 0.4, 0.6)
    three = dict.fromkeys(curved.LAYERS, one)
    row = next(curved.table("limit").tail(1).itertuples())
    said = fill(
        page_curved.PROSE / "curved.html", of=7, a=three, bp=three, rates=[("inside", 2.0)], largest=9, last=[row]
    )
    assert "50 % [40, 60]" in said["answer"]
    assert "At 9 µm it is off by" in said["limit"]
