"""Planned contrasts: intervals beside those of statsmodels, coverage, and corrections for what was planned."""

import numpy as np
import pandas as pd
import pytest
from scipy import stats
from statsmodels.stats.proportion import confint_proportions_2indep

from dincl.errors import InvalidProblem
from tissue.statistics.comparisons import Difference
from tissue.statistics.contrasts import Family, MeanContrast, ProportionContrast, RatioContrast, p_value
from tissue.statistics.proportions import corrected
from tissue.statistics.ratios import Ratio

RATIOS = (Ratio(30, 2000, 1500.0), Ratio(159, 2000, 1400.0), Ratio(255, 2000), Ratio(477, 2000, 1200.0))
SIMPLE = ((-1.0, 1.0, 0.0, 0.0), (0.0, 0.0, -1.0, 1.0))
INTERACTION = (1.0, -1.0, -1.0, 1.0)


def test_a_difference_of_two_is_newcombes():
    one = ProportionContrast(SIMPLE[0], RATIOS)
    other = Difference(RATIOS[1], RATIOS[0])
    assert one.value == pytest.approx(other.value)
    assert one.interval(0.9) == pytest.approx(other.interval(0.9))


def test_a_ratio_of_two_is_that_of_statsmodels():
    first, second = Ratio(159, 2000), Ratio(30, 2000)
    found = RatioContrast((1.0, -1.0), (first, second)).interval(0.99)
    known = confint_proportions_2indep(159, 2000, 30, 2000, compare="ratio", method="log-adjusted", alpha=0.01)
    assert found == pytest.approx(known)


def test_the_interaction_of_ratios_is_the_ratio_of_two_ratios():
    one, other = (RatioContrast(weights, RATIOS).value for weights in SIMPLE)
    assert RatioContrast(INTERACTION, RATIOS).value == pytest.approx(other / one)


def test_groups_without_hits_have_finite_intervals():
    none = (Ratio(0, 40), Ratio(0, 40))
    for kind in (ProportionContrast, RatioContrast):
        one = kind((1.0, -1.0), none)
        low, high = one.interval()
        assert low < one.null < high
        assert one.value == one.null
        assert p_value(one) == 1


def test_means_are_compared_as_welch_does():
    rng = np.random.default_rng(3)
    groups = tuple(rng.normal(mean, spread, n) for mean, spread, n in ((50, 2, 12), (52, 4, 30), (1, 1, 5)))
    one = MeanContrast((-1.0, 1.0, 0.0), groups)
    welch = stats.ttest_ind(groups[1], groups[0], equal_var=False)
    assert one.interval() == pytest.approx(tuple(welch.confidence_interval()))
    assert p_value(one) == pytest.approx(welch.pvalue, rel=1e-4)
    equal = MeanContrast((1.0, -1.0), (np.full(4, 2.0), np.full(5, 2.0)))
    assert p_value(equal) == 1


def test_runs_without_any_spread_show_no_difference():
    one = MeanContrast((1.0, -1.0), (np.full(2, 1.0), np.full(2, 0.0)))
    assert one.interval() == (-np.inf, np.inf)
    assert MeanContrast((1.0, -1.0), (np.full(3, 0.1), np.full(7, 0.7))).interval() == (-np.inf, np.inf)
    family = Family(((one, one),))
    assert family.level_of_each == 0.95
    assert family.p_values() == [1, 1]


def test_the_p_value_is_where_the_interval_ends_at_no_effect():
    one = ProportionContrast(INTERACTION, RATIOS)
    p = p_value(one)
    low, high = one.interval(1 - p)
    assert min(abs(low), abs(high)) < 1e-6
    assert 1e-15 < p_value(ProportionContrast(SIMPLE[0], RATIOS)) < 1e-12


@pytest.mark.slow
@pytest.mark.parametrize("rates", [(0.015, 0.08, 0.128, 0.238), (0.5, 0.5, 0.5, 0.5), (0.02, 0.02, 0.02, 0.02)])
def test_intervals_of_an_interaction_cover(rates):
    rng, truth, size = np.random.default_rng(5), float(np.dot(INTERACTION, rates)), 120
    counts = rng.binomial(size, rates, (2000, 4))
    ends = [ProportionContrast(INTERACTION, tuple(Ratio(int(n), size) for n in row)).interval() for row in counts]
    covered = np.mean([low <= truth <= high for low, high in ends])
    assert 0.935 < covered < 0.985  # more where hits are few


@pytest.mark.slow
def test_several_comparisons_are_corrected_as_their_correlation_allows():
    block = tuple(ProportionContrast(weights, RATIOS) for weights in (*SIMPLE, INTERACTION))
    together, alone = Family((block,)), Family((block,), "holm")
    # Bonferroni would need 1 - 0.05/3; two independent ones and their difference need less.
    assert 0.95 < together.level_of_each < alone.level_of_each == pytest.approx(1 - 0.05 / 3)
    rng = np.random.default_rng(8)
    errors = np.array([one.errors for one in block])
    found = np.abs(rng.standard_normal((200_000, 4)) @ errors.T / np.linalg.norm(errors, axis=1)).max(axis=1)
    z = stats.norm.ppf(0.5 + together.level_of_each / 2)
    assert np.mean(found <= z) == pytest.approx(0.95, abs=0.002)
    p = together.p_values()
    assert all(one <= both <= 3 * one for one, both in zip(map(p_value, block), p, strict=True))
    assert alone.p_values() == pytest.approx(corrected(pd.Series(list(map(p_value, block)))).tolist())


@pytest.mark.slow
def test_any_false_finding_has_the_chance_that_is_stated():
    """Four equal groups of 300 cells; effects, their interaction, and ratios of the same: six comparisons."""
    rng, false = np.random.default_rng(14), 0
    for row in rng.binomial(300, 0.2, (600, 4)):
        ratios = tuple(Ratio(int(n), 300) for n in row)
        block = tuple(kind(w, ratios) for kind in (ProportionContrast, RatioContrast) for w in (*SIMPLE, INTERACTION))
        family = Family((block,))
        ends = [(one.null, *one.interval(family.level_of_each)) for one in block]
        false += any(not low <= null <= high for null, low, high in ends)
    assert 0.025 < false / 600 < 0.075


def test_differences_and_ratios_of_the_same_groups_are_correlated():
    differences, ratios = ([kind(w, RATIOS) for w in SIMPLE] for kind in (ProportionContrast, RatioContrast))
    apart, together = Family((tuple(differences), tuple(ratios))), Family(((*differences, *ratios),))
    assert together.level_of_each < apart.level_of_each - 1e-3
    assert together.level_of_each > Family((tuple(differences),)).level_of_each


@pytest.mark.slow
def test_one_comparison_alone_is_not_corrected():
    family = Family(((ProportionContrast(INTERACTION, RATIOS),),))
    assert family.level_of_each == pytest.approx(0.95)
    assert family.p_values() == [p_value(family.blocks[0][0])]


def test_equal_comparisons_twice_cost_nothing():
    one = ProportionContrast(INTERACTION, RATIOS)
    assert Family(((one, one),)).level_of_each == pytest.approx(0.95, abs=1e-3)
    assert Family(((one,), (one,))).level_of_each == pytest.approx(0.95**0.5, abs=1e-3)  # as if independent


def test_an_unknown_correction_is_refused():
    with pytest.raises(InvalidProblem, match="correction = 'none': must be one of simultaneous, holm"):
        Family((), "none")


def test_an_effect_in_every_run_is_shown():
    """Ten runs of each in which all cells left, beside ten in which none did."""
    ratios = scenario_like(0), scenario_like(10)
    one = ProportionContrast((-1.0, 1.0), ratios)
    assert Family(((one,),)).p_values()[0] == p_value(one) < 1e-4


def scenario_like(hits):
    from tissue.statistics.ratios import ratio

    return ratio(pd.Series(np.arange(10) < hits), pd.Series(np.arange(10)))
