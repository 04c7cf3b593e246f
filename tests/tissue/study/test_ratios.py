"""Ratios and their differences: intervals against exact ones, their coverage by simulation, the correct errors."""

import gc
import math

import numpy as np
import pandas as pd
import pytest
from scipy.stats import binomtest, chi2_contingency
from statsmodels.stats.multitest import multipletests

from dincl.errors import InvalidProblem
from tissue.statistics.comparisons import Difference, runs_needed, within
from tissue.statistics.proportions import corrected, wilson
from tissue.statistics.ratios import Ratio, effective_size, ratio, ratio_of_runs, ratios

TRIALS = 600
# Five standard deviations of a coverage of 0.95 in so many trials.
SLACK = 5 * math.sqrt(0.95 * 0.05 / TRIALS)


def clustered(p, rho, runs, cells, seed):
    """Hits in each replicate, beta-binomial: cells of one replicate correlate with rho; one row per trial."""
    rng = np.random.default_rng(seed)
    chance = rng.beta(p * (1 / rho - 1), (1 - p) * (1 / rho - 1), (TRIALS, runs))
    return rng.binomial(cells, chance)


def covered(truth, bounds):
    return float(np.mean([low <= truth <= high for low, high in bounds]))


@pytest.mark.parametrize(("count", "of"), [(0, 1), (1, 1), (0, 400), (3, 10), (120, 400), (400, 400)])
@pytest.mark.parametrize("level", [0.8, 0.95, 0.99])
def test_interval_is_wilsons(count, of, level):
    expected = binomtest(count, of).proportion_ci(level, method="wilson")
    assert Ratio(count, of).interval(level) == pytest.approx((expected.low, expected.high), abs=1e-14)


def test_interval_narrows_with_cells_and_widens_with_level():
    widths = [np.subtract(*Ratio(3 * n, 10 * n).interval()[::-1]) for n in (1, 4, 16, 64, 10**6)]
    assert (np.diff(widths) < 0).all()
    assert widths[-1] < 1e-3
    widths = [np.subtract(*Ratio(3, 10).interval(level)[::-1]) for level in (0.5, 0.9, 0.95, 0.999)]
    assert (np.diff(widths) > 0).all()


@pytest.mark.parametrize(
    ("count", "of", "effective"), [(1, 0, None), (3, 2, None), (-1, 2, None), (1, 2, 3), (1, 2, 0)]
)
def test_ratios_that_can_not_be(count, of, effective):
    with pytest.raises(InvalidProblem, match="must"):
        Ratio(count, of, effective)


@pytest.mark.parametrize("level", [0.0, 1.0, math.nan])
def test_levels_that_can_not_be(level):
    with pytest.raises(InvalidProblem, match=r"level = .*: must be between 0 and 1"):
        Ratio(1, 2).interval(level)


def test_text():
    assert str(Ratio(40, 400)) == "10.0 % [7.4, 13.3] of 400"


def test_one_cell_per_replicate_is_as_independent():
    assert effective_size([1, 0, 0, 1, 1], [1] * 5) == pytest.approx(5)
    assert effective_size([0] * 50, [1] * 50) == pytest.approx(50)


def test_effective_size_of_equal_cells():
    """All cells of a replicate alike: as many independent cells as replicates, for many of them."""
    assert effective_size([10, 0] * 500, [10] * 1000) == pytest.approx(1000, rel=0.01)
    # None, and all: the data say nothing, so the worst is taken; and it does not jump at the next.
    none, all_hits, one = (effective_size([k] + [j] * 99, [10] * 100) for k, j in ((0, 0), (10, 10), (1, 0)))
    assert none == pytest.approx(all_hits)
    assert 100 <= none <= 130
    assert none < one < 1.2 * none


def test_effective_size_is_at_most_the_cells():
    """Exactly half of each replicate are hits: better than independent, but not counted so."""
    assert effective_size([5] * 1000, [10] * 1000) == 10_000


@pytest.mark.parametrize(("p", "rho"), [(0.05, 0.1), (0.05, 0.5), (0.3, 0.1), (0.3, 0.5), (0.9, 0.3)])
def test_coverage_of_clustered_cells(p, rho):
    """The interval with the effective number of cells covers as it says; the plain one does not."""
    hits = clustered(p, rho, runs=60, cells=10, seed=7)
    sizes = np.full(60, 10)
    effective = np.array([effective_size(row, sizes) for row in hits])
    values = hits.sum(axis=1) / 600
    robust, plain = (covered(p, zip(*wilson(values, n), strict=True)) for n in (effective, np.full(TRIALS, 600)))
    assert robust >= 0.95 - SLACK
    assert plain < 0.95 - SLACK
    if rho == 0.5:
        assert plain < 0.7


@pytest.mark.parametrize("runs", [8, 12, 24])
def test_coverage_of_control_cells(runs):
    """Few of 47 cells of each run leave; Student's interval of the shares covers 0.004 in 39 to 85 % of the cases."""
    rng, truth, covers, lengths = np.random.default_rng(runs), 0.004, [], []
    for _ in range(1000):
        y = rng.binomial(47, rng.beta(truth * 99, (1 - truth) * 99, runs))
        low, high = ratio_of_runs(y, np.full(runs, 47)).interval()
        covers.append(low <= truth <= high)
        lengths.append(high - low)
    assert np.mean(covers) > 0.93
    assert np.mean(lengths) < 0.4 / runs  # replicates of mean size would make it 3/runs


def test_ratio_of_runs():
    one = ratio_of_runs([0.0, 3.0, 0.0], [40.0, 50.0, 60.0])
    assert (one.count, one.of) == (3, 150)
    assert ratio_of_runs([1.0, 1.0, 1.0], [40.0, 50.0, 60.0]).effective > one.effective
    low, high = ratio_of_runs([0.0] * 12, [50.0] * 12).interval()
    assert low == 0 < 0.01 < high < 0.03


def test_clustered_intervals_are_not_wasteful():
    """Where the design effect is known, 1 + 9 rho, the effective number of cells comes near it."""
    hits = clustered(0.3, 0.3, runs=400, cells=10, seed=2)
    effective = np.array([effective_size(row, np.full(400, 10)) for row in hits])
    assert np.median(effective) == pytest.approx(4000 / (1 + 9 * 0.3), rel=0.03)


def table(seed, runs=40, cells=6):
    rng = np.random.default_rng(seed)
    shape = (runs, cells)
    kinds = rng.choice(np.array(["a", "b"]), shape)
    noise = np.repeat(rng.normal(size=(runs, 1)), cells, axis=1)
    hits = noise + rng.normal(size=shape) + np.where(kinds == "a", 0.5, 0) > 0
    columns = {"replicate": np.repeat(np.arange(runs), cells), "kind": kinds.ravel(), "hit": hits.ravel()}
    return pd.DataFrame(columns)


def test_ratios_of_categories():
    cells = table(0)
    cells["kind"] = pd.Categorical(cells["kind"], categories=["b", "empty", "a"])
    found = ratios(cells["hit"], cells["replicate"], cells["kind"])
    assert list(found.index) == ["b", "a"]
    for kind in ("a", "b"):
        part, row = cells[cells["kind"] == kind], found.loc[kind]
        assert (row["count"], row["of"], row["runs"]) == (part["hit"].sum(), len(part), part["replicate"].nunique())
        assert row["value"] == part["hit"].mean()
        assert row["low"] < row["value"] < row["high"]
        assert ratio(part["hit"], part["replicate"]).interval() == (row["low"], row["high"])
    assert not found.isna().any().any()


def test_ratios_leave_out_cells_without_a_category_and_do_not_mind_the_order():
    cells = table(1)
    cells["kind"] = cells["kind"].where(cells.index != 3, None)
    found = ratios(cells["hit"], cells["replicate"], cells["kind"])
    assert found["of"].sum() == len(cells) - 1
    mixed = cells.sample(frac=1, random_state=5)
    pd.testing.assert_frame_equal(found, ratios(mixed["hit"], mixed["replicate"], mixed["kind"]))


def test_no_cells_have_no_ratio():
    cells = table(0).iloc[:0]
    assert ratios(cells["hit"], cells["replicate"], cells["kind"]).empty
    with pytest.raises(InvalidProblem, match="no cells"):
        ratio(cells["hit"], cells["replicate"])
    with pytest.raises(InvalidProblem, match="0 hits, 240 replicates, 240 categories"):
        ratios(cells["hit"], table(0)["replicate"], table(0)["kind"])


def test_difference_of_newcombe():
    """Two of the examples of Newcombe (1998), Table II, method 10: 56/70 - 48/80 and 9/10 - 3/10."""
    assert Difference(Ratio(56, 70), Ratio(48, 80)).interval() == pytest.approx((0.0524, 0.3339), abs=5e-5)
    assert Difference(Ratio(9, 10), Ratio(3, 10)).interval() == pytest.approx((0.1705, 0.8090), abs=5e-5)


@pytest.mark.parametrize("level", [0.8, 0.95, 0.99])
def test_the_interval_of_the_same_runs_without_a_correlation_is_that_of_different_runs(level):
    for first, second in (
        (Ratio(9, 10), Ratio(3, 10, 7.5)),
        (Ratio(0, 40), Ratio(5, 400)),
        (Ratio(10, 10), Ratio(0, 5)),
    ):
        correlated = Difference(first, second, 1e-15).interval(level)
        assert correlated == pytest.approx(Difference(first, second).interval(level), abs=1e-14)


def test_difference_changes_sign_with_the_order_and_stays_within_bounds():
    one, other = Ratio(10, 10, 3.0), Ratio(0, 5)
    low, high = Difference(one, other).interval()
    assert Difference(other, one).interval() == pytest.approx((-high, -low))
    assert -1 <= low < 1 == high
    assert Difference(one, one).interval()[0] < 0 < Difference(one, one).interval()[1]
    with pytest.raises(InvalidProblem, match=r"correlation = 1\.5"):
        Difference(one, other, 1.5)


def test_p_value_is_that_of_the_score_test():
    expected = chi2_contingency([[30, 70], [45, 55]], correction=False).pvalue
    assert Difference(Ratio(30, 100), Ratio(45, 100)).p_value() == pytest.approx(expected)
    assert Difference(Ratio(0, 10), Ratio(0, 20)).p_value() == 1
    assert Difference(Ratio(10, 10), Ratio(20, 20)).p_value() == 1


@pytest.mark.parametrize("size", [4, 10, 64, 97, 100, 399])
def test_ratios_that_always_change_together_do_not_differ_by_chance(size):
    """Equal sizes with correlation 1: the difference has no spread at all, and nothing is claimed."""
    for count in range(size):
        assert Difference(Ratio(count, size), Ratio(size // 2, size), 1.0).p_value() == 1.0


def test_coverage_of_a_difference():
    one, other = clustered(0.4, 0.3, 60, 10, seed=1), clustered(0.2, 0.05, 40, 10, seed=2)
    bounds = []
    for a, b in zip(one, other, strict=True):
        first = Ratio(int(a.sum()), 600, effective_size(a, np.full(60, 10)))
        second = Ratio(int(b.sum()), 400, effective_size(b, np.full(40, 10)))
        bounds.append(Difference(first, second).interval())
    assert 0.95 - SLACK <= covered(0.2, bounds) <= 0.99


@pytest.mark.slow
def test_difference_within_replicates():
    """Two kinds of cells in the same tissues: what the tissues share cancels, so the interval is the narrower."""
    truth = 0.63816 - 0.5  # P[N(0, 2) > -0.5] of the first kind, P[N(0, 2) > 0] of the second
    trials = [table(seed) for seed in range(150)]
    pairs = [within(t["hit"], t["replicate"], t["kind"] == "a", t["kind"] == "b") for t in trials]
    assert np.mean([pair.correlation for pair in pairs]) > 0.2
    assert covered(truth, [pair.interval() for pair in pairs]) >= 0.95 - 5 * math.sqrt(0.95 * 0.05 / 150)
    apart = [Difference(pair.first, pair.second) for pair in pairs]
    widths = [np.mean([np.subtract(*pair.interval()[::-1]) for pair in kind]) for kind in (pairs, apart)]
    assert widths[0] < 0.9 * widths[1]
    rejected = np.mean([pair.p_value() < 0.05 for pair in pairs])
    assert rejected > np.mean([pair.p_value() < 0.05 for pair in apart])


def test_within_needs_two_kinds():
    cells = table(0)
    kind = cells["kind"] == "a"
    with pytest.raises(InvalidProblem, match="in common"):
        within(cells["hit"], cells["replicate"], kind, kind)
    with pytest.raises(InvalidProblem, match="no cells"):
        within(cells["hit"], cells["replicate"], kind, kind & ~kind)


@pytest.mark.parametrize(("first", "second", "power"), [(0.3, 0.4, 0.8), (0.05, 0.1, 0.9), (0.7, 0.9, 0.8)])
def test_runs_needed_are_enough(first, second, power):
    """With so many runs the difference is seen as often as it says: in 4000 trials, to 4 standard deviations."""
    n, rng = runs_needed(first, second, power=power), np.random.default_rng(3)
    counts = zip(rng.binomial(n, first, 4000), rng.binomial(n, second, 4000), strict=True)
    seen = np.mean([Difference(Ratio(int(a), n), Ratio(int(b), n)).p_value() < 0.05 for a, b in counts])
    assert seen == pytest.approx(power, abs=0.03)


def test_runs_needed():
    assert runs_needed(0.3, 0.4) == 356  # the textbook number for 30 % against 40 % at 5 % and 80 %
    assert runs_needed(0.3, 0.4, cells_per_run=4) == 89
    assert runs_needed(0, 1) <= 4
    assert runs_needed(0.2, 0.2) is None
    assert runs_needed(0.3, 0.31) > 80 * runs_needed(0.3, 0.4)
    for bad in ({"power": 0.2}, {"cells_per_run": 0}, {"level": 2}):
        with pytest.raises(InvalidProblem, match=next(iter(bad))):
            runs_needed(0.1, 0.2, **bad)
    with pytest.raises(InvalidProblem, match=r"second = 1\.2"):
        runs_needed(0.1, 1.2)


def test_corrections_by_hand():
    p = pd.Series([0.04, 0.01, 0.03, 0.5], index=list("abcd"))
    assert corrected(p).to_dict() == pytest.approx({"a": 0.09, "b": 0.04, "c": 0.09, "d": 0.5})
    assert corrected(p, "fdr").to_dict() == pytest.approx({"a": 0.16 / 3, "b": 0.04, "c": 0.16 / 3, "d": 0.5})
    assert corrected(pd.Series([0.6, 0.9])).to_list() == [1, 1]
    assert corrected(p.iloc[:0]).empty
    with pytest.raises(InvalidProblem, match="p_values"):
        corrected(pd.Series([0.1, math.nan]))
    with pytest.raises(InvalidProblem, match="method = 'none'"):
        corrected(p, "none")


@pytest.mark.parametrize(("method", "theirs"), [("holm", "holm"), ("fdr", "fdr_bh")])
def test_corrections_are_those_of_statsmodels(method, theirs, monkeypatch):
    """Also of equal p-values, of 0 and of 1; and no garbage is collected, which takes a second after many tests."""
    rng = np.random.default_rng(8)
    families = [*(rng.random(m) ** 3 for m in (1, 2, 7, 40)), np.array([0.2, 0.01, 0.2, 0.0, 1.0, 0.01])]
    collected = []
    monkeypatch.setattr(gc, "collect", lambda: collected.append(1) or 0)
    ours = [corrected(pd.Series(p), method).to_numpy() for p in families]
    assert not collected
    for p, found in zip(families, ours, strict=True):
        np.testing.assert_allclose(found, multipletests(p, method=theirs)[1], rtol=1e-14)


def test_correction_keeps_the_error_of_a_family():
    """Twenty comparisons without any difference: some p < 0.05 is usual before, and rare after."""
    p = pd.DataFrame(np.random.default_rng(4).random((1000, 20)))
    assert (p.min(axis=1) < 0.05).mean() > 0.5
    assert p.apply(corrected, axis=1).min(axis=1).lt(0.05).mean() == pytest.approx(0.05, abs=0.035)
