"""Ratios for claims about runs: three readings, one of which decides; comparisons; and how many runs they need."""

import numpy as np
import pytest

from dincl.errors import InvalidProblem
from tissue.statistics.comparisons import Difference
from tissue.statistics.ratios import Ratio
from verification.claims import Evidence, Verdict
from verification.thesis.chapter4 import frequencies
from verification.thesis.chapter4.frequencies import (
    CLAIM_LEVEL,
    MODEL,
    alike,
    averaged,
    evidence,
    in_readings,
    more,
    share,
)
from verification.thesis.chapter4.printed import against_printed, agrees


def test_runs_for_a_bound_are_those_of_the_textbook() -> None:
    """(1.96 sqrt(0.25) + 0.8416 sqrt(0.24))^2/0.1^2 = 193.9."""
    assert frequencies.runs_for_bound(0.6, 0.5, level=0.95) == 194
    assert frequencies.runs_for_bound(0.5, 0.5) is None
    assert frequencies.runs_for_bound(0.5, np.inf) is None


def test_outcomes_of_the_same_cells_differ_as_those_of_a_multinomial() -> None:
    """The variance of p - q is (p + q - (p - q)^2)/n."""
    found = frequencies.exclusive(Ratio(200, 400), Ratio(100, 400))
    p, q = found.first.value, found.second.value
    spread = [share * (1 - share) / 400 for share in (p, q)]
    variance = sum(spread) - 2 * found.correlation * np.sqrt(np.prod(spread))
    assert variance == pytest.approx((p + q - (p - q) ** 2) / 400)
    assert frequencies.runs_for_margin(found, 0.0, level=0.95) == 87  # (2.8016/0.25)^2 0.6875 = 86.3


def apart(count: int, other: int = 500) -> Difference:
    """A difference of two ratios of 1000 cells each."""
    return Difference(Ratio(count, 1000), Ratio(other, 1000))


@pytest.mark.parametrize(("count", "verdict"), [(700, Verdict.HOLDS), (300, Verdict.REFUTED), (500, Verdict.OPEN)])
def test_one_reading_decides(count: int, verdict: Verdict) -> None:
    def compare(preset: str) -> Evidence:
        return evidence([more("x", apart(count if preset == "published" else 1000 - count))])

    found = in_readings(compare)
    assert found.verdict is verdict
    opposite = {Verdict.HOLDS: Verdict.REFUTED, Verdict.REFUTED: Verdict.HOLDS, Verdict.OPEN: Verdict.OPEN}[verdict]
    assert [each.verdict for each in found.readings.values()] == [opposite, verdict, opposite]
    assert in_readings(compare, MODEL).verdict is opposite


def test_numbers_are_in_per_cent_and_points() -> None:
    """A lead of 20 points, and a ratio of 70 %, with 99 % intervals."""
    for sized in (more("x", apart(700)), alike("x", apart(700), 0.3), share("x", Ratio(700, 1000), 0.5)):
        found = sized.comparison
        assert found.value == pytest.approx(70 if "%" in found.what else 20)
        assert found.interval[1] - found.interval[0] == pytest.approx(7.5 if "%" in found.what else 11, abs=0.2)


def test_ratios_are_alike_within_a_margin() -> None:
    many = Difference(Ratio(53_000, 100_000), Ratio(50_000, 100_000))
    assert alike("x", many).comparison.true is True
    assert alike("x", many, 0.01).comparison.true is False
    assert alike("x", apart(600)).comparison.true is None


def test_runs_are_those_of_the_comparison_that_needs_most() -> None:
    found = [more("x", apart(900)), more("x", apart(600)), more("x", apart(500))]
    assert found[2].runs is None
    assert evidence(found).runs_needed == found[1].runs > found[0].runs


def test_the_mean_of_equal_differences_has_the_interval_of_all_cells() -> None:
    """Four differences of 1000 cells each are one of 4000, as long as normal intervals are good."""
    found = averaged([apart(600)] * 4)
    low, high = Difference(Ratio(2400, 4000), Ratio(2000, 4000)).interval(CLAIM_LEVEL)
    assert found.value == pytest.approx(0.1)
    assert found.interval == pytest.approx((low, high), abs=1e-3)
    assert averaged([apart(600), apart(500)], [3.0, 1.0]).value == pytest.approx(0.075)


def test_agreement_with_a_printed_ratio() -> None:
    """Two samples of the same ratio agree nearly always, at 99 %; one that is 15 points off does not."""
    rng = np.random.default_rng(8)
    pairs = rng.binomial(400, 0.1, (1000, 2))
    same = [agrees(against_printed(Ratio(int(a), 400), b / 400, 400)) for a, b in pairs]
    assert np.mean(same) == pytest.approx(0.99, abs=0.012)
    assert not agrees(against_printed(Ratio(100, 400), 0.1, 400))
    assert agrees(against_printed(Ratio(100, 400), 0.1, 10))
    with pytest.raises(InvalidProblem, match="printed = 30"):
        against_printed(Ratio(1, 2), 30, 400)


def test_runs_for_a_margin_shrink_with_the_square_of_the_distance() -> None:
    """((1.96 + 0.8416)/0.1)^2 (0.25 + 0.25) = 392.4 for two equal ratios of a half."""
    found = Difference(Ratio(500, 1000), Ratio(500, 1000))
    assert frequencies.runs_for_margin(found, 0.1, level=0.95) == 393
    assert frequencies.runs_for_margin(found, 0.2, level=0.95) == 99
    assert frequencies.runs_for_margin(Difference(Ratio(3, 4), Ratio(1, 4)), 0.5) is None


def test_runs_by_the_width_of_an_interval_are_those_of_the_difference() -> None:
    """Half the width is 1.96 sqrt((0.24 + 0.25)/n)."""
    found = Difference(Ratio(600, 1000), Ratio(500, 1000))
    half = 1.959964 * np.sqrt(0.49 / 1000)
    expected = frequencies.runs_for_margin(found, 0.0)
    assert frequencies.runs_by_width(1000, (0.1 - half, 0.1 + half), 0.95) == pytest.approx(expected, abs=1)
    assert frequencies.runs_by_width(1000, (-0.1, 0.1), 0.95) is None
