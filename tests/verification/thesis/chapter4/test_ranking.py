"""The ranking of factors finds what made the outcome."""

import math

import numpy as np
import pandas as pd
import pytest

from dincl.errors import InvalidProblem
from verification.thesis.chapter4 import ranking
from verification.thesis.chapter4.categories import happened
from verification.thesis.chapter4.ranking import by_importance, factors, shuffled

END = 48.0


def emt_cells(runs, cells, seed, odds, *, p=0.5, shared=0.0, fixed=None):
    """Cells as in Table 5, or all with the ``fixed`` times; ``odds``: the log odds to leave, given the table."""
    rng, n = np.random.default_rng(seed), runs * cells
    table = pd.DataFrame({"replicate": np.repeat(np.arange(runs), cells), "cell": np.tile(np.arange(cells), runs)})
    table["inm"] = rng.random(n) < 0.5
    for event, chance in (("a", 0.7), ("b", 0.7), ("s", 0.0), ("p", p)):
        drawn = np.where(rng.random(n) < chance, rng.uniform(6, 24, n), math.inf)
        table[f"t_{event}_h"] = drawn if fixed is None else fixed.get(event, math.inf)
    table["t_p_h"] = table[["t_p_h", "t_b_h"]].max(axis=1)
    table["onset_h"] = table[["t_a_h", "t_b_h", "t_s_h"]].min(axis=1)
    onset = pd.Series(rng.random(n), dtype="Float64")
    table["onset_ab"] = onset.where(np.isfinite(table["onset_h"]), None)
    logit = odds(table) + shared * np.repeat(rng.normal(size=runs), cells)
    leaves = rng.random(n) < 1 / (1 + np.exp(-np.asarray(logit, dtype=float)))
    return table.assign(ab_0h=0.5, ab_48h=np.where(leaves, -0.2, 0.5))


def known(table):
    """[P] decides most, then the onset, then a late [A] hinders; INM, [B] itself and the place do nothing."""
    onset = table["onset_ab"].fillna(0.5).astype(float)
    late = table["t_a_h"].where(np.isfinite(table["t_a_h"]), 15.0) - 15.0
    return -0.5 + 3 * np.isfinite(table["t_p_h"]) - 4 * (onset - 0.5) - 0.12 * late


@pytest.fixture(scope="module")
def cells():
    return emt_cells(300, 10, 1, known, shared=0.5)


@pytest.fixture(scope="module")
def hits(cells):
    return cells["ab_48h"] < 0


def test_factors_are_finite_numbers(cells):
    numbers, found = factors(cells, END)
    assert np.isfinite(numbers.to_numpy()).all()
    assert {factor.name for factor in found} == set(numbers) - {"S", "S time"}
    by_name = {factor.name: factor for factor in found}
    assert by_name["A"].columns == ("A", "A time")
    had = happened(cells, END)["A"].to_numpy()
    assert (by_name["A time"].among == had).all()
    assert (numbers.loc[had, "A time"] == cells.loc[had, "t_a_h"]).all()
    assert numbers.loc[~had, "A time"].nunique() == 1


def test_only_cells_with_an_event_exchange_its_times(cells):
    numbers, found = factors(cells, END)
    test = np.arange(500, 1500)
    part, rng = numbers.iloc[test], np.random.default_rng(0)
    had = happened(cells, END)["A"].to_numpy()[test]
    for factor in found:
        after = pd.DataFrame(shuffled(part, factor, test, rng), columns=part.columns)
        changed = {name for name in part if not np.array_equal(after[name], part[name])}
        assert changed == set(factor.columns)
        assert all(sorted(after[name]) == sorted(part[name]) for name in part)
        if factor.name == "A time":
            assert (after["A time"].to_numpy()[~had] == part["A time"].to_numpy()[~had]).all()
        if factor.name == "A":
            assert (
                (after["A time"] == numbers.loc[cells["t_a_h"] == np.inf, "A time"].iloc[0]) == (after["A"] == 0)
            ).all()


@pytest.mark.slow
def test_importance_finds_what_made_the_outcome(cells, hits, monkeypatch):
    monkeypatch.setattr(ranking, "SHUFFLES", 2)
    found = by_importance(cells, hits, END, seed=0)
    # Shuffling [A] shuffles its time, too: both tell of the time.
    assert list(found["factor"][:2]) == ["P", "onset"]
    assert set(found["factor"][2:4]) == {"A", "A time"}
    rows = found.set_index("factor")
    assert (rows.loc[["P", "onset", "A time"], "low"] > 0).all()
    assert (rows.loc[["inm", "place", "B time", "P time", "others with [P]"], "value"].abs() < 0.01).all()
    assert (rows["low"] <= rows["value"]).all()
    assert (rows["value"] <= rows["high"]).all()
    assert (found["loss"] < 0.9 * found["without"]).all()
    assert set(found["cells"]) == {3000}
    pd.testing.assert_frame_equal(found, by_importance(cells, hits, END, seed=0))


@pytest.mark.slow
def test_importance_knows_of_common_fates(cells, hits, monkeypatch):
    """Each cell four times in its replicate tells no more than once; on their own they would halve the interval."""
    monkeypatch.setattr(ranking, "SHUFFLES", 1)
    one = cells["replicate"] < 100
    four = pd.concat([cells[one]] * 4, ignore_index=True)
    tables = (cells[one], hits[one]), (four, four["ab_48h"] < 0)
    rows = [by_importance(*pair, END, seed=0).set_index("factor").loc["P"] for pair in tables]
    widths = [row["high"] - row["low"] for row in rows]
    assert widths[1] > 0.55 * widths[0]


def test_many_cells_are_thinned_to_whole_replicates(cells, hits, monkeypatch):
    monkeypatch.setattr(ranking, "MOST_CELLS", 1000)
    monkeypatch.setattr(ranking, "SHUFFLES", 1)
    found = by_importance(cells, hits, END, seed=0)
    assert set(found["cells"]) == {1000}


def test_a_ranking_needs_both_outcomes(cells, hits):
    with pytest.raises(InvalidProblem, match="0 of 3000 cells in 300 replicates have the outcome"):
        by_importance(cells, hits & ~hits, END, seed=0)
    first = cells["replicate"] < 4
    with pytest.raises(InvalidProblem, match="in 4 replicates"):
        by_importance(cells[first], hits[first], END, seed=0)
