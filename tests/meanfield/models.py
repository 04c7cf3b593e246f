"""Models on which the contract tests of meanfield run, each with a start in general position."""

import casadi as ca
import numpy as np
import pytest

import meanfield

SPRINGS = {"m": 0.5, "k0": 1.0, "k1": 0.5}
BENDING = meanfield.Model(  # nothing is linear, and nothing is symmetric in the coordinates
    g=lambda X, y: ca.vertcat(X[0] + ca.sin(X[1] + y[0]) / 3 - y[1], X[1] - ca.cos(X[0]) * y[1] / 4 - y[0]),
    W0=lambda y: ca.sumsqr(y) + y[0] * y[1] ** 3 / 5,
    W1=lambda X: ca.log(1 + ca.sumsqr(X)) + X[0] / 7,
    V=lambda r: ca.exp(-(r[0] ** 2) - r[1] ** 2 / 3) - 1,
    m=0.7,
    nx=2,
    ny=2,
)
ATTRACTING = meanfield.Model(
    g=lambda X, y: X + ca.sin(X) / 2 - y,
    W0=lambda y: (y - 1) ** 2 / 2,
    W1=lambda X: X**2 / 4,
    V=lambda r: 1 - ca.exp(-(r**2) / 2),
    m=0.5,
)
SPATIAL = meanfield.Model(  # a plane state acts on particles in space
    g=lambda X, y: ca.vertcat(X[0] / y[0], X[1] / y[1], X[2] - y[0] * y[1]),
    W0=lambda y: ca.sumsqr(y - 1),
    W1=lambda X: ca.sumsqr(X) / 3,
    V=lambda r: ca.sumsqr(r) / 5,
    m=0.3,
    nx=3,
    ny=2,
)
MODELS = {
    "straight": meanfield.StraightFibre(**SPRINGS, y_rest=1.0),
    "linear": meanfield.LinearFibre(**SPRINGS, y_rest=1.0),
    "wavy": meanfield.WavyFibre(**SPRINGS, y_rest=1.0),
    "element": meanfield.TissueElement(**SPRINGS, y_rest=[1.0, 1.2, 0.1]),
    "bending": BENDING,
    "attracting": ATTRACTING,
    "spatial": SPATIAL,
}


def start(name: str, particles: int) -> meanfield.State:
    """Build a state whose particles are drawn from a normal distribution."""
    model = MODELS[name]
    X = np.random.default_rng(7).normal(0.3, 0.8, size=(particles, model.nx))
    return meanfield.State(X=X, y=np.array([1.2, 0.9, 0.1])[: model.ny], v=np.array([0.3, -0.2, 0.5])[: model.ny])


EVERY = [pytest.param(name, id=name) for name in MODELS]
