"""Sums over all pairs: the three methods agree, and each is used only where it is exact."""

import casadi as ca
import numpy as np
import pytest

import meanfield
from meanfield.forces.chebyshev import interpolant
from meanfield.forces.interaction import MIN_INTERPOLATED, forces, is_quadratic, pair_energy
from tests.meanfield.models import MODELS, start


def definition(model, X, w):
    """Compute forces and energy of all pairs by their definitions."""
    sums = np.array([w @ model.K(X - x) for x in X])
    return sums, float(sum(s * (w @ model.pair_energy(X - x)) for s, x in zip(w, X, strict=True)))


def with_kernel(V):
    return meanfield.Model(g=lambda X, y: X - y, W0=lambda y: y**2, W1=lambda X: X**2, V=V)


@pytest.mark.slow_with("bending-260")
@pytest.mark.parametrize("particles", [40, MIN_INTERPOLATED + 60])
@pytest.mark.parametrize("name", ["attracting", "bending", "spatial"])
def test_methods_agree(name, particles, rng):
    model, X = MODELS[name], start(name, particles).X
    for w in (None, rng.dirichlet(np.ones(particles))):
        weights = np.full(particles, 1 / particles) if w is None else w
        expected, energy = definition(model, X, weights)
        found = forces(model, X, w)
        np.testing.assert_allclose(found, expected, atol=3e-14)
        assert pair_energy(model, X, w) == pytest.approx(energy, abs=1e-13)
        np.testing.assert_allclose(weights @ found, 0, atol=1e-13)  # action and reaction


def test_interpolation_is_used_where_the_kernel_is_smooth():
    X = start("attracting", MIN_INTERPOLATED).X[:, 0]
    gauss, kink = lambda s: np.exp(-(s**2) / 2), np.abs
    assert interpolant((gauss,), X) is not None
    assert interpolant((gauss, kink), X) is None
    assert interpolant((gauss,), 0 * X) is None  # all at one place


def test_quadratic_is_recognised():
    assert is_quadratic(with_kernel(lambda r: 3 * r**2))
    assert not is_quadratic(with_kernel(lambda r: r**4))


def test_cost_of_interpolation_is_linear():
    """Test that a kernel is evaluated at the same number of points for 1000 and 4000 particles."""
    counts = []
    for particles in (1000, 4000):
        X = np.linspace(-1, 1, particles)
        sizes = []

        def kernel(s, sizes=sizes):
            sizes.append(np.size(s))
            return np.exp(-(s**2))

        found = interpolant((kernel,), X)
        found.sum_pairs(kernel, X, np.full(particles, 1 / particles))
        counts.append(sum(sizes))
    assert counts[0] == counts[1] < 20_000


def test_unbounded_kernel():
    with pytest.raises(meanfield.InvalidModel, match=r"V = .*: must be finite, with V\(0\) = 0"):
        with_kernel(lambda r: ca.log(r**2))
    pointed = with_kernel(lambda r: (r**2) ** 0.3)  # has no force at 0
    for particles in (3, 70):
        with pytest.raises(RuntimeError, match=r"no finite value|not finite"):
            forces(pointed, np.linspace(0, 1, particles)[:, None], None)
