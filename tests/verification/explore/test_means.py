"""Means and their differences are those of scipy.stats; so many runs as are said see a difference as often as said."""

import numpy as np
import pytest
from scipy import stats

from verification.explore.tissues.answer import difference, mean_of, means_of, runs_to_see

RNG = np.random.default_rng(3)
FIRST, SECOND = RNG.normal(1.0, 2.0, 12), RNG.normal(0.5, 0.7, 30)


def test_a_mean_has_students_interval():
    mean = mean_of(FIRST)
    low, high = stats.t.interval(0.95, 11, FIRST.mean(), stats.sem(FIRST))
    assert mean.interval() == pytest.approx((low, high), rel=1e-12)
    assert mean.value == FIRST.mean()
    value, below, above = means_of(np.column_stack((FIRST, 2 * FIRST)))
    assert value == pytest.approx([mean.value, 2 * mean.value])
    assert (below[1], above[1]) == pytest.approx((2 * low, 2 * high))


def test_a_difference_has_welchs_interval():
    value, low, high = difference(mean_of(FIRST), mean_of(SECOND))
    known = stats.ttest_ind(FIRST, SECOND, equal_var=False).confidence_interval(0.95)
    assert value == pytest.approx(FIRST.mean() - SECOND.mean())
    assert (low, high) == pytest.approx((known.low, known.high), rel=1e-12)


def test_means_without_spread_have_none_between_them():
    one, two = mean_of(np.ones(5)), mean_of(np.full(5, 3.0))
    assert difference(one, two) == (-2.0, -2.0, -2.0)
    assert runs_to_see(one, one) is None
    assert runs_to_see(one, two) == 2


def test_the_runs_needed_see_the_difference_in_four_cases_of_five():
    n = runs_to_see(mean_of(FIRST), mean_of(SECOND))
    gap, spreads = FIRST.mean() - SECOND.mean(), (FIRST.std(ddof=1), SECOND.std(ddof=1))
    first, second = (RNG.normal(mean, spread, (2000, n)) for mean, spread in zip((gap, 0.0), spreads, strict=True))
    seen = stats.ttest_ind(first, second, axis=1, equal_var=False).pvalue < 0.05
    assert seen.mean() == pytest.approx(0.8, abs=0.03)
