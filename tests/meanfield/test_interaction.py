"""Sums over all pairs: the three ways agree, and are used where they hold."""

import casadi as ca
import numpy as np
import pytest

import meanfield
from meanfield.forces.chebyshev import line
from meanfield.forces.interaction import MANY, forces, is_quadratic, pair_energy
from tests.meanfield.models import MODELS, start


def by_hand(model, X, w):
    """Forces and energy of all pairs by the definition."""
    pulls = np.array([w @ model.K(X - x) for x in X])
    return pulls, float(sum(s * (w @ model.pair_energy(X - x)) for s, x in zip(w, X, strict=True)))


def with_kernel(V):
    return meanfield.Model(g=lambda X, y: X - y, W0=lambda y: y**2, W1=lambda X: X**2, V=V)


@pytest.mark.parametrize("particles", [40, MANY + 60])
@pytest.mark.parametrize("name", ["attracting", "bending", "spatial"])
def test_ways_agree(name, particles, rng):
    model, X = MODELS[name], start(name, particles).X
    for w in (None, rng.dirichlet(np.ones(particles))):
        shares = np.full(particles, 1 / particles) if w is None else w
        pulls, energy = by_hand(model, X, shares)
        found = forces(model, X, w)
        np.testing.assert_allclose(found, pulls, atol=3e-14)
        assert pair_energy(model, X, w) == pytest.approx(energy, abs=1e-13)
        np.testing.assert_allclose(shares @ found, 0, atol=1e-13)  # action and reaction


def test_interpolation_is_used_where_the_kernel_is_smooth():
    X = start("attracting", MANY).X[:, 0]
    gauss, kink = lambda s: np.exp(-(s**2) / 2), np.abs
    assert line((gauss,), X) is not None
    assert line((gauss, kink), X) is None
    assert line((gauss,), 0 * X) is None  # all at one place


def test_quadratic_is_recognised():
    assert is_quadratic(with_kernel(lambda r: 3 * r**2))
    assert not is_quadratic(with_kernel(lambda r: r**4))


def test_cost_of_interpolation_is_linear():
    """Two kernels are evaluated at p^2 points whatever the number of particles."""
    counts = []
    for particles in (1000, 4000):
        X = np.linspace(-1, 1, particles)
        met = []

        def kernel(s, met=met):
            met.append(np.size(s))
            return np.exp(-(s**2))

        found = line((kernel,), X)
        found.summed(kernel, X, np.full(particles, 1 / particles))
        counts.append(sum(met))
    assert counts[0] == counts[1] < 20_000


def test_unbounded_kernel():
    with pytest.raises(meanfield.InvalidModel, match=r"V = .*: must be finite, with V\(0\) = 0"):
        with_kernel(lambda r: ca.log(r**2))
    pointed = with_kernel(lambda r: (r**2) ** 0.3)  # has no force at 0
    for particles in (3, 70):
        with pytest.raises(RuntimeError, match=r"no finite value|not finite"):
            forces(pointed, np.linspace(0, 1, particles)[:, None], None)
