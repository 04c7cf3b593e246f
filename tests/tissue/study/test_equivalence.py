"""Equivalence tests: beside those of statsmodels, and how often "enough" is said of a bias of the tolerance."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.random import Generator
from numpy.typing import NDArray
from statsmodels.stats.weightstats import ttost_paired

from dincl.errors import InvalidProblem
from tissue.statistics.equivalence import ERROR, LOOKS, equivalence

Floats = NDArray[np.float64]
REPETITIONS, TOLERANCE = 2000, 0.03


@pytest.mark.parametrize("bias", [0.0, 0.05, 0.12, 0.3, 0.6])
def test_numbers_are_decided_as_statsmodels_decides(bias: float) -> None:
    rng = np.random.default_rng(7)
    full = rng.normal(7.0, 1.0, 256)
    simple = full + rng.normal(bias, 0.5, 256)
    found = equivalence(simple - full, 0.2, shares=False, level=0.01)
    p, *_ = ttost_paired(simple, full, -0.2, 0.2)
    assert (found.verdict == "enough") == (p < 0.01)
    assert found.bias == pytest.approx((simple - full).mean())


def rare(q: float) -> Callable[[Generator, tuple[int, int]], Floats]:
    """Return draws of differences of one cell a run: 1 with probability TOLERANCE + q, -1 with q, else 0."""
    return lambda rng, shape: np.asarray((u := rng.random(shape)) < TOLERANCE + q, float) - (u > 1 - q)


def groups(rng: Generator, shape: tuple[int, int]) -> Floats:
    """Draw differences of ten cells a run, whose odds vary from run to run; their mean is TOLERANCE."""
    odds = rng.beta(2.0, 6.0, shape)
    full = rng.binomial(10, odds * 0.9, shape)
    return np.asarray((rng.binomial(10, odds * 0.9 + TOLERANCE, shape) - full) / 10)


def gaussian(rng: Generator, shape: tuple[int, int]) -> Floats:
    return rng.normal(TOLERANCE, 0.2, shape)


CASES = [(rare(q), True) for q in (0.0, 0.002, 0.005, 0.02, 0.1)] + [(groups, True), (gaussian, False)]


@pytest.mark.slow_with("groups-True")
@pytest.mark.parametrize(("draw", "shares"), CASES)
@pytest.mark.parametrize("sign", [1, -1])
def test_a_bias_of_the_tolerance_is_seldom_called_enough(
    draw: Callable[[Generator, tuple[int, int]], Floats], shares: bool, sign: int
) -> None:
    looks = [n for n in LOOKS if n <= 2048]
    differences = sign * draw(np.random.default_rng(11), (REPETITIONS, looks[-1]))
    said = sum(
        any(equivalence(one[:n], TOLERANCE, shares=shares).verdict == "enough" for n in looks) for one in differences
    )
    assert said / REPETITIONS <= ERROR


def test_a_model_without_bias_is_found_to_be_enough() -> None:
    rng = np.random.default_rng(5)
    found = equivalence(rng.choice([-1.0, 0.0, 1.0], 4096, p=[0.03, 0.94, 0.03]), TOLERANCE, shares=True)
    assert found.verdict == "enough"
    assert found.missing is None


def test_missing_runs_are_those_after_which_most_repetitions_decide() -> None:
    rng = np.random.default_rng(3)
    first = equivalence(rng.normal(0.01, 0.2, 64), TOLERANCE, shares=False)
    assert first.verdict == "open"
    assert first.missing is not None
    n = first.runs + first.missing
    again = rng.normal(first.bias, first.spread, (400, n))
    decided = np.mean([equivalence(one, TOLERANCE, shares=False).verdict != "open" for one in again])
    assert 0.7 < decided < 0.95


def test_a_bias_far_beyond_the_tolerance_is_not_enough() -> None:
    assert equivalence(np.full(64, 0.5), TOLERANCE, shares=True).verdict == "not enough"
    assert equivalence(np.full(64, -0.5), TOLERANCE, shares=False).verdict == "not enough"


@pytest.mark.parametrize("tolerance", [0, -1, float("nan"), True, "3 points", 1.0])
def test_a_tolerance_is_a_positive_number(tolerance: object) -> None:
    with pytest.raises(InvalidProblem, match=r"tolerance = .*: must be a number above 0"):
        equivalence(np.zeros(64), tolerance, shares=True)  # type: ignore[arg-type]


def test_differences_must_be_finite() -> None:
    with pytest.raises(InvalidProblem, match="must be finite"):
        equivalence(np.array([0.0, np.nan]), 0.1, shares=True)
