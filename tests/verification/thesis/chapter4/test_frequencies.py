"""Ratios for claims about runs: what two models say together, and how many runs a difference would need."""

import numpy as np
import pytest

from tissue.statistics.comparisons import Difference
from tissue.statistics.ratios import Ratio
from verification.claims import Evidence, Verdict
from verification.thesis.chapter4 import frequencies
from verification.thesis.chapter4.studies import PRESETS


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


def by_model(**counts: int) -> dict[str, Difference]:
    """Differences from a half, of 1000 cells each; those of models that are not given are none."""
    return {preset: Difference(Ratio(counts.get(preset, 500), 1000), Ratio(500, 1000)) for preset in PRESETS}


def test_one_model_decides() -> None:
    def found(*counts: int) -> Verdict:
        kinds = [by_model(corrected=count, thesis=1000 - count) for count in counts]
        return Evidence("", (frequencies.more("", *kinds),)).verdict

    assert found(700) is Verdict.HOLDS
    assert found(300) is Verdict.REFUTED
    assert found(500) is Verdict.OPEN


def test_kinds_of_cells_that_differ_decide_nothing() -> None:
    kinds = [by_model(corrected=count) for count in (700, 400)]
    assert Evidence("", (frequencies.more("", *kinds),)).verdict is Verdict.OPEN


def test_what_is_told_begins_with_the_model_that_decides() -> None:
    told = frequencies.told(by_model(corrected=700, thesis=400))
    assert told.startswith("+20.0 [")
    assert told.endswith("points (as printed -10.0, published +0.0)")


def test_runs_for_a_margin_shrink_with_the_square_of_the_distance() -> None:
    """((1.96 + 0.8416)/0.1)^2 (0.25 + 0.25) = 392.4 for two equal ratios of a half."""
    found = Difference(Ratio(500, 1000), Ratio(500, 1000))
    assert frequencies.runs_for_margin(found, 0.1, level=0.95) == 393
    assert frequencies.runs_for_margin(found, 0.2, level=0.95) == 99
    assert frequencies.runs_for_margin(Difference(Ratio(3, 4), Ratio(1, 4)), 0.5) is None


def test_runs_for_several_differences_are_those_of_the_smallest() -> None:
    large, small, none = (by_model(corrected=count, thesis=501) for count in (900, 600, 500))
    assert frequencies.needed(large, small, none) == frequencies.needed(small)
    assert frequencies.needed(large) < frequencies.needed(small)
    assert frequencies.needed(none) is None


def test_runs_by_the_width_of_an_interval_are_those_of_the_difference() -> None:
    """Half the width is 1.96 sqrt((0.24 + 0.25)/n)."""
    found = Difference(Ratio(600, 1000), Ratio(500, 1000))
    half = 1.959964 * np.sqrt(0.49 / 1000)
    expected = frequencies.runs_for_margin(found, 0.0)
    assert frequencies.runs_by_width(1000, (0.1 - half, 0.1 + half), 0.95) == pytest.approx(expected, abs=1)
    assert frequencies.runs_by_width(1000, (-0.1, 0.1), 0.95) is None
