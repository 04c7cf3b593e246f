"""Curved layers: the study comes out again, and its page says what its table says."""

import pytest

from tests.executors import Here
from verification.site.context import Context
from verification.site.store import DATA, shipped
from verification.tissues import curved
from verification.tissues.studies import STUDIES


def test_ways_out_are_counted_with_their_intervals():
    table = shipped(curved.NAME)
    assert len(table) == 2 * len(curved.study().runs) == 2 * 6 * len(curved.LAYERS)
    assert ((table["low"] <= table["value"]) & (table["value"] <= table["high"])).all()
    assert table["value"].to_numpy() == pytest.approx((table["count"] / table["of"]).to_numpy())


def test_curvature_matters_as_the_page_says():
    table = shipped(curved.NAME).query("side == 'basal'").set_index(["events", "layer"])
    of_a = table.loc["[A]"]
    assert of_a.loc["inside", "low"] > 2 * of_a.loc["line", "high"]
    assert of_a.loc["outside", "high"] < 0.7 * of_a.loc["line", "low"]
    assert (table.loc["[BP]", "low"] > 0.5).all()


@pytest.mark.slow
def test_the_page_is_drawn(tmp_path):
    context = Context(tmp_path, False, Here(), STUDIES, complete=DATA)
    curved.run(context)
    curved.show(context)
    context.finish_drawings()
    assert {path.name for path in (tmp_path / "figures").iterdir()} == {"curved_ways_out.png", "curved_tissues.png"}
