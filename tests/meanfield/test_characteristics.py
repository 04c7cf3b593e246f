"""Characteristics of the mean-field limit: closed forms, particle runs, the stated error, pushed-forward densities."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.polynomial import Legendre
from numpy.typing import NDArray

import meanfield
from dincl import Status
from meanfield import Density, SolveFailed, State, push_forward, solve_characteristics, solve_pde
from meanfield.solvers import characteristics
from meanfield.solvers.ode import solve_weighted

Array = NDArray[np.float64]
SPRINGS = {"m": 0.5, "k0": 1.0, "y_rest": 1.0, "k1": 0.5}
STRAIGHT, WAVY = meanfield.StraightFibre(**SPRINGS), meanfield.WavyFibre(**SPRINGS)
BUMP = Density.bump(0.3, 1.0)
TIMES = [0.5, 1.0, 2.0]


def test_straight_fibre_is_a_harmonic_oscillator() -> None:
    flow = solve_characteristics(STRAIGHT, BUMP, [1.0], [0.4], TIMES, 1e-12)
    s, t = 0.3**2 + 1 / 11, np.array(TIMES)
    rest, omega = 1 / (1 + 0.5 * s), np.sqrt((1 + 0.5 * s) / (1 + 0.5 * s))
    y = rest + (1 - rest) * np.cos(omega * t) + 0.4 / omega * np.sin(omega * t)
    np.testing.assert_allclose(flow.y[:, 0], y, rtol=0, atol=1e-11)
    assert flow.quadrature_error < 1e-11
    for k in range(3):
        law = push_forward(STRAIGHT, BUMP, [1.0], flow.y[k])
        np.testing.assert_allclose(law.density(flow.X[k]), BUMP.density(flow.X[k] / y[k]) / y[k], rtol=1e-9, atol=1e-12)


def test_the_density_pushed_forward_is_mass_over_length() -> None:
    flow = solve_characteristics(WAVY, BUMP, [0.2], [0.5], TIMES, 1e-10)
    nodes, _ = BUMP.nodes(len(flow.level))
    positions = Legendre.fit(nodes[:, 0], flow.X[2, :, 0], 24, domain=[-0.7, 1.3])
    found = push_forward(WAVY, BUMP, [0.2], flow.y[2]).density(flow.X[2])
    np.testing.assert_allclose(found * positions.deriv()(nodes[:, 0]), BUMP.density(nodes), rtol=1e-6, atol=1e-8)


@pytest.mark.slow_with("0.001")
@pytest.mark.parametrize("tol", [1e-3, 1e-6, 1e-9])
def test_stated_quadrature_error_bounds_the_error(tol: float) -> None:
    steep = meanfield.WavyFibre(**SPRINGS, amplitude=0.8)  # nearly singular: few nodes are not enough
    density = Density.uniform(-1.0, 4.0)
    flow = solve_characteristics(steep, density, [0.2], [0.5], TIMES, tol)
    nodes, weights = density.nodes(1000)
    fine = solve_weighted(steep, State(X=nodes, y=[0.2], v=[0.5]), weights, TIMES, tol)
    error = max(np.abs(flow.y - fine.y).max(), np.abs(flow.v - fine.v).max())
    assert error <= flow.quadrature_error <= 3 * tol
    assert len(flow.level) < 1000
    assert flow.work.unknowns == 2 + len(flow.level)


@pytest.mark.slow
def test_attraction_stiffens_the_fibre() -> None:
    """Test that V = k r^2/2 adds k var(X)/y^2 to the stiffness of the straight fibre."""
    model = meanfield.Model(
        g=lambda X, y: X / y, W0=lambda y: (y - 1) ** 2 / 2, W1=lambda X: X**2 / 4, V=lambda r: 0.4 * r**2, m=0.5
    )
    variance, t = 1 / 11, np.array(TIMES)
    s = 0.3**2 + variance
    stiffness = 1 + 0.5 * s + 0.8 * variance
    rest, omega = 1 / stiffness, np.sqrt(stiffness / (1 + 0.5 * s))
    y = rest + (1 - rest) * np.cos(omega * t) + 0.4 / omega * np.sin(omega * t)
    flow = solve_characteristics(model, BUMP, [1.0], [0.4], TIMES, 1e-11)
    np.testing.assert_allclose(flow.y[:, 0], y, rtol=0, atol=1e-10)
    assert np.ptp(flow.energy()) < 1e-10
    grid = solve_pde(model, BUMP, [1.0], [0.4], TIMES, cells=100)
    np.testing.assert_allclose(grid.y[:, 0], y, rtol=0, atol=2e-5)
    assert np.ptp(grid.energy()) < 1e-4


def test_too_few_nodes_end_the_run(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(characteristics, "MAX_NODES", 32)
    flow = solve_characteristics(WAVY, Density.uniform(-5.0, 9.0), [0.2], [0.5], TIMES, 1e-9, throw=False)
    assert flow.status is Status.NOT_CONVERGED
    assert flow.quadrature_error > 1e-9
    assert "32 nodes" in flow.detail
    with pytest.raises(SolveFailed, match="32 nodes"):
        solve_characteristics(WAVY, Density.uniform(-5.0, 9.0), [0.2], [0.5], TIMES, 1e-9)


def test_a_fibre_that_vanishes_ends_the_run() -> None:
    with pytest.raises(SolveFailed) as caught:
        solve_characteristics(STRAIGHT, BUMP, [1.0], [-4.0], [0.0, 0.1, 1.0], 1e-9)
    assert caught.value.status is Status.SINGULAR
    assert caught.value.result.t.tolist() == [0.0, 0.1]
    assert caught.value.result.quadrature_error < 1e-8
