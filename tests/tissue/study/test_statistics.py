"""Categories of EMT cells, what became of them, and curves: on tables written by hand and on known distributions."""

import math

import numpy as np
import pandas as pd
import pytest

from dincl.errors import InvalidProblem
from tissue.statistics.categories import (
    by_interval,
    by_order,
    by_selection,
    happened,
    interval_names,
    kept_times,
    outcome,
)
from tissue.statistics.ratios import Ratio, given, over_time

NEVER = math.inf
END = 48.0


def cells_with(*times, inm=None):
    """A cell for each (T_A, T_B, T_S, T_P); [P] acts from max(T_P, T_B) on, as in stored tables."""
    table = pd.DataFrame(times, columns=["t_a_h", "t_b_h", "t_s_h", "t_p_h"], dtype=float)
    table["t_p_h"] = table[["t_p_h", "t_b_h"]].max(axis=1)
    return table.assign(inm=[True] * len(table) if inm is None else inm, replicate=range(len(table)))


TIMES = [
    (NEVER, NEVER, NEVER, NEVER),
    (6, NEVER, NEVER, NEVER),
    (6, 6, NEVER, NEVER),
    (12, 6, NEVER, NEVER),
    (6, NEVER, NEVER, 8),  # [P] without [B] never acts
    (NEVER, 6, NEVER, 3),  # [P] waits for [B]
    (7, 6, 5, 8),
    (6, 48 + 1e-14, NEVER, NEVER),  # [B] begins in the last step
    (6, 48.1, NEVER, NEVER),
]


def test_selection():
    named = by_selection(cells_with(*TIMES), END)
    assert list(named) == ["none", "A", "AB", "AB", "A", "BP", "ABSP", "AB", "A"]
    assert list(named.cat.categories) == ["none", "A", "AB", "BP", "ABSP"]


def test_order():
    named = by_order(cells_with(*TIMES), END)
    assert list(named) == ["none", "[A]", "[AB]", "[BA]", "[A]", "[BP]", "[SBAP]", "[AB]", "[A]"]


def test_cells_without_inm_are_told_apart():
    cells = cells_with((6, 7, NEVER, NEVER), (6, 7, NEVER, NEVER), (NEVER,) * 4, inm=[True, False, False])
    assert list(by_selection(cells, END, inm=True)) == ["AB", "AB no INM", "none no INM"]
    assert list(by_order(cells, END, inm=True).cat.categories) == ["none no INM", "[AB]", "[AB] no INM"]


def test_an_earlier_end_has_fewer_events():
    cells = cells_with(*TIMES)
    assert happened(cells, 6.5).sum().to_dict() == {"A": 5, "B": 4, "S": 1, "P": 1}
    assert (by_selection(cells, 3.0) == "none").all()


def test_no_cells_have_no_categories():
    empty = cells_with(*TIMES).iloc[:0]
    assert by_selection(empty, END).empty
    assert by_order(empty, END, inm=True).empty


def test_shares_of_selections_are_those_of_the_distribution():
    """Table 5, '35 % [P]': [A], [B] with 70 %, [P] with 50 %, which acts with [B] only."""
    rng = np.random.default_rng(0)
    times = [np.where(rng.random(20_000) < p, rng.uniform(6, 24, 20_000), NEVER) for p in (0.7, 0.7, 0, 0.5)]
    cells = cells_with(*zip(*times, strict=True))
    shares = by_selection(cells, END).value_counts(normalize=True)
    expected = {"none": 0.09, "A": 0.21, "B": 0.3 * 0.35, "AB": 0.7 * 0.35, "BP": 0.3 * 0.35, "ABP": 0.7 * 0.35}
    assert shares.to_dict() == pytest.approx(expected, abs=0.015)
    orders = by_order(cells, END).value_counts(normalize=True)
    assert orders["[AB]"] == pytest.approx(orders["[BA]"], abs=0.015)


def test_intervals():
    values = pd.Series([-0.1, 0.0, 0.1, 0.5, 0.51, 1.0, 1.2, math.inf, math.nan])
    names = ["<= 0", "<= 0", "(0, 0.5]", "(0, 0.5]", "(0.5, 1]", "(0.5, 1]", "> 1", "never", "never"]
    assert list(by_interval(values, [0, 0.5, 1])) == names
    missing = pd.Series([0.25, None], dtype="Float64")
    assert list(by_interval(missing, [0, 0.5, 1])) == ["(0, 0.5]", "never"]
    assert interval_names([6, 24]) == ["<= 6", "(6, 24]", "> 24"]


@pytest.mark.parametrize("edges", [[0], [0, 0], [1, 0], [0, math.inf], [0, math.nan]])
def test_edges_that_can_not_be(edges):
    with pytest.raises(InvalidProblem, match=r"edges = .*: must be two or more finite numbers"):
        by_interval(pd.Series([0.5]), edges)


def positions(*rows, step=0.5):
    """A table with the positions of cells at times 0, step, 2 step, ..."""
    columns = {f"ab_{step * k:g}h": column for k, column in enumerate(zip(*rows, strict=True))}
    below = {f"below_{step * k:g}h": [y < 0.2 for y in column] for k, column in enumerate(zip(*rows, strict=True))}
    return pd.DataFrame({"replicate": range(len(rows))} | columns | below)


def test_outcomes_by_the_thesis():
    cells = positions((0.5, -0.1), (0.1, 0.0), (1.0, 1.1))
    assert list(outcome(cells, "basal", 0.5)) == [True, False, False]
    assert list(outcome(cells, "apical", 0.5)) == [False, False, True]
    assert list(outcome(cells, "apical", 0)) == [False, False, False]
    assert list(outcome(cells, "below", 0)) == [False, True, False]


def test_outcomes_by_the_published_rule():
    cells = positions(
        (-1, -1, -1, -1),
        (-1, 1, 1, -9),  # back within the hour
        (-1, 1, -1, 9),  # back later
        (-1, 1, -1, 0),  # for a moment only
        (0, -1, -1, -1),  # not yet
    )
    assert list(outcome(cells, "basal", 0, "published")) == [True, False, False, True, False]
    assert list(outcome(cells, "basal", 0, "thesis")) == [True, True, True, True, False]
    at_end = [outcome(cells, "basal", 1.5, rule) for rule in ("thesis", "published")]
    assert at_end[0].equals(at_end[1])
    assert list(outcome(cells, "apical", 0.5, "published")) == list(outcome(cells, "apical", 0.5))


def test_outcomes_that_can_not_be():
    cells = positions((0.5, -0.1))
    with pytest.raises(InvalidProblem, match=r"t = 0\.7: must be an output time; these are \[0\.0, 0\.5\] h"):
        outcome(cells, "basal", 0.7)
    with pytest.raises(InvalidProblem, match="what = 'out': must be one of basal, apical, below"):
        outcome(cells, "out", 0.5)
    with pytest.raises(InvalidProblem, match="rule = 'mine'"):
        outcome(cells, "basal", 0.5, "mine")


def test_kept_times_are_in_order():
    cells = pd.DataFrame(columns=["ab_0h", "ab_10h", "ab_2h", "ab_0.5h", "onset_ab", "below_3h"])
    assert kept_times(cells) == [0, 0.5, 2, 10]


def test_curve_over_time():
    """A fall through the basal line at a uniform time: r(t) = t, within a band that covers it nearly everywhere."""
    rng, times = np.random.default_rng(5), np.arange(0, 11) / 10
    leaves = rng.random(2000)
    cells = positions(*[tuple(np.where(times < t, 0.5, -0.5)) for t in leaves], step=0.1)
    curve = over_time(cells).set_index("what")
    basal = curve.loc["basal"]
    assert list(basal["time_h"]) == pytest.approx(list(times))
    assert (basal["value"].diff().dropna() >= 0).all()
    assert ((basal["low"] <= times + 1e-12) & (times <= basal["high"] + 1e-12)).mean() > 0.8
    assert basal["value"].iloc[-1] == 1
    assert (curve.loc["apical", "value"] == 0).all()
    assert (curve.loc["below", "value"] == basal["value"].to_numpy()).all()
    row = basal.iloc[5]
    assert (row["low"], row["high"]) == pytest.approx(Ratio(int(row["count"]), 2000).interval())


def test_curve_of_no_cells_has_no_rows():
    assert over_time(positions((0.5, -0.1)).iloc[:0]).empty
    assert list(over_time(positions((0.5, -0.1)))["what"]) == ["basal", "basal", "apical", "apical", "below", "below"]


def test_conditional_curve_covers_the_truth():
    """P[hit | value] = 1 - value, ten cells with a common part in each replicate: bands of 95 % cover about 95 %."""
    rng, inside, wide = np.random.default_rng(6), [], []
    edges = np.linspace(0, 1, 6)
    for _ in range(60):
        shared = np.repeat(rng.random(80) < 0.5, 10)
        values = pd.Series(rng.random(800))
        limit = np.where(shared, rng.random(800), np.repeat(rng.random(80), 10))  # uniform, half of them common
        hits = pd.Series(limit > values)
        runs = pd.Series(np.repeat(np.arange(80), 10))
        curve = given(hits, runs, values, edges)
        plain = [Ratio(int(a), int(b)).interval() for a, b in zip(curve["count"], curve["of"], strict=True)]
        truth = 1 - curve["middle"]
        inside += list((curve["low"] <= truth) & (truth <= curve["high"]))
        wide += [low <= t <= high for t, (low, high) in zip(truth, plain, strict=True)]
    assert np.mean(inside) > 0.92
    assert np.mean(wide) < np.mean(inside)


def test_conditional_curve_leaves_out_what_has_no_value():
    values = pd.Series([0.1, 0.9, math.inf, -1, 2, math.nan])
    hits, runs = pd.Series([True, False, True, True, True, True]), pd.Series(range(6))
    curve = given(hits, runs, values, [0, 0.5, 0.8, 1])
    assert list(curve.index) == ["(0, 0.5]", "(0.8, 1]"]
    assert list(curve["middle"]) == [0.25, 0.9]
    assert list(curve["low_edge"]) == [0, 0.8]
    assert list(curve["high_edge"]) == [0.5, 1]
    assert list(curve["value"]) == [1, 0]
    assert given(hits, runs, values, [10, 20]).empty
