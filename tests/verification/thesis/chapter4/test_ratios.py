"""Ratios of cells with their effective numbers: against intervals of others, their coverage, and by category."""

import numpy as np
import pandas as pd
import pytest
from scipy.stats import binomtest

from dincl.errors import InvalidProblem
from verification.thesis.chapter4.ratios import Ratio, difference, effective_size, ratio, ratios, wilson

TRIALS = 600
SLACK = 5 * (0.95 * 0.05 / TRIALS) ** 0.5


@pytest.mark.parametrize(("count", "of"), [(0, 1), (1, 1), (3, 10), (120, 400), (400, 400)])
def test_intervals_are_wilsons_and_differences_newcombes(count: int, of: int) -> None:
    known = binomtest(count, of).proportion_ci(0.99, method="wilson")
    assert Ratio(count, of).interval(0.99) == pytest.approx((known.low, known.high), abs=1e-14)
    # Newcombe (1998), Table II, method 10.
    assert difference(Ratio(56, 70), Ratio(48, 80)).interval() == pytest.approx((0.0524, 0.3339), abs=5e-5)
    assert difference(Ratio(9, 10), Ratio(3, 10)).interval() == pytest.approx((0.1705, 0.8090), abs=5e-5)


@pytest.mark.parametrize(
    ("count", "of", "effective"), [(1, 0, None), (3, 2, None), (-1, 2, None), (1, 2, 3), (1, 2, 0)]
)
def test_ratios_that_can_not_be(count: int, of: int, effective: float | None) -> None:
    with pytest.raises(InvalidProblem, match="must"):
        Ratio(count, of, effective)


def test_effective_numbers_of_cells_alone_and_of_equal_cells() -> None:
    assert effective_size([1, 0, 0, 1, 1], [1] * 5) == pytest.approx(5)
    assert effective_size([10, 0] * 500, [10] * 1000) == pytest.approx(1000, rel=0.01)
    assert effective_size([5] * 1000, [10] * 1000) == 10_000  # better than independent, but not counted so


@pytest.mark.parametrize(("p", "rho"), [(0.05, 0.5), (0.3, 0.1), (0.9, 0.3)])
def test_intervals_of_clustered_cells_cover_and_plain_ones_do_not(p: float, rho: float) -> None:
    rng = np.random.default_rng(7)
    hits = rng.binomial(10, rng.beta(p * (1 / rho - 1), (1 - p) * (1 / rho - 1), (TRIALS, 60)))
    sizes = np.array([effective_size(row, np.full(60, 10)) for row in hits])
    for size, covers in ((sizes, True), (np.full(TRIALS, 600.0), False)):
        low, high = wilson(hits.sum(axis=1) / 600, size)
        assert (np.mean((low <= p) & (p <= high)) >= 0.95 - SLACK) == covers


def test_ratios_of_categories() -> None:
    rng = np.random.default_rng(1)
    replicate, hit = pd.Series(np.repeat(np.arange(40), 6)), pd.Series(rng.random(240) < 0.3)
    kind = pd.Series(rng.choice(np.array(["b", "a"]), 240)).where(hit.index != 3, None)
    found = ratios(hit, replicate, kind)
    assert list(found.index) == ["a", "b"]
    assert found["of"].sum() == 239
    for name, row in found.iterrows():
        mine = kind == name
        one = ratio(hit[mine], replicate[mine])
        assert (row["count"], row["of"], row["effective"]) == (one.count, one.of, one.size)
        assert (row["low"], row["high"]) == one.interval()
        assert row["runs"] == replicate[mine].nunique()
