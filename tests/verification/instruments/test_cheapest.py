"""Who is cheapest at which error: interpolation between runs, ties, the limit of a budget, the efficient front."""

import math

import numpy as np
import pandas as pd
import pytest

from verification.instruments.cheapest import cost_of, costs, front, rank, runs_of


def measured(errors, seconds, reference_error=0.0, method="A", **columns):
    count = len(errors)
    return pd.DataFrame(
        {
            "method": method,
            "setting": 0.1 / 2.0 ** np.arange(count),
            "status": ["SUCCESS"] * count,
            "largest": errors,
            "cpu_seconds": seconds,
            "spread": 1.0,
            "reference_error": reference_error,
        }
        | columns
    )


def seconds_to(rows, target):
    return cost_of(runs_of(rows, "largest", "cpu_seconds"), target).value


def ranked(*tables, targets=(1e-2,), certain=math.inf):
    return rank(costs(pd.concat(tables), targets, "largest", "cpu_seconds"), certain)


def test_cost_of_an_error_follows_a_power_law_between_runs():
    error = np.array([1e-1, 3e-3, 2e-5])
    table = measured(error, 0.5 * error**-0.7).sample(frac=1, random_state=1)
    for target in (5e-2, 1e-3, 1e-4, 2e-5):
        assert seconds_to(table, target) == pytest.approx(0.5 * target**-0.7)


def test_nothing_is_extrapolated():
    table = measured([1e-1, 1e-3], [1.0, 3.0])
    assert seconds_to(table, 9e-4) == math.inf
    assert seconds_to(table, 0.5) == 1.0
    assert seconds_to(table.head(0), 0.5) == math.inf
    assert seconds_to(measured([1e-9, 1e-9], [5.0, 4.0]), 1e-2) == 4.0


def test_an_error_that_is_small_by_chance_does_not_count():
    table = measured([1e-1, 1e-5, 1e-2, 1e-4], [1.0, 2.0, 4.0, 8.0])
    assert seconds_to(table, 1e-3) == pytest.approx(math.sqrt(4.0 * 8.0))


def test_no_error_costs_more_than_a_finer_one():
    """Large steps may be dear, and disturbed; a finer run that is cheaper has the error, too."""
    table = measured([1e-1, 1e-3, 1e-4, 1e-5], [4.0, 3.0, 1.0, 2.0])
    assert [seconds_to(table, target) for target in (1e-2, 1e-3, 5e-4, 1e-4)] == [1.0] * 4
    assert seconds_to(table, 1e-5) == 2.0


def test_an_error_below_that_of_the_reference_does_not_count():
    table = measured([1e-1, 1e-7], [1.0, 2.0], reference_error=1e-3)
    assert seconds_to(table, 1.9e-3) == math.inf
    assert seconds_to(table, 2e-3) == pytest.approx(2.0)


def test_failed_runs_reach_nothing():
    table = measured([1e-1, np.nan, 1e-3], [1.0, 0.1, 4.0], status=["SUCCESS", "NON_FINITE", "SUCCESS"])
    assert seconds_to(table, 1e-2) == pytest.approx(2.0)


def test_ranking():
    a = measured([1e-1, 1e-3], [1.0, 4.0])
    b = measured([1e-3, 1e-6], [6.0, 7.0], method="B")
    found = ranked(b, a, targets=(1e-8, 1e-2, 1e-6))
    assert found["target"].tolist() == [1e-2, 1e-6, 1e-8]
    assert found["cheapest"].tolist() == ["A", "B", "not reached"]
    assert found["cost"].tolist()[:2] == pytest.approx([2.0, 7.0])
    assert found["next"].tolist() == ["B", "", ""]
    assert found["ratio"].iloc[0] == pytest.approx(3.0)


@pytest.mark.parametrize(
    ("ratio", "spread", "word"), [(1.2, 1.0, "tie"), (1.3, 1.0, "A"), (1.3, 1.4, "tie"), (1.5, 1.4, "A")]
)
def test_costs_closer_than_the_spread_are_a_tie(ratio, spread, word):
    a = measured([1e-3], [1.0])
    b = measured([1e-3], [ratio], method="B", spread=spread)
    found = ranked(a, b).iloc[0]
    assert found["cheapest"] == word
    assert found["tied"] == ("A; B" if word == "tie" else "A")
    assert found["next"] == ("" if word == "tie" else "B")


def test_counted_work_has_no_spread():
    table = pd.concat([measured([1e-3], [1.0], steps=100), measured([1e-3], [1.0], method="B", steps=101)])
    assert rank(costs(table, (1e-2,), "largest", "steps"), math.inf)["cheapest"].tolist() == ["A"]


def test_what_rests_on_a_run_near_the_limit_decides_nothing():
    a = measured([1e-1, 1e-3], [0.01, 4.0])
    assert ranked(a, certain=3.9)["cheapest"].tolist() == ["at the limit"]
    assert ranked(a, certain=4.0)["cheapest"].tolist() == ["A"]


def test_what_the_reference_does_not_resolve_is_not_called_unreached():
    table = measured([1e-1, 1e-9], [1.0, 2.0], reference_error=1e-5)
    assert ranked(table, targets=(1e-4, 1e-6))["cheapest"].tolist() == ["A", "not resolved"]


def test_front_holds_the_runs_that_no_other_beats():
    table = pd.concat([measured([1e-1, 1e-3], [1.0, 4.0]), measured([1e-2, 1e-2], [2.0, 5.0], method="B")])
    found = front(table, "largest", "cpu_seconds")
    assert found["cpu_seconds"].tolist() == [1.0, 2.0, 4.0]
    assert found["method"].tolist() == ["A", "B", "A"]
