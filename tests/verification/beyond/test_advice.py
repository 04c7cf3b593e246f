"""The page "Which method should I take?" is what its generator makes of the tables that ship."""

import numpy as np
import pandas as pd
import pytest

from verification.beyond.chart import advice


@pytest.mark.slow
def test_the_page_is_the_one_that_the_kept_tables_give():
    """Otherwise: python -m verification.beyond.chart.advice."""
    assert advice.page() == advice.PAGE.read_text("utf-8")


def test_a_tie_counts_for_each_method_and_what_is_not_reached_for_none():
    rows = pd.DataFrame(
        [
            {"target": 1e-2, "tied": "a; b", "pbd_ratio": 2.0},
            {"target": 1e-2, "tied": "b", "pbd_ratio": np.nan},
            {"target": 1e-2, "tied": "", "pbd_ratio": np.nan},
            {"target": 1e-4, "tied": "a", "pbd_ratio": np.nan},
        ]
    )
    coarse, fine = advice.by_error(rows)
    assert (coarse["target"], coarse["best"], coarse["count"], coarse["reached"]) == (1e-2, ["b"], 2, 2)
    assert (coarse["pbd"], coarse["times"]) == (1, 2.0)
    assert (fine["best"], fine["pbd"], np.isnan(fine["times"])) == (["a"], 0, True)


def test_many_discs_take_the_finest_error_that_is_decided():
    rows = pd.DataFrame(
        [
            {"scene": advice.MANY, "target": 1e-2, "cheapest": "a", "tied": "a", "cost": 1.0},
            {"scene": advice.MANY, "target": 1e-3, "cheapest": "tie", "tied": "b; a", "cost": 2.0},
            {"scene": advice.MANY, "target": 1e-4, "cheapest": "at the limit", "tied": "a", "cost": 3.0},
        ]
    )
    assert advice.many(rows) == {"methods": ["a", "b"], "target": 1e-3, "cost": 2.0}
