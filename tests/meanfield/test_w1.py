"""W1 against closed forms, SciPy, mpmath, assignment problems, and its own axioms."""

from itertools import pairwise

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from scipy.optimize import linear_sum_assignment
from scipy.stats import wasserstein_distance

from dincl import InvalidProblem
from meanfield import Density, Panels, SolveFailed, Weighted, transport, w1

UNIFORM, NORMAL = Density.uniform(0.0, 1.0), Density.normal(0.0, 1.0)
HALVES = Panels(np.array([0.0, 0.5, 1.0]), np.array([[0.4], [1.6]]))


CLOSED = {
    "uniform against uniform, shifted within": (UNIFORM, Density.uniform(0.3, 1.3), 0.3),
    "uniform against uniform, apart": (UNIFORM, Density.uniform(5.0, 6.0), 5.0),
    "uniform against wider": (UNIFORM, Density.uniform(-1.0, 2.0), 0.5),
    "uniform against point inside": (UNIFORM, [0.25], (0.25**2 + 0.75**2) / 2),
    "uniform against point outside": ([2.0], UNIFORM, 1.5),
    "normal against shifted": (NORMAL, Density.normal(0.7, 1.0), 0.7),
    "normal against wider": (NORMAL, Density.normal(0.0, 3.0), 2 * np.sqrt(2 / np.pi)),
    "normal against its mean": (NORMAL, [0.0], np.sqrt(2 / np.pi)),
    "grid against uniform": (HALVES, UNIFORM, 0.15),
    "grid against point": (HALVES, [0.0], 0.25 * 0.2 + 0.75 * 0.8),
    "points": ([0.0, 1.0], [0.0, 0.0, 3.0], 2 / 3 + 1 / 6),
    "weighted points": (Weighted([1.0, 0.0], [0.25, 0.75]), Weighted([0.0, 2.0, 9.0], [0.5, 0.5, 0.0]), 0.75),
    "the same": (NORMAL, NORMAL, 0.0),
    "with (n, 1) points": ([[0.0], [1.0]], [0.5], 0.5),
}


@pytest.mark.parametrize("name", CLOSED)
def test_closed_forms(name):
    a, b, expected = CLOSED[name]
    assert w1(a, b) == pytest.approx(expected, rel=1e-14, abs=1e-14)
    assert w1(b, a) == pytest.approx(expected, rel=1e-14, abs=1e-14)


@pytest.mark.parametrize("n", [1, 7, 20_000])
def test_quantiles_of_a_uniform_density_are_at_1_over_4n(n):
    assert w1(UNIFORM.quantiles(n), UNIFORM) == pytest.approx(1 / (4 * n), rel=1e-13)


def test_points_against_points_agree_with_scipy(rng):
    x, y, w, u = rng.normal(size=500), rng.normal(0.5, 2.0, 300), rng.random(500), rng.random(300)
    assert w1(x, y) == pytest.approx(wasserstein_distance(x, y), rel=1e-13)
    weighted = w1(Weighted(x, w / w.sum()), Weighted(y, u / u.sum()))
    assert weighted == pytest.approx(wasserstein_distance(x, y, w, u), rel=1e-13)


def test_points_against_a_density_agree_with_mpmath():
    points = [-1.3, 0.1, 0.4, 2.2]
    with mpmath.workdps(30):
        total = mpmath.mpf(0)
        for k, (low, high) in enumerate(pairwise([-12.0, *points, 12.0])):
            cross = mpmath.sqrt(2) * mpmath.erfinv(mpmath.mpf(k) / 2 - 1) if 0 < k < 4 else low
            ends = [low, cross, high] if low < cross < high else [low, high]
            total += mpmath.quad(lambda x, c=k / 4: abs(mpmath.ncdf(x) - c), ends)
    assert w1(points, NORMAL) == pytest.approx(float(total), rel=1e-13)


def test_densities_whose_distributions_cross_often():
    wave = Density(lambda x: 1 + np.cos(40 * np.pi * x[:, 0]), [0.0], [1.0])
    # F - x = sin(40 pi x) / (40 pi).
    assert w1(wave, UNIFORM) == pytest.approx(2 / np.pi / (40 * np.pi), rel=1e-12)


@given(*[arrays.arrays(float, n, elements=st.floats(-10, 10, allow_subnormal=False)) for n in (3, 4, 5)])
@settings(max_examples=25)
def test_axioms_of_a_metric_on_a_line(x, y, z):
    assert w1(x, x) == 0.0
    assert w1(x, y) == w1(y, x)
    assert w1(x, z) <= w1(x, y) + w1(y, z) + 1e-13
    assert w1(x, NORMAL) <= w1(x, y) + w1(y, NORMAL) + 1e-13
    assert w1(x, y) >= abs(x.mean() - y.mean()) - 1e-13


@pytest.mark.parametrize("most", [10**9, 0])
@pytest.mark.parametrize("d", [2, 3])
def test_space_against_assignment_and_translation(d, most, rng, monkeypatch):
    """Test transport with the matrix of distances, and with distances computed on the way."""
    monkeypatch.setattr(transport, "MATRIX_PAIRS", most)
    x, y = rng.random((2, 300, d))
    costs = np.linalg.norm(x[:, None] - y, axis=2)
    assert w1(x, y) == pytest.approx(costs[linear_sum_assignment(costs)].mean(), rel=1e-13)
    w = rng.random(300) * (rng.random(300) < 0.9)
    shift = np.full(d, 0.03)
    assert w1(Weighted(x, w / w.sum()), Weighted(x + shift, w / w.sum())) == pytest.approx(0.03 * np.sqrt(d), rel=1e-10)
    assert w1(x, x[::-1]) == pytest.approx(0.0, abs=1e-11)
    assert w1(np.ones((3, d)), np.ones((2, d))) == 0.0
    # Of two clouds of diameter sqrt d that are far apart, W1 is the distance of the means but for d / distance.
    apart = np.linalg.norm(y.mean(axis=0) + 300.0 - x.mean(axis=0))
    assert apart <= w1(x, y + 300.0) <= apart + d / 300


def test_a_simplex_method_that_stops_early_is_an_error(rng, monkeypatch):
    monkeypatch.setattr(transport, "MAX_PIVOTS", 10)
    with pytest.raises(SolveFailed, match="numItermax"):
        w1(rng.random((50, 2)), rng.random((50, 2)))


BAD = {
    "a = .*shape": ([], [1.0]),
    "b = nan": ([1.0], [1.0, np.nan]),
    "b has 2 dimensions": (UNIFORM, np.ones((3, 2))),
    "b has 3 dimensions": (np.ones((3, 2)), np.ones((3, 3))),
    "a is a density in 2": (Density.uniform([0, 0], [1, 1]), np.ones((3, 2))),
    "least -0.5": (Weighted([0.0, 1.0], [1.5, -0.5]), [0.0]),
    "sum 0.9": ([0.0], Weighted([0.0, 1.0], [0.4, 0.5])),
    "a.weights": (Weighted([0.0, 1.0], [1.0]), [0.0]),
    "a = 'text'": ("text", [0.0]),
    "must be at most 1000000000 pairs": (np.arange(80_000.0).reshape(-1, 2), np.ones((25_001, 2))),
}


@pytest.mark.parametrize("message", BAD)
def test_bad_input_is_refused_by_name(message):
    with pytest.raises(InvalidProblem, match=message):
        w1(*BAD[message])
