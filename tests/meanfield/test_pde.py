"""Mean-field PDE on a grid: mass, sign, order, closed forms, and failures."""

import numpy as np
import pytest
from scipy.optimize import brentq

import meanfield
from dincl import Status
from meanfield import Density, SolveFailed, push_forward, solve_characteristics, solve_pde, w1
from meanfield.solvers import pde

SPRINGS = {"m": 0.5, "k0": 1.0, "y_rest": 1.0, "k1": 0.5}
LINEAR, STRAIGHT, WAVY = (f(**SPRINGS) for f in (meanfield.LinearFibre, meanfield.StraightFibre, meanfield.WavyFibre))
BUMP, BOX = Density.bump(0.3, 1.0), Density.uniform(0.0, 1.0)
ROUNDING = 1e-14


def slope(cells, errors):
    return float(-np.polyfit(np.log(cells), np.log(errors), 1)[0])


# --- order and closed forms ------------------------------------------------------------------------------------------


def linear_fibre(y0, v0, mean, t):
    """Compute y of LINEAR: (1 + m) y'' = -k0 (y - y_rest) - k1 (mean + y - y0)."""
    stiffness = SPRINGS["k0"] + SPRINGS["k1"]
    rest = (SPRINGS["k0"] * SPRINGS["y_rest"] - SPRINGS["k1"] * (mean - y0)) / stiffness
    omega = np.sqrt(stiffness / (1 + SPRINGS["m"]))
    return float(rest + (y0 - rest) * np.cos(omega * t) + v0 / omega * np.sin(omega * t))


@pytest.mark.slow
def test_wavy_fibre_converges_to_its_characteristics_with_second_order():
    cells, t, y0 = [70, 140, 280, 560], np.linspace(0.25, 1.5, 6), np.array([0.2])
    flow = solve_characteristics(WAVY, BUMP, y0, [0.5], t, 1e-11)

    law = push_forward(WAVY, BUMP, y0, flow.y[-1]).panels
    errors = {"y": [], "v": [], "f": []}
    for n in cells:
        grid = solve_pde(WAVY, BUMP, y0, [0.5], t, cells=n, bounds=(-1.0, 3.0))
        exact = np.diff(law.distribution(grid.edges)) * n / 4
        errors["f"].append(np.abs(grid.f[-1] - exact).sum() * 4 / n)
        errors["y"].append(np.abs(grid.y - flow.y).max())
        errors["v"].append(np.abs(grid.v - flow.v).max())
    for name, last in (("f", 2e-4), ("y", 4e-6), ("v", 8e-6)):
        assert errors[name][-1] < last
        assert slope(cells, errors[name]) == pytest.approx(2.0, abs=0.2)


@pytest.mark.slow_with("200")
@pytest.mark.parametrize("n", [25, 200])
def test_a_jump_stays_non_negative_within_computed_bounds(n):
    t = [1.0, 2.0, 4.0]
    grid = solve_pde(LINEAR, BOX, [0.0], [0.5], t, cells=n)
    assert grid.status
    assert grid.work.unknowns == n + 2
    assert grid.f.min() == 0.0
    assert grid.f.max() <= 1 + ROUNDING
    np.testing.assert_allclose(grid.mass(), 1.0, rtol=0, atol=ROUNDING)
    for k, time in enumerate(t):
        y = linear_fibre(0.0, 0.5, 0.5, time)
        assert grid.y[k, 0] == pytest.approx(y, abs=20 / n**2)
        assert grid.mean()[k, 0] == pytest.approx(0.5 + y, abs=20 / n**2)
        # Jumps are smeared over a width h^(2/3) by a scheme of second order.
        assert w1(grid.density(k), Density.uniform(y, 1 + y)) < 0.7 * np.diff(grid.edges)[0] ** (4 / 3)


# --- failures --------------------------------------------------------------------------------------------------------


def test_density_at_the_wall_ends_the_run():
    arrives = brentq(lambda t: linear_fibre(0.0, 0.5, 0.3, t) - 0.2, 0.0, 1.0)
    t = [0.0, 0.7 * arrives, 1.3 * arrives, 3.0]
    with pytest.raises(SolveFailed, match=r"wider bounds\. At t = ") as caught:
        solve_pde(LINEAR, BUMP, [0.0], [0.5], t, cells=200, bounds=(-1.0, 1.5))
    result = caught.value.result
    assert caught.value.status is result.status is Status.LEFT_GRID
    assert result.t.tolist() == t[:2]
    assert result.y.shape == (2, 1)
    np.testing.assert_allclose(result.mass(), 1.0, atol=ROUNDING)


def test_singular_models_end_the_run():
    rolling = meanfield.Model(g=lambda X, y: X * X / 2 - y, W0=lambda y: y * y / 2, W1=lambda X: X * X / 2)
    grid = solve_pde(
        rolling, Density.bump(1.0, 0.3), [1.0], [-4.0], [0.01, 1.0], cells=16, bounds=(-0.45, 1.5), throw=False
    )
    assert grid.status is Status.SINGULAR
    assert grid.t.tolist() == [0.01]
    grid = solve_pde(STRAIGHT, BUMP, [1.0], [-4.0], [0.01, 1.0], cells=16, bounds=(-1.2, 2.0), throw=False)
    assert grid.status is Status.STEP_TOO_SMALL  # the fibre vanishes at t = 0.25
    assert grid.t.tolist() == [0.01]
    assert np.isfinite(grid.energy()).all()


def test_nothing_moves_at_rest():
    """Test y = y' = 0 without forces: the error control must not divide by their size."""
    free = meanfield.LinearFibre(m=0.5, k0=1.0, y_rest=0.0, k1=0.0)
    grid = solve_pde(free, BUMP, [0.0], [0.0], [0.5, 1.0], cells=20, bounds=(-2.0, 4.0))
    assert grid.status is Status.SUCCESS
    assert not np.any([grid.y, grid.v])
    np.testing.assert_array_equal(grid.f[0], grid.f[1])


def test_too_many_steps_end_the_run(monkeypatch):
    monkeypatch.setattr(pde, "MAX_GRID_STEPS", 10)
    grid = solve_pde(LINEAR, BUMP, [0.0], [0.5], [2.0], bounds=(-2.0, 4.0), throw=False)
    assert grid.status is Status.TOO_MANY_STEPS
    assert grid.work.steps == 10
    assert grid.f.shape == (0, 400)
