"""Claims about ratios hold, do not hold or are not decided, by their intervals."""

import numpy as np
import pytest

from dincl.errors import InvalidProblem
from tissue.statistics.comparisons import Difference, runs_needed
from tissue.statistics.ratios import Ratio
from verification.thesis.chapter4.ratio_claims import ALIKE, against_printed, agrees, alike, more


def test_agreement_with_a_printed_ratio():
    """Two samples of the same ratio agree nearly always, at 99 %; one that is 15 points off does not."""
    rng = np.random.default_rng(8)
    pairs = rng.binomial(400, 0.1, (1000, 2))
    same = [agrees(against_printed(Ratio(int(a), 400), b / 400, 400)) for a, b in pairs]
    assert np.mean(same) == pytest.approx(0.99, abs=0.012)
    assert not agrees(against_printed(Ratio(100, 400), 0.1, 400))
    assert agrees(against_printed(Ratio(100, 400), 0.1, 10))
    with pytest.raises(InvalidProblem, match="printed = 30"):
        against_printed(Ratio(1, 2), 30, 400)


def test_claims():
    high, low = Ratio(300, 400), Ratio(200, 400)
    assert more("x", Difference(high, low), 400).verdict == "holds"
    assert more("x", Difference(low, high), 400).verdict == "does not hold"
    undecided = more("x", Difference(Ratio(12, 40), Ratio(10, 40)), 40)
    assert (undecided.verdict, undecided.needed) == ("not decided", runs_needed(0.3, 0.25, level=0.99))
    assert "30.0 % [18.1, 45.4] of 40 against 25.0 %" in undecided.text
    assert more("x", Difference(low, low), 400).needed is None


def test_claims_that_ratios_are_alike():
    near, far, same = Ratio(5300, 10_000), Ratio(8000, 10_000), Ratio(5000, 10_000)
    assert alike("x", Difference(near, same), 10_000).verdict == "holds"
    assert alike("x", Difference(same, far), 10_000).verdict == "does not hold"
    few = alike("x", Difference(Ratio(50, 100), Ratio(50, 100)), 100)
    assert few.verdict == "not decided"
    n = few.needed
    enough = Difference(Ratio(n // 2, n), Ratio(n // 2, n)).interval(0.99)
    assert -ALIKE < enough[0] < enough[1] < ALIKE
    assert alike("x", Difference(Ratio(60, 100), Ratio(50, 100)), 100).needed is not None
