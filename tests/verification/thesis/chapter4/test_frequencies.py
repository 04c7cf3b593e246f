"""Ratios for claims about runs: three readings, one of which decides; comparisons; and how many runs they need."""

import numpy as np
import pytest

from dincl.errors import InvalidProblem
from verification.claims import Evidence, Verdict
from verification.thesis.chapter4 import frequencies
from verification.thesis.chapter4.claims import s4_1_isolated
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
from verification.thesis.chapter4.ratios import ProportionContrast, Ratio, difference


def apart(count: int, other: int = 500) -> ProportionContrast:
    """A difference of two ratios of 1000 cells each."""
    return difference(Ratio(count, 1000), Ratio(other, 1000))


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
    many = difference(Ratio(53_000, 100_000), Ratio(50_000, 100_000))
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
    low, high = difference(Ratio(2400, 4000), Ratio(2000, 4000)).interval(CLAIM_LEVEL)
    assert found.value == pytest.approx(0.1)
    assert found.interval(CLAIM_LEVEL) == pytest.approx((low, high), abs=1e-3)
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


def test_runs_by_the_width_of_an_interval_shrink_with_the_square_of_the_distance() -> None:
    """n = 1000 (h/m (2.576 + 0.842)/2.576)^2."""
    assert frequencies.runs_by_width(1000, 0.2, (0.1, 0.3)) == 441
    assert frequencies.runs_by_width(1000, 0.4, (0.3, 0.5)) == 111
    assert frequencies.runs_by_width(1000, 0.0, (-0.1, 0.1)) is None


def test_runs_for_a_bound_are_those_of_the_textbook() -> None:
    """((2.576 + 0.8416)/0.1)^2 (0.25 + 0.25) = 584 for two equal ratios of a half and a margin of ten points."""
    equal = difference(Ratio(500, 1000), Ratio(500, 1000))
    assert frequencies.runs_for_bound(equal, 0.1) == 584
    assert frequencies.runs_for_bound(equal, 0.2) == 146
    assert frequencies.runs_for_bound(equal, 0.0) is None
    assert frequencies.runs_for_bound(difference(Ratio(0, 9), Ratio(9, 9)), 0.0) is None


def test_outcomes_that_exclude_each_other_are_compared_among_the_cells_with_one_of_both() -> None:
    assert s4_1_isolated.of_both(Ratio(30, 400), Ratio(10, 400)) == Ratio(30, 40)


def test_a_multiple_of_a_ratio_has_the_interval_of_both_sides() -> None:
    """p - 1.5 q is below 0 for p = q, and near 0 for p = 1.5 q."""
    for count, true in ((500, False), (750, None), (999, True)):
        contrast = ProportionContrast((1.0, -1.5), (Ratio(count, 1000), Ratio(500, 1000)))
        assert more("x", contrast).comparison.true is true
