"""W1 against closed forms, SciPy, mpmath, all permutations, and its own axioms; proved bounds of exact transport."""

from itertools import pairwise, permutations, product

import mpmath
import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from scipy.optimize import linear_sum_assignment
from scipy.stats import wasserstein_distance

from dincl import InvalidProblem
from meanfield import Density, Panels, SolveFailed, Weighted, w1
from meanfield.transport import discrete
from verification.instruments.rates import IID, PAIR, QUANTILES
from verification.thesis.chapter5 import sampling

UNIFORM, NORMAL = Density.uniform(0.0, 1.0), Density.normal(0.0, 1.0)
HALVES = Panels.piecewise_constant([0.0, 0.5, 1.0], [0.4, 1.6])


@pytest.fixture
def few_pairs(monkeypatch):
    """Lower the size from which coarser points are used, so that 500 points take several levels."""
    monkeypatch.setattr(discrete, "ALL_PAIRS", 2000)


def equal(n):
    return np.full(n, 1 / n)


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


def test_many_points(rng):
    x = rng.random(300_000)
    assert w1(x, x + 0.25) == pytest.approx(0.25, abs=1e-13)


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


def test_plane_against_all_permutations(rng):
    x, y = rng.normal(size=(2, 5, 2))
    best = min(np.linalg.norm(x - y[list(order)], axis=1).mean() for order in permutations(range(5)))
    assert w1(x, y) == pytest.approx(best, rel=1e-13)


def test_points_on_a_line_in_space_are_as_far_apart_as_on_the_line(rng):
    x, y, w = rng.normal(size=200), rng.normal(size=150), rng.random(150)
    direction = np.array([2.0, -1.0, 2.0]) / 3
    w /= w.sum()
    in_space = w1(np.outer(x, direction), Weighted(np.outer(y, direction), w))
    assert in_space == pytest.approx(w1(x, Weighted(y, w)), rel=1e-10)


@pytest.mark.usefixtures("few_pairs")
@pytest.mark.parametrize("d", [2, 3])
def test_few_pairs_give_the_distance_of_all_pairs(d, rng):
    x, y = rng.random((2, 500, d))
    costs = np.linalg.norm(x[:, None] - y, axis=2)
    exact = costs[linear_sum_assignment(costs)].mean()
    found = discrete.bounds(x, equal(500), y, equal(500))
    assert found.upper == pytest.approx(exact, rel=1e-13)
    assert found.lower == pytest.approx(exact, rel=1e-9)
    rough = discrete.bounds(x, equal(500), y, equal(500), 0.05)
    assert exact * 0.95 <= rough.lower <= exact * (1 + 1e-12)
    assert exact * (1 - 1e-12) <= rough.upper


@pytest.mark.usefixtures("few_pairs")
def test_few_pairs_of_weighted_points_on_a_lattice(rng):
    # The dual variables of a lattice are far from unique. Moving all mass by (3, 4) / 100 costs 0.05 for all weights.
    x = np.array(list(product(np.linspace(0, 1, 18), repeat=2)))
    w = rng.random(len(x)) * (rng.random(len(x)) < 0.9)
    w /= w.sum()
    assert w1(Weighted(x, w), Weighted(x + np.array([0.03, 0.04]), w)) == pytest.approx(0.05, rel=1e-10)


@pytest.mark.usefixtures("few_pairs")
def test_equal_clouds_are_at_distance_zero(rng):
    x = rng.random((400, 2))
    assert w1(x, x[::-1]) == pytest.approx(0.0, abs=1e-11)
    assert w1(np.ones((3, 2)), np.ones((2, 2))) == 0.0


def test_points_in_one_place_are_one_point():
    x = np.repeat([[0.0, 0.0], [1.0, 0.0]], [300_000, 100_000], axis=0)
    assert w1(x, [[0.0, 0.0]]) == pytest.approx(0.25, abs=1e-11)


@pytest.mark.usefixtures("few_pairs")
def test_clouds_far_apart(rng):
    x, y = rng.random((2, 300, 2))
    shift = np.array([300.0, 400.0])
    # Of two clouds of diameter sqrt 2 that are 500 apart, W1 is the distance of the means but for 2 / 500.
    apart = np.linalg.norm(y.mean(axis=0) + shift - x.mean(axis=0))
    assert apart <= w1(x, y + shift) <= apart + 2 / 500


@pytest.mark.usefixtures("few_pairs")
def test_too_few_rounds_are_an_error(rng, monkeypatch):
    monkeypatch.setattr(discrete, "MAX_ROUNDS", 1)
    with pytest.raises(SolveFailed, match="pairs are still violated"):
        w1(*rng.random((2, 500, 2)))


def test_a_simplex_method_that_stops_early_is_an_error(rng, monkeypatch):
    monkeypatch.setattr(discrete, "MAX_PIVOTS", 10)
    with pytest.raises(SolveFailed, match="numItermax"):
        w1(rng.random((50, 2)), rng.random((50, 2)))


def synthetic(d, law):
    """Build 40 values for each size, alternately 10 % above and below the law."""
    counts = np.repeat([10, 100, 300, 1000, 3000], 40)
    values = law(counts) * (1 + 0.1 * np.tile([-1, 1], 100))
    rows = {"d": d, "start": PAIR, "N": counts, "w1": values, "seconds": 0.0}
    return sampling.means(pd.DataFrame(rows))


@pytest.mark.parametrize("p", [-0.5, -1 / 3])
def test_the_exponent_of_synthetic_rates_is_found(p):
    found = sampling.exponents(synthetic(3, lambda n: 2 * np.where(n < 100, 7.0, n**p))).iloc[0]
    assert found["exponent"] == pytest.approx(p, abs=1e-12)
    # 1.96 sigma of a line through four points of deviation 0.1 / sqrt 40.
    half = 1.96 * 0.1 / np.sqrt(39) / np.sqrt(4 * np.log([100, 300, 1000, 3000]).var())
    assert found["high"] - p == pytest.approx(p - found["low"]) == pytest.approx(half, rel=1e-3)
    assert (found["from"], found["to"]) == (100, 3000)


def test_laws_of_synthetic_rates_are_distinguished():
    means = [synthetic(d, lambda n: np.sqrt((0.4 + 0.13 * np.log(n)) / n)) for d in (1, 2, 3)]
    found = sampling.laws(pd.concat(means)).set_index(["d", "law"]).loc[2]
    best = found.loc["((a + b log N) / N)^1/2"]
    assert (best["a"], best["b"]) == pytest.approx((0.4, 0.13), abs=1e-12)
    assert 0.01 < best["b_half"] < 0.04
    assert best["misfit"] < 1e-12
    assert found["misfit"].drop(best.name).min() > 2


def test_kept_rates_have_proved_bounds():
    table = pd.read_parquet(sampling.FILE)
    assert (table["lower"] <= table["upper"]).all()
    assert (table["upper"] - table["lower"] <= sampling.GAP * table["upper"]).all()
    means = sampling.means(table)
    rates = sampling.exponents(means).set_index(["d", "start"])
    assert rates.loc[(1, IID), "low"] < -0.5 < rates.loc[(1, IID), "high"]
    assert abs(rates.loc[(1, QUANTILES), "exponent"] + 1) < 1e-12
    assert rates.loc[(2, PAIR), "low"] > -0.5  # slower than without logarithm
    laws = sampling.laws(means).set_index("law")
    assert abs(laws["a"].iloc[0] - np.sqrt(np.pi / 32)) < laws["a_half"].iloc[0]
    fits = laws[["d", "misfit"]].groupby("d")["misfit"]
    assert (fits.min() < 2).all()
    assert fits.idxmin().loc[[2, 3]].tolist() == ["((a + b log N) / N)^1/2", "a N^-1/3 + b N^-1/2"]


@pytest.mark.parametrize(("d", "start"), [(1, IID), (1, QUANTILES), (2, PAIR)])
def test_a_kept_rate_is_reproduced(d, start):
    key = {"d": d, "start": start, "N": 100, "repeat": 0}
    kept = pd.read_parquet(sampling.FILE).set_index(list(sampling.KEY)).loc[tuple(key.values())]
    assert sampling.value(key)[0]["w1"] == pytest.approx(kept["w1"], rel=1e-12)


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
    "must be at most 200000 each": (np.arange(400_002.0).reshape(-1, 2), np.ones((1, 2))),
}


@pytest.mark.parametrize("message", BAD)
def test_bad_input_is_refused_by_name(message):
    with pytest.raises(InvalidProblem, match=message):
        w1(*BAD[message])
