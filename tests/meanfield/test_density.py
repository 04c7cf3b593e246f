"""Densities of the particles: moments, nodes, samples, quantiles, piecewise polynomials, invalid input."""

import numpy as np
import pytest

from dincl import InvalidProblem
from meanfield import Density, Panels

NORMAL = Density.normal(1.0, 2.0)
BUMP = Density.bump(0.5, 2.0)
KINK = Density(lambda x: 1 - np.abs(x[:, 0] - 0.2), [-0.8], [1.2], breaks=(0.2,))
# Density, mean, second moment. A bump has the variance r^2 / 11.
MOMENTS = {
    "uniform": (Density.uniform(1.0, 3.0), [2.0], [[4 + 1 / 3]]),
    "normal": (NORMAL, [1.0], [[5.0]]),
    "bump": (BUMP, [0.5], [[0.25 + 4 / 11]]),
    "kink": (KINK, [0.2], [[0.04 + 1 / 6]]),
    "uniform 2": (Density.uniform([0, 0], [1, 2]), [0.5, 1.0], [[1 / 3, 0.5], [0.5, 4 / 3]]),
    "normal 2": (Density.normal([0.0, 1.0], [1.0, 1.5]), [0.0, 1.0], np.diag([1.0, 3.25])),
    "bump 3": (Density.bump([0, 0, 1], 1.0), [0, 0, 1], np.diag([1 / 11, 1 / 11, 12 / 11])),
}


@pytest.mark.parametrize("name", MOMENTS)
def test_moments_are_those_of_the_formula(name):
    density, mean, second = MOMENTS[name]
    found = density.moments()
    np.testing.assert_allclose(found[0], mean, rtol=0, atol=1e-13)
    np.testing.assert_allclose(found[1], second, rtol=0, atol=2e-13)


@pytest.mark.parametrize("name", MOMENTS)
def test_samples_follow_the_density(name, rng):
    density, mean, second = MOMENTS[name]
    x = density.sample(rng, 20_000)
    assert x.shape == (20_000, density.nx)
    assert ((density.lower <= x) & (x <= density.upper)).all()
    deviation = np.sqrt(np.diag(second) - np.square(mean))
    assert (np.abs(x.mean(axis=0) - mean) < 4 * deviation / np.sqrt(len(x))).all()
    np.testing.assert_allclose(x.T @ x / len(x), second, rtol=0, atol=0.04 * np.diag(second).max())


def test_rejection_draws_from_the_density_even_where_its_first_bound_is_too_low(rng, monkeypatch):
    monkeypatch.setattr("meanfield.density.CHECK_NODES", 2)  # there f is below a tenth of its largest value
    bump = MOMENTS["bump 3"][0]
    x = bump.sample(rng, 20_000) - [0, 0, 1]
    np.testing.assert_allclose(x.T @ x / len(x), np.eye(3) / 11, rtol=0, atol=0.004)


@pytest.mark.parametrize("name", MOMENTS)
def test_nodes_integrate_polynomials_against_the_density(name):
    density, mean, _ = MOMENTS[name]
    points, weights = density.nodes(48)
    assert abs(weights.sum() - 1) < 1e-14
    assert (weights >= 0).all()
    np.testing.assert_allclose(weights @ points, mean, rtol=0, atol=1e-13)
    pieces = len(density.breaks) + 1
    assert len(points) == pieces * 48**density.nx


def test_breaks_make_quadrature_exact():
    points, weights = KINK.nodes(3)
    assert abs(weights @ np.abs(points[:, 0] - 0.2) - 1 / 3) < 1e-15
    smeared = Density(KINK.pdf, [-0.8], [1.2]).nodes(6)
    assert abs(smeared[1] @ np.abs(smeared[0][:, 0] - 0.2) - 1 / 3) > 1e-4


@pytest.mark.parametrize("density", [NORMAL, BUMP, KINK])
def test_quantiles_invert_the_distribution(density):
    x = density.quantiles(1001)
    assert x.shape == (1001, 1)
    np.testing.assert_allclose(density.panels.distribution(x[:, 0]), (np.arange(1001) + 0.5) / 1001, rtol=0, atol=1e-15)


def test_distribution_of_a_piecewise_constant_density_is_linear_on_cells():
    panels = Panels(np.array([0.0, 1.0, 1.5, 3.0]), np.array([[0.5], [0.0], [1 / 3]]))
    x = np.array([-1.0, 0.5, 1.0, 1.2, 1.5, 2.25, 4.0])
    np.testing.assert_allclose(panels.distribution(x), [0, 0.25, 0.5, 0.5, 0.5, 0.75, 1], rtol=0, atol=1e-16)
    np.testing.assert_allclose(panels.quantile(np.array([0.25, 0.75, 1.0])), [0.5, 2.25, 3.0], rtol=0, atol=1e-15)


BAD = {
    "upper": lambda: Density.uniform(1.0, 1.0),
    "lower": lambda: Density.uniform(np.zeros(4), np.ones(4)),
    r"upper = array\(\[2.\]\)": lambda: Density.uniform([0.0, 0.0], 2.0),
    "integral": lambda: Density(lambda x: np.full(len(x), 0.5), [0.0], [1.0]),
    "its integral over the box is 2": lambda: Density(lambda x: np.full(len(x), 2.0), [0.0, 0.0], [1.0, 1.0]),
    "pdf returned -.* at x = .*: must be >= 0": lambda: Density(lambda x: 2 * x[:, 0], [-1.0], [1.0]),
    "pdf returned nan": lambda: Density(lambda x: np.full(len(x), np.nan), [0.0], [1.0]),
    "pdf returned": lambda: Density(lambda x: x, [0.0], [1.0]),
    "must be a function": lambda: Density(1.0, [0.0], [1.0]),
    "inside the box": lambda: Density(lambda x: np.ones(len(x)), [0.0], [1.0], breaks=(1.0,)),
    "deviation": lambda: Density.normal(0.0, 0.0),
    "radius": lambda: Density.bump([0.0, 0.0], [1.0, -1.0]),
    "one dimension": lambda: Density.uniform([0, 0], [1, 1]).quantiles(3),
    "n = 0": lambda: NORMAL.nodes(0),
    "n = 1.5": lambda: NORMAL.sample(np.random.default_rng(1), 1.5),
    "x = ": lambda: NORMAL.density([[np.nan]]),
    "p = nan": lambda: NORMAL.panels.quantile(np.array([0.5, np.nan])),
    "probabilities": lambda: NORMAL.panels.quantile([0.5, 1.5]),
    "x = inf": lambda: NORMAL.panels.distribution(np.array([np.inf])),
}


@pytest.mark.parametrize("message", BAD)
def test_bad_input_is_refused_by_name(message):
    with pytest.raises(InvalidProblem, match=message):
        BAD[message]()


FAR_SHAPES = {  # density of a centre and a width, and the variance over the square of the width
    "bump": (Density.bump, 1 / 11),
    "normal": (Density.normal, 1.0),
    "uniform": (lambda c, w: Density.uniform(c - w, c + w), 1 / 3),
    "cosine": (
        lambda c, w: Density(lambda x: (1 + np.cos(np.pi * (x[:, 0] - c) / w)) / (2 * w), c - w, c + w),
        1 / 3 - 2 / np.pi**2,
    ),
    "unlisted kink": (
        lambda c, w: Density(lambda x: np.maximum(1 - np.abs(x[:, 0] - c) / w, 0) / w, c - w, c + w),
        1 / 6,
    ),
    "plane": (lambda c, w: Density.normal([c, -c], [w, 2 * w]), 1.0),
}


@pytest.mark.parametrize("centre", [0.0, -1e3, 1e4, 1e5, -3e6, 1e7])
@pytest.mark.parametrize("name", FAR_SHAPES)
def test_far_from_the_origin_densities_and_moments_are_right_to_rounding(name, centre):
    make, variance = FAR_SHAPES[name]
    width, eps = 0.8, np.finfo(float).eps
    density = make(centre, width)
    mean, second = density.moments()
    assert abs(mean[0] - centre) <= 1e-12 * width + 4 * eps * abs(centre)
    assert abs(second[0, 0] - mean[0] ** 2 - variance * width**2) <= 1e-10 * width**2 + 16 * eps * centre**2
    if density.nx == 1:
        quantiles = density.quantiles(101)[:, 0]
        assert (np.diff(quantiles) >= 0).all()
        assert quantiles[50] == pytest.approx(centre, abs=1e-9 * width + 8 * eps * abs(centre))
