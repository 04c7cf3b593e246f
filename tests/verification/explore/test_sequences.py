"""Confidence sequences: they cover when one looks after every run."""

import numpy as np
import pytest

from dincl.errors import InvalidProblem
from verification.explore.sequences import bounded, runs_to_decide, unbounded

LOOKS, REPEATS = 200, 400
# Above 5 % by three standard deviations of a share of REPEATS.
MOST = 0.05 + 3 * np.sqrt(0.05 * 0.95 / REPEATS)


def shares(rng, share):
    """Of five cells of each run, which share a tissue: what one does, all do half of the time."""
    own, common = rng.random((LOOKS, 5)) < share, rng.random((LOOKS, 1)) < share
    return np.where(rng.random((LOOKS, 1)) < 0.5, common, own).mean(axis=1)


def of_two(values):
    return bounded(values, -1, 1)


CASES = {
    "rare": (lambda rng: rng.random(LOOKS) < 0.02, 0.02, bounded, 0.0, MOST),
    "often": (lambda rng: rng.random(LOOKS) < 0.3, 0.3, bounded, 0.0, MOST),
    "difference of rare": (lambda rng: shares(rng, 0.02) - shares(rng, 0.02), 0.0, of_two, 0.0, MOST),
    "difference of often": (lambda rng: shares(rng, 0.3) - shares(rng, 0.3), 0.0, of_two, 0.0, MOST),
    "normal": (lambda rng: rng.normal(50, 30.0, LOOKS), 50, unbounded, 0.0, MOST),
    "narrow": (lambda rng: rng.normal(50, 1e-3, LOOKS), 50, unbounded, 0.0, MOST),
    "difference of skewed": (lambda rng: -np.diff(rng.exponential(size=(LOOKS, 2)))[:, 0], 0, unbounded, 0.0, MOST),
    # The documentation says 7 %.
    "skewed": (lambda rng: rng.exponential(size=LOOKS), 1, unbounded, 0.03, 0.12),
}


@pytest.mark.slow_with("rare", "often", "difference of rare", "difference of often")
@pytest.mark.parametrize("name", CASES)
def test_the_mean_is_covered_at_all_numbers_of_runs(name):
    """The sequences are nested: what the last one encloses, all do."""
    draw, mean, enclose, least, most = CASES[name]
    rng = np.random.default_rng(11)
    ends = [enclose(draw(rng)) for _ in range(REPEATS)]
    assert least <= np.mean([not low <= mean <= high for low, high in ends]) <= most


def test_more_runs_never_widen_a_sequence_and_without_runs_nothing_is_known():
    values = np.random.default_rng(4).random(300)
    for enclose in (bounded, unbounded):
        ends = np.array([enclose(values[:n]) for n in range(0, 300, 20)])
        assert (np.diff(ends[:, 0]) >= -1e-12).all()
        assert (np.diff(ends[:, 1]) <= 1e-12).all()
        assert ends[-1, 0] < values.mean() < ends[-1, 1] < ends[-1, 0] + 0.2
    assert bounded(np.array([]), -1, 1) == (-1, 1)
    assert unbounded(np.array([])) == unbounded(np.array([2.0, 3.0])) == (-np.inf, np.inf)
    with pytest.raises(InvalidProblem, match="must be from 0 to 1"):
        bounded(np.array([0.5, 1.5]))


def test_runs_to_decide_are_those_at_which_most_sequences_have_decided():
    rng, n = np.random.default_rng(9), runs_to_decide(0.5, 1.0)
    decided = np.mean([unbounded(rng.normal(0.5, 1.0, n))[0] > 0 for _ in range(REPEATS)])
    assert 0.72 < decided < 0.92
    assert 20 < n < 100
    assert runs_to_decide(0.25, 1.0) > 3 * n
    assert runs_to_decide(100.0, 1.0) == 11  # of ten the sequence says nothing
    assert runs_to_decide(0.0, 1.0) is None
