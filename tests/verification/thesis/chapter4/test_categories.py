"""EMT categories: the order of events on tables written by hand, and ratios given a value on known distributions."""

import math

import numpy as np
import pandas as pd
import pytest

from tissue.study.categories import outcome
from verification.thesis.chapter4.categories import by_order, given, happened, outcome_published
from verification.thesis.chapter4.ratios import Ratio

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


def test_order():
    named = by_order(cells_with(*TIMES), END)
    assert list(named) == ["none", "[A]", "[AB]", "[BA]", "[A]", "[BP]", "[SBAP]", "[AB]", "[A]"]


def test_cells_without_inm_are_told_apart():
    cells = cells_with((6, 7, NEVER, NEVER), (6, 7, NEVER, NEVER), (NEVER,) * 4, inm=[True, False, False])
    assert list(by_order(cells, END)) == ["[AB]", "[AB] no INM", "none no INM"]


def test_an_earlier_end_has_fewer_events():
    cells = cells_with(*TIMES)
    assert happened(cells, 6.5).sum().to_dict() == {"A": 5, "B": 4, "S": 1, "P": 1}
    assert (by_order(cells, 3.0) == "none").all()


def test_shares_of_orders_are_those_of_the_distribution():
    """Table 5, '35 % [P]': [A], [B] with 70 %, [P] with 50 %, which acts with [B] only."""
    rng = np.random.default_rng(0)
    times = [np.where(rng.random(20_000) < p, rng.uniform(6, 24, 20_000), NEVER) for p in (0.7, 0.7, 0, 0.5)]
    cells = cells_with(*zip(*times, strict=True))
    shares = by_order(cells, END).value_counts(normalize=True)
    expected = {"none": 0.09, "[A]": 0.21, "[B]": 0.3 * 0.35, "[AB]": 0.35 * 0.35, "[BA]": 0.35 * 0.35}
    assert {name: shares[name] for name in expected} == pytest.approx(expected, abs=0.015)


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
        truth = 1 - (curve["low_edge"] + curve["high_edge"]) / 2
        inside += list((curve["low"] <= truth) & (truth <= curve["high"]))
        wide += [low <= t <= high for t, (low, high) in zip(truth, plain, strict=True)]
    assert np.mean(inside) > 0.92
    assert np.mean(wide) < np.mean(inside)


def test_conditional_curve_leaves_out_what_has_no_value():
    values = pd.Series([0.1, 0.9, math.inf, -1, 2, math.nan])
    hits, runs = pd.Series([True, False, True, True, True, True]), pd.Series(range(6))
    curve = given(hits, runs, values, [0, 0.5, 0.8, 1])
    assert list(curve["low_edge"]) == [0, 0.8]
    assert list(curve["high_edge"]) == [0.5, 1]
    assert list(curve["value"]) == [1, 0]
    assert given(hits, runs, values, [10, 20]).empty


def positions(*rows, step=0.5):
    """A table with the positions of cells at times 0, step, 2 step, ..."""
    columns = {f"ab_{step * k:g}h": column for k, column in enumerate(zip(*rows, strict=True))}
    below = {f"below_{step * k:g}h": [y < 0.2 for y in column] for k, column in enumerate(zip(*rows, strict=True))}
    return pd.DataFrame({"replicate": range(len(rows))} | columns | below)


def test_outcomes_by_the_published_rule():
    cells = positions(
        (-1, -1, -1, -1),
        (-1, 1, 1, -9),  # back within the hour
        (-1, 1, -1, 9),  # back later
        (-1, 1, -1, 0),  # for a moment only
        (0, -1, -1, -1),  # not yet
    )
    assert list(outcome_published(cells, "basal", 0)) == [True, False, False, True, False]
    assert list(outcome(cells, "basal", 0)) == [True, True, True, True, False]
    assert outcome_published(cells, "basal", 1.5).equals(outcome(cells, "basal", 1.5))
    assert outcome_published(cells, "apical", 0.5).equals(outcome(cells, "apical", 0.5))
