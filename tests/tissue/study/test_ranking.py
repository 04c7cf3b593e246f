"""Rankings find what made the outcome."""

import math

import numpy as np
import pandas as pd
import pytest
from scipy.optimize import minimize

from dincl.errors import InvalidProblem
from tissue.statistics import ranking
from tissue.statistics.categories import by_selection, happened
from tissue.statistics.ranking import by_coefficient, by_importance, by_ratio, factors, shuffled

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


def test_neighbours_with_protrusions_are_counted_by_replicate(cells):
    numbers, _ = factors(cells, END)
    protrudes = np.isfinite(cells["t_p_h"])
    for run in (0, 7):
        mine = cells["replicate"] == run
        total = protrudes[mine].sum()
        assert list(numbers.loc[mine, "others with [P]"]) == list(total - protrudes[mine])


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
    assert list(found.table["factor"][:2]) == ["P", "onset"]
    assert set(found.table["factor"][2:4]) == {"A", "A time"}
    rows = found.table.set_index("factor")
    assert (rows.loc[["P", "onset", "A time"], "low"] > 0).all()
    assert (rows.loc[["inm", "place", "B time", "P time", "others with [P]"], "value"].abs() < 0.01).all()
    assert (rows["low"] <= rows["value"]).all()
    assert (rows["value"] <= rows["high"]).all()
    assert found.loss < 0.9 * found.without
    assert (found.cells, found.replicates) == (3000, 300)


@pytest.mark.slow
def test_importance_is_a_function_of_table_and_seed(cells, hits, monkeypatch):
    monkeypatch.setattr(ranking, "SHUFFLES", 1)
    monkeypatch.setattr(ranking, "FOLDS", 2)
    part = cells["replicate"] < 60
    one, again, other = (by_importance(cells[part], hits[part], END, seed=seed) for seed in (3, 3, 4))
    pd.testing.assert_frame_equal(one.table, again.table)
    assert not one.table.equals(other.table)


@pytest.mark.slow
def test_importance_knows_of_common_fates(cells, hits, monkeypatch):
    """Each cell four times in its replicate tells no more than once; on their own they would halve the interval."""
    monkeypatch.setattr(ranking, "SHUFFLES", 1)
    one = cells["replicate"] < 100
    four = pd.concat([cells[one]] * 4, ignore_index=True)
    tables = (cells[one], hits[one]), (four, four["ab_48h"] < 0)
    rows = [by_importance(*pair, END, seed=0).table.set_index("factor").loc["P"] for pair in tables]
    widths = [row["high"] - row["low"] for row in rows]
    assert widths[1] > 0.55 * widths[0]


@pytest.mark.slow
def test_coefficients_have_direction_and_cover_zero_where_nothing_is(cells, hits):
    found = by_coefficient(cells, hits, END, seed=0)
    rows = found.table.set_index("factor")
    assert list(found.table["factor"][:2]) == ["P", "onset"]
    assert rows.loc["P", "low"] > 0 > rows.loc["onset", "high"]
    assert rows.loc["A time", "high"] < 0
    idle = rows.loc[["inm", "place", "B time", "P time"]]
    assert ((idle["low"] < 0) & (idle["high"] > 0)).sum() >= 3
    # One standard deviation of a uniform number on (0, 1) is 0.289; without an onset it is the mean.
    assert rows.loc["onset", "low"] < -4 * 0.289 * math.sqrt(0.91) * 0.93 < rows.loc["onset", "high"]


def test_coefficients_are_those_of_all_cells(cells, hits, monkeypatch):
    """As the regression is defined, minimised by another program: log loss + |b|^2 / 2 on standardised factors."""
    monkeypatch.setattr(ranking, "RESAMPLES", 3)
    found = by_coefficient(cells, hits, END, seed=0)
    numbers, kept = factors(cells, END)
    x = numbers[[factor.name for factor in kept]].to_numpy()
    x, y = (x - x.mean(axis=0)) / x.std(axis=0), hits.to_numpy(float)

    def log_loss(b):
        return np.logaddexp(0.0, x @ b[1:] + b[0]) - y * (x @ b[1:] + b[0])

    def gradient(b):
        rest = 1.0 / (1.0 + np.exp(-(x @ b[1:] + b[0]))) - y
        return np.append(rest.sum(), rest @ x + b[1:])

    start = np.zeros(1 + x.shape[1])
    best = minimize(lambda b: log_loss(b).sum() + b[1:] @ b[1:] / 2, start, jac=gradient, options={"gtol": 1e-6}).x
    values = found.table.set_index("factor")["value"]
    np.testing.assert_allclose(values[[factor.name for factor in kept]], best[1:], atol=2e-3)
    assert found.loss == pytest.approx(log_loss(best).mean(), abs=1e-6)


def test_coefficients_know_of_common_fates(monkeypatch):
    """A factor of the replicate: its interval is far wider than that of as many cells on their own."""
    monkeypatch.setattr(ranking, "RESAMPLES", 80)
    table = emt_cells(150, 10, 5, lambda table: 0 * table["cell"], shared=2.0)
    hits = table["ab_48h"] < 0
    alone = table.assign(replicate=np.arange(len(table)))
    shared = by_coefficient(table, hits, END, seed=1).table.set_index("factor").loc["others with [P]"]
    numbers = factors(table, END)[0]["others with [P]"]
    apart = by_coefficient(alone.assign(cell=numbers), hits, END, seed=1).table.set_index("factor").loc["place"]
    assert shared["high"] - shared["low"] > 1.5 * (apart["high"] - apart["low"])


def test_many_cells_are_thinned_to_whole_replicates(cells, hits, monkeypatch):
    monkeypatch.setattr(ranking, "MOST_CELLS", 1000)
    monkeypatch.setattr(ranking, "RESAMPLES", 10)
    found = by_coefficient(cells, hits, END, seed=0)
    assert (found.cells, found.replicates) == (1000, 100)


def test_rankings_need_both_outcomes(cells, hits):
    for rank in (by_importance, by_coefficient):
        with pytest.raises(InvalidProblem, match="0 of 3000 cells in 300 replicates have the outcome"):
            rank(cells, hits & ~hits, END, seed=0)
    first = cells["replicate"] < 4
    with pytest.raises(InvalidProblem, match="in 4 replicates"):
        by_importance(cells[first], hits[first], END, seed=0)
    for bad in ({"seed": -1}, {"seed": 0, "level": 1.5}):
        with pytest.raises(InvalidProblem, match=list(bad)[-1]):
            by_coefficient(cells, hits, END, **bad)


def test_manual_ranking_is_sorted(cells, hits):
    found = by_ratio(hits, cells["replicate"], by_selection(cells, END))
    assert set(found.index[:2]) == {"BP", "ABP"}
    assert (found["value"].diff().dropna() <= 0).all()
    assert found["of"].sum() == len(cells)
