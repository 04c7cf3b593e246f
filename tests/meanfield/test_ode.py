"""Reduced equations: against closed forms in high precision, the constrained equations, the energy, each other."""

import math

import mpmath
import numpy as np
import pytest

import meanfield
from meanfield import Status
from tests.meanfield.models import EVERY, MODELS, start


def time_in(detail: str) -> float:
    """Return the time at the end of a message."""
    return float(detail.rsplit(maxsplit=1)[-1].rstrip("."))


def moments(X):
    """Return mean and second moment of particles (N, nx)."""
    return meanfield.Moments(X.mean(axis=0), X.T @ X / len(X))


@pytest.mark.parametrize("name", EVERY)
def test_solves_the_constrained_equations(name):
    """Test (5.6) with accelerations from finite differences of the motion, independent of the reduction."""
    model, h = MODELS[name], 0.02
    t = 0.3 + h * np.arange(-2, 3)
    motion = meanfield.solve_ode(model, start(name, 5), t=t, tol=1e-13)
    second = np.array([-1, 16, -30, 16, -1]) / (12 * h**2)
    X, y, forces = motion.X[2], motion.y[2], motion.multipliers[2]
    gX, gy = model.jacobians(X, y)
    pull = np.mean([model.K(z - X) for z in X], axis=0)
    particles = (
        model.m * np.tensordot(second, motion.X, 1) - model.F1(X) - pull + np.matvec(gX.transpose(0, 2, 1), forces)
    )
    macroscopic = second @ motion.y - model.F0(y) + np.matvec(gy.transpose(0, 2, 1), forces).mean(axis=0)
    assert max(np.abs(particles).max(), np.abs(macroscopic).max()) < 2e-6
    assert motion.constraint_drift().max() < 1e-11
    assert motion.velocity_drift().max() < 1e-13


@pytest.mark.parametrize("name", ["straight", "linear", "element", "spatial"])
def test_moments_are_those_of_the_particles(name):
    state = start(name, 9)
    whole = meanfield.solve_ode(MODELS[name], state, t=[0.0, 2.0], tol=1e-11)
    closed = meanfield.solve_moments(MODELS[name], moments(state.X), state.y, state.v, t=[0.0, 2.0], tol=1e-11)
    np.testing.assert_allclose(closed.y, whole.y, atol=1e-9)
    np.testing.assert_allclose(closed.v, whole.v, atol=1e-9)
    for k in range(2):
        mean, second = moments(whole.X[k])
        np.testing.assert_allclose(closed.mean[k], mean, atol=1e-9)
        np.testing.assert_allclose(closed.second[k], second, atol=1e-9)
    np.testing.assert_allclose(closed.energy(), whole.energy(), atol=1e-9)
    nx, ny = MODELS[name].nx, MODELS[name].ny
    assert closed.work.unknowns == 2 * (ny + nx * nx)


def test_moments_that_do_not_close():
    with pytest.raises(meanfield.NotClosed, match="Phi is not affine in X"):
        meanfield.solve_moments(MODELS["wavy"], moments(np.zeros((1, 1))), [0.0], [1.0], t=[1.0], tol=1e-6)
    with pytest.raises(meanfield.InvalidModel, match=r"moments0.second = .*: must be symmetric"):
        meanfield.solve_moments(MODELS["linear"], meanfield.Moments([1.0], [[0.5]]), [0.0], [1.0], t=[1.0], tol=1e-6)


def test_fibre_that_is_pushed_through_zero_ends_there():
    """Test a run in which y = 1 - ... reaches 0, where dg/dX = 1/y changes its sign."""
    model = MODELS["straight"]
    state = meanfield.State(X=[[0.5], [-1.0]], y=[1.0], v=[-3.0])
    with pytest.raises(meanfield.SolveFailed, match="full rank") as caught:
        meanfield.solve_ode(model, state, t=np.linspace(0, 3, 31), tol=1e-9)
    motion = caught.value.result
    s = 0.625  # <X^2>
    stiffness, mass = 1.0 + 0.5 * s, 1 + 0.5 * s
    rest, rate = 1 / stiffness, math.sqrt(stiffness / mass)
    crossing = mpmath.findroot(
        lambda t: rest + (1 - rest) * mpmath.cos(rate * t) - 3 / rate * mpmath.sin(rate * t), 0.34
    )
    assert motion.status is Status.SINGULAR
    assert time_in(motion.detail) == pytest.approx(float(crossing), abs=1e-5)
    assert motion.t[-1] < crossing < motion.t[-1] + 0.1
    again = meanfield.solve_ode(model, state, t=np.linspace(0, 3, 31), tol=1e-9, throw=False)
    np.testing.assert_array_equal(again.X, motion.X)


ELEMENT = {"model": MODELS["element"], "y0": [1.2, 0.9, 0.1], "v0": [0.0, 0.0, 0.0], "t": [1e-6], "tol": 1e-3}


@pytest.mark.parametrize("size", [1e-9, 1e2, 1e6])
def test_moments_without_variance_along_one_direction(size, rng):
    """Test particles on a line: rounding makes the least variance negative, relative to the size of the moments."""
    least = []
    for _ in range(50):
        X = size * np.outer(rng.normal(size=5), rng.normal(size=2))
        mean, second = moments(X)
        least.append(np.linalg.eigvalsh(second - np.outer(mean, mean)).min())
        assert meanfield.solve_moments(moments0=meanfield.Moments(mean, second), **ELEMENT).status is Status.SUCCESS
    assert min(least) < 0


@pytest.mark.parametrize("size", [1e-9, 1.0, 1e6])
def test_moments_that_no_density_has_are_refused_at_every_size(size):
    second = size**2 * np.array([[1.0, 0.0], [0.0, -1e-9]])
    with pytest.raises(meanfield.InvalidModel, match=r"moments0.second = .*: must be symmetric, and"):
        meanfield.solve_moments(moments0=meanfield.Moments([0.0, 0.0], second), **ELEMENT)
    skew = size**2 * np.array([[1.0, 1e-9], [0.0, 1.0]])
    with pytest.raises(meanfield.InvalidModel, match=r"moments0.second = .*: must be symmetric, and"):
        meanfield.solve_moments(moments0=meanfield.Moments([0.0, 0.0], skew), **ELEMENT)


def test_force_that_is_not_finite():
    model = meanfield.Model(g=lambda X, y: X - y, W0=lambda y: -1 / y, W1=lambda X: X**2)
    falling = meanfield.solve_ode(model, meanfield.State([[0.0]], [1.0], [0.0]), t=[9.0], tol=1e-6, throw=False)
    assert falling.status in (Status.STEP_TOO_SMALL, Status.NON_FINITE)
    with pytest.raises(meanfield.InvalidModel, match="all forces of the model must be finite"):
        meanfield.solve_ode(model, meanfield.State([[0.0]], [0.0], [0.0]), t=[1.0], tol=1e-6)
