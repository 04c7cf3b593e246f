"""Curved layers: what is kept, and what the chapter says of it."""

import numpy as np
import pandas as pd
import pytest

from verification.beyond.curved import curved, tubes
from verification.beyond.curved import figures as figures_curved
from verification.beyond.curved import page as page_curved
from verification.page.prose import fill


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
    assert "At 9 µm the difference is" in said["limit"]


def tube_row(events, layer, closed, every=15, side="basal", perimeter=600):
    here = "closed == @closed and perimeter_um == @perimeter and (every == @every or not closed)"
    table = curved.table("tubes").query("events == @events and layer == @layer and side == @side")
    (row,) = table.query(here).itertuples()
    return row


def test_ratios_of_tubes_are_counted_with_their_intervals():
    table = curved.table("tubes")
    assert len(table) == 2 * sum(len(layer.events) for layer in tubes.LAYERS)
    assert (table["failed"] == 0).all()
    assert table["value"].to_numpy() == pytest.approx((table["count"] / table["of"]).to_numpy())
    assert ((table["low"] <= table["value"]) & (table["value"] <= table["high"])).all()
    assert (table["high"] - table["low"]).max() < 0.13


def test_closing_matters_inside_and_hardly_outside():
    assert tube_row("[A]", "inside", True).low > tube_row("[A]", "inside", False).high + 0.1
    arcs = curved.table("ways_out").query("layer == 'outside' and side == 'basal'").set_index("events")
    for events in ("[A]", "[B]", "[AB]", "[BP]"):
        assert abs(tube_row(events, "outside", True, perimeter=400).value - arcs.loc[events, "value"]) < 0.06


def test_emt_cells_that_are_closer_are_not_in_each_others_way():
    near, far = (tube_row("[A]", "outside", True, every, perimeter=400) for every in (15, 30))
    assert near.low < far.high
    assert far.low < near.high


def test_small_lumina_close_and_large_ones_do_not():
    table = curved.table("lumen")
    assert table["value"].is_monotonic_decreasing
    assert table["value"].iloc[0] == 1.0
    assert table["value"].iloc[-1] < 0.2
    assert (table["low"] <= table["value"]).all()
    assert (table["first_h"].dropna() <= table["median_h"].dropna()).all()


def test_emt_cells_of_a_tube_stand_apart_and_never_divide():
    layer = tubes.tube("outside", 400, 30, 1)
    batch = tubes._grown(layer.parameters(**{"emt.a": "1 h", "numerics.t_end": "0.1 h"}), [3])
    cells = batch.frame(0, 0.1).cells
    chosen = np.flatnonzero(cells.emt >= 0)
    assert len(chosen) == len(batch.state(0).emt.side) == layer.emt == 8
    assert set(np.diff(chosen)) <= {30, 31}
    assert not cells.divides[chosen].any()
    assert cells.divides.sum() == layer.cells - layer.emt


def test_intervals_are_wilsons_for_one_cell_and_students_over_runs_for_more():
    one = np.array([[True], [False]] * 50)
    assert tubes._interval(one) == pytest.approx((0.4038, 0.5962), abs=1e-4)
    low, high = tubes._interval(np.array([[True, False], [True, True], [True, False]]))
    assert (low + high) / 2 < 2 / 3 + 1e-12
    assert tubes._interval(np.zeros((4, 3), bool)) == (0.0, 0.0)


def test_labels_of_the_figures(tmp_path):
    labels = [label for label, *_ in figures_curved._closed_or_not(curved.table("ways_out"), curved.table("tubes"))]
    assert len(set(labels)) == len(labels) == 7
    assert not any("," in label for label in (*labels, *figures_curved.TISSUES, *figures_curved.LABELS.values()))
    assert figures_curved.draw_tubes(curved.table("ways_out"), curved.table("tubes"), tmp_path / "x.png").exists()
