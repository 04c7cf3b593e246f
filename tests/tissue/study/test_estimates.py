"""The one estimator: against scipy's tests and statsmodels, its coverage by simulation, and Holm's decisions."""

import numpy as np
import pytest
from scipy import stats
from statsmodels.stats.multitest import multipletests

from tissue.study.estimates import Estimate, estimate, holm

TRIALS = 2000
# Five standard deviations of a share of 0.95 of so many trials.
SLACK = 5 * (0.95 * 0.05 / TRIALS) ** 0.5
RNG = np.random.default_rng(3)
FIRST, SECOND = RNG.normal(50, 2, 12), RNG.normal(52, 4, 30)
DIFFERENCE, INTERACTION = (1.0, -1.0), (1.0, -1.0, -1.0, 1.0)


def shares(rng, p, runs, cells, rho=0.2):
    """Shares of hits among the cells of runs, which correlate with rho; shape (runs, TRIALS)."""
    if p == 0:
        return np.zeros((runs, TRIALS))
    chance = rng.beta(p * (1 / rho - 1), (1 - p) * (1 / rho - 1), (runs, TRIALS)) if cells > 1 else p
    return rng.binomial(cells, chance, (runs, TRIALS)) / cells


def test_differences_of_numbers_are_those_of_welch_and_pairs_those_of_student():
    found = estimate(DIFFERENCE, [FIRST, SECOND])
    known = stats.ttest_ind(FIRST, SECOND, equal_var=False)
    assert found.interval(0.9) == pytest.approx(tuple(known.confidence_interval(0.9)))
    assert (found.effect, found.p) == pytest.approx((FIRST.mean() - SECOND.mean(), known.pvalue))
    known = stats.ttest_rel(FIRST, SECOND[:12])
    pairs = estimate(DIFFERENCE, [FIRST, SECOND[:12]], paired=True)
    assert pairs.interval() == pytest.approx(tuple(known.confidence_interval()))
    assert pairs.p == pytest.approx(known.pvalue)
    alone = estimate([1.0], [FIRST])
    assert alone.interval() == pytest.approx(stats.t.interval(0.95, 11, FIRST.mean(), stats.sem(FIRST)))


def test_pairs_know_what_both_have_in_common():
    """An effect of 0.1 in each run, beside runs that differ by far more."""
    common = RNG.normal(0, 5, 40)
    groups = [common + RNG.normal(0.1, 0.05, 40), common]
    assert estimate(DIFFERENCE, groups).p > 0.5
    assert estimate(DIFFERENCE, groups, paired=True).p < 1e-6
    hits = (RNG.random(200) < 0.3).astype(float)
    more = np.where(np.arange(200) % 20 == 0, 1.0, hits)
    together, apart = (estimate(DIFFERENCE, [more, hits], 1.0, paired=one) for one in (True, False))
    assert together.value == apart.value
    assert together.error < apart.error / 2


def test_pairs_of_shares_have_the_pseudo_pairs_of_bonett_and_price():
    hits, other = np.array([1, 1, 0, 0, 1, 0, 1, 1.0]), np.array([1, 0, 0, 0, 1, 0, 0, 1.0])
    found = estimate(DIFFERENCE, [hits, other], 1.0, paired=True)
    wide = np.append(hits - other, (1.0, -1.0))
    assert found.error == pytest.approx(stats.sem(wide))
    assert (found.value, found.centre, found.freedom) == (0.25, pytest.approx(wide.mean()), 9)


@pytest.mark.parametrize("paired", [False, True])
def test_numbers_without_spread_decide_nothing(paired):
    found = estimate(DIFFERENCE, [np.full(7, 0.1), np.full(7, 0.7)], paired=paired)
    assert found.interval() == (-np.inf, np.inf)
    assert (found.p, found.runs_to_show(7)) == (1, None)


def test_shares_without_hits_or_with_hits_alone_have_intervals_within_their_bounds():
    none, every = np.zeros(10), np.ones(10)
    low, high = estimate([1.0], [none], 1.0).interval()
    assert low == 0 < high < 0.3
    assert estimate(DIFFERENCE, [none, none], 1.0).p == 1
    shown = estimate(DIFFERENCE, [every, none], 1.0)
    assert shown.p < 1e-6
    assert shown.interval()[1] == 1
    ratio = estimate(DIFFERENCE, [every, none], 1.0, ratio=True)
    assert 1 < ratio.interval()[0] < ratio.effect < ratio.interval()[1] < np.inf
    assert estimate([1.0], [np.array([0.4])], 1.0).interval() == (0, 1)  # one run


def test_the_ratio_is_that_of_the_means_and_an_interaction_the_ratio_of_ratios():
    groups = [RNG.beta(a, 8, 50) for a in (2, 3, 4, 5)]
    means = [one.mean() for one in groups]
    found = estimate(INTERACTION, groups, 1.0, ratio=True)
    assert found.effect == pytest.approx(means[0] / means[1] / (means[2] / means[3]))
    parts = [estimate(DIFFERENCE, pair, 1.0, ratio=True) for pair in (groups[:2], groups[2:])]
    assert found.error == pytest.approx(np.hypot(parts[0].error, parts[1].error))


# Shares, runs and cells of a run of each group, weights; the width at most, in points (of a ratio of its logarithm).
CASES = {
    "rare": ((0.05,), 40, 10, (1.0,), 12.0),
    "usual": ((0.3,), 200, 10, (1.0,), 7.0),
    "very rare": ((0.01,), 1000, 10, (1.0,), 0.8),
    "one cell": ((0.1,), 1000, 1, (1.0,), 3.8),
    "one cell, few runs": ((0.1,), 40, 1, (1.0,), 20.5),
    "one cell, rare": ((0.02,), 100, 1, (1.0,), 6.5),
    "two of one cell": ((0.15, 0.05), 96, 1, DIFFERENCE, 18.0),
    "interaction": ((0.3, 0.1, 0.2, 0.05), 40, 10, INTERACTION, 29.0),
    "rare interaction": ((0.02, 0.01, 0.05, 0.02), 200, 10, INTERACTION, 6.1),
    "groups without hits": ((0.0, 0.0, 0.3, 0.1), 100, 10, INTERACTION, 14.2),
}


@pytest.mark.parametrize("name", CASES)
def test_intervals_of_shares_cover(name):
    """Beta-binomial cells; a coverage below 95 % by more than chance, or a wasteful width, is a fault."""
    rates, runs, cells, weights, widest = CASES[name]
    rng = np.random.default_rng(7)
    low, high = estimate(weights, [shares(rng, p, runs, cells) for p in rates], 1.0).interval()
    truth = float(np.dot(weights, rates))
    assert np.mean((low <= truth) & (truth <= high)) >= 0.95 - SLACK
    assert 100 * np.mean(high - low) < widest


@pytest.mark.parametrize("paired", [False, True])
@pytest.mark.parametrize(("rates", "runs"), [((0.3, 0.1), 40), ((0.1, 0.05), 40), ((0.05, 0.05), 200)])
def test_intervals_of_ratios_cover(rates, runs, paired):
    rng = np.random.default_rng(8)
    low, high = estimate(
        DIFFERENCE, [shares(rng, p, runs, 10) for p in rates], 1.0, ratio=True, paired=paired
    ).interval()
    truth = rates[0] / rates[1]
    assert 0.95 - SLACK <= np.mean((low <= truth) & (truth <= high)) <= 0.99


@pytest.mark.parametrize(("p", "widest"), [(0.004, 5.4), (0.03, 7.0), (0.1, 9.2)])
def test_few_control_cells_outside_are_covered_by_few_runs(p, widest):
    """Of 47 cells of each of 8 runs; Student's interval of the shares covers 0.4 % in 71 % of the cases."""
    low, high = estimate([1.0], [shares(np.random.default_rng(9), p, 8, 47, 0.01)], 0.15).interval()
    assert np.mean((low <= p) & (p <= high)) >= 0.95 - SLACK
    assert 100 * np.mean(high - low) < widest


def test_runs_that_show_a_difference():
    """((1.96 + 0.8416)/0.1)^2 (0.21 + 0.24) = 353 for 30 % against 40 %; a fourth of them for twice the difference."""
    groups = [np.repeat((1.0, 0.0), (hits, 1000 - hits)) for hits in (300, 400, 500)]
    assert estimate(DIFFERENCE, groups[:2], 1.0).runs_to_show(1000) == pytest.approx(353, abs=2)
    assert estimate(DIFFERENCE, groups[::2], 1.0).runs_to_show(1000) < 100
    assert estimate(DIFFERENCE, [groups[0]] * 2, 1.0).runs_to_show(1000) is None


def alone(p):
    """An estimate with this p-value."""
    z = stats.norm.isf(np.asarray(p) / 2)
    return Estimate(z, z, np.ones(()), np.array(1e12), (-np.inf, np.inf), is_ratio=False)


@pytest.mark.parametrize("p", [(0.04, 0.01, 0.03, 0.5), (0.6, 0.9), (0.2, 0.011, 0.2, 0.0, 1.0, 0.011), (0.04,), ()])
def test_holm_is_that_of_statsmodels_and_intervals_agree_with_it(p):
    corrected, levels = holm(p)
    if p:
        np.testing.assert_allclose(corrected, multipletests(p, method="holm")[1], rtol=1e-14)
    assert ((levels >= 0.95 - 1e-12) & (levels < 1)).all()
    for one, found, level in zip(p, corrected, levels, strict=True):
        low, _ = alone(one).interval(level)
        assert (low > 0) == (found < 0.05)
