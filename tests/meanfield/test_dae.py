"""Constrained equations by IDAS: closed forms, the equations themselves, the reduced ODE, and failures."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from meanfield import (
    InvalidModel,
    Model,
    SolveFailed,
    State,
    Status,
    StraightFibre,
    WavyFibre,
    solve_dae,
    solve_ode,
)
from meanfield.forces.interaction import forces
from meanfield.solvers import dae
from meanfield.solvers.index_one import accelerations
from tests.meanfield.exact import CLOSED, FIBRE, K0, K1, PLAIN, REST, TIMES, M, fibre_start, start_of, straight, worst
from verification.thesis.chapter5.naive import solve_naive, solve_naive_rk4

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray


@pytest.mark.parametrize("n", [1, 20])
@pytest.mark.parametrize("tol", [1e-6, 1e-10])
@pytest.mark.parametrize("name", CLOSED)
def test_agrees_with_the_closed_form(name: str, tol: float, n: int) -> None:
    make, closed = CLOSED[name]
    motion = solve_dae(make(**FIBRE), fibre_start(n), TIMES, tol)
    assert motion.status
    assert worst(motion, closed(fibre_start(n), TIMES)) < 10 * tol


def test_many_particles_to_nine_digits() -> None:
    motion = solve_dae(StraightFibre(**FIBRE), fibre_start(300), [2.0], 1e-10)
    assert worst(motion, straight(fibre_start(300), np.array([2.0]))) < 1e-9
    assert motion.work.unknowns == 2 + 300 * 4 + 1  # y, v; X, U, lambda and a sum each; y''


def complex_step(f: Callable[[Any], Any], x: NDArray[np.float64]) -> NDArray[np.float64]:
    """Compute the derivative (rows of f, components of x), exact to rounding."""
    steps = 1e-30j * np.eye(len(x))
    return np.stack([np.imag(f(x + step)) / 1e-30 for step in steps], axis=-1)


@pytest.mark.parametrize("name", PLAIN)
def test_satisfies_the_constrained_equations(name: str) -> None:
    """Test (5.6) with second time derivatives from differences of order 6 of the positions."""
    make, g = PLAIN[name]
    start = start_of(name, 6)
    h = 0.02
    motion = solve_dae(make(), start, 1.0 + h * np.arange(-3, 4), 1e-12)
    stencil = np.array([2, -27, 270, -490, 270, -27, 2]) / 180
    X, y, multipliers = motion.X[3], motion.y[3], motion.multipliers[3]
    force = np.zeros_like(X)
    if name == "askew":  # K(X_k, X_i) = grad V(X_k - X_i)
        r = X[None, :, :] - X[:, None, :]
        force = (2 * r / (1 + (r**2).sum(axis=2, keepdims=True)) ** 2).mean(axis=1)
    pushed = np.zeros_like(y)
    for i, x in enumerate(X):
        gX, gy = complex_step(lambda z: g(z, y), x), complex_step(lambda z, x=x: g(x, z), y)
        second = np.tensordot(stencil, motion.X[:, i], axes=(0, 0)) / h**2
        assert M * second == pytest.approx(-K1 * x + force[i] - gX.T @ multipliers[i], abs=2e-7)
        assert g(x, y) == pytest.approx(g(np.asarray(start.X)[i], np.asarray(start.y)), abs=1e-12)
        pushed += gy.T @ multipliers[i] / len(X)
    rest = np.array([1.0, 1.1, 0.1]) if name == "element" else REST
    second = np.tensordot(stencil, motion.y, axes=(0, 0)) / h**2
    assert second == pytest.approx(-K0 * (y - rest) - pushed, abs=2e-7)


@pytest.mark.parametrize("tol", [1e-6, 1e-10])
@pytest.mark.parametrize("name", PLAIN)
def test_agrees_with_the_reduced_equations(name: str, tol: float) -> None:
    model, t = PLAIN[name][0](), TIMES[:5]
    motion = solve_dae(model, start_of(name), t, tol)
    assert worst(motion, solve_ode(model, start_of(name), t, tol)) < 20 * tol
    assert np.abs(np.diff(motion.energy())).max() < 20 * tol


def test_stiff_springs_over_many_periods_to_twelve_digits() -> None:
    """Test multipliers of size 1e6 that pass through zero: a purely relative tolerance of 1e-12 is impossible there."""
    model = WavyFibre(m=M, k0=1e6, y_rest=REST, k1=K1)
    motion = solve_dae(model, fibre_start(3), [0.0, 0.05], 1e-12)
    assert motion.energy()[1] == pytest.approx(motion.energy()[0], rel=1e-9)


def test_keeps_the_constraint_where_the_unstabilised_form_drifts() -> None:
    model, t = WavyFibre(**FIBRE), [10.0, 20.0, 40.0, 80.0]
    kept, naive = solve_dae(model, fibre_start(5), t, 1e-6), solve_naive(model, fibre_start(5), t, 1e-6)
    drift = naive.constraint_drift()
    assert kept.constraint_drift().max() < 1e-7
    assert kept.velocity_drift().max() < 1e-7
    assert drift[3] > 1e-5
    assert drift[3] > 30 * drift[0]


def test_the_unstabilised_form_converges_with_order_four() -> None:
    model, start = WavyFibre(**FIBRE), fibre_start(5)
    y = [solve_naive_rk4(model, start, [2.0], dt).y[0, 0] for dt in (0.2, 0.1, 0.05)]
    assert (y[0] - y[1]) / (y[1] - y[2]) == pytest.approx(16, rel=0.15)


def test_accelerations_solve_the_whole_linear_system() -> None:
    """Test each equation for X'', y'' and lambda, with D^2 g from differences of g."""
    model = PLAIN["askew"][0]()
    start = start_of("askew", 3).complete(model, 1e-9)
    found = accelerations(model, start.X, start.U, start.y, start.v)
    gX, gy = model.jacobians(start.X, start.y)
    force = model.F1(start.X) + forces(model, start.X, None)
    h = 1e-4
    at = [model.level(start.X + s * h * start.U, start.y + s * h * start.v) for s in (-1, 0, 1)]
    curvature = (at[0] - 2 * at[1] + at[2]) / h**2
    for i in range(3):
        assert M * found.X[i] == pytest.approx(force[i] - gX[i].T @ found.multipliers[i])
        assert gX[i] @ found.X[i] + gy[i] @ found.y + curvature[i] == pytest.approx(0, abs=1e-6)
    pushed = sum(gy[i].T @ found.multipliers[i] for i in range(3)) / 3
    assert found.y == pytest.approx(model.F0(start.y) - pushed)


def test_output_times_do_not_restart_the_integrator() -> None:
    model = WavyFibre(**FIBRE)
    few, many = (solve_dae(model, fibre_start(5), np.linspace(0, 4, k), 1e-9) for k in (2, 401))
    assert few.y[-1] == pytest.approx(many.y[-1], abs=1e-8)
    assert many.work.steps < 1.1 * few.work.steps


def test_restarts_from_an_output_state() -> None:
    model = WavyFibre(**FIBRE)
    whole = solve_dae(model, fibre_start(5), [1.0, 2.0], 1e-9)
    half = solve_dae(model, whole.state(0), [1.0], 1e-9)
    assert half.X[-1] == pytest.approx(whole.X[-1], abs=1e-8)
    assert half.level is not None
    assert (half.level == whole.level).all()


def test_a_start_that_violates_the_constraint_by_less_than_tol_is_projected() -> None:
    model, start = WavyFibre(**FIBRE), fibre_start(5).complete(WavyFibre(**FIBRE), 1e-6)
    off = State(X=start.X + 1e-7, y=start.y, v=start.v, U=start.U - 1e-7, level=start.level)
    motion = solve_dae(model, off, [0.0, 1.0], 1e-6)
    assert max(motion.constraint_drift().max(), motion.velocity_drift().max()) < 1e-9


# How runs end. A run that gets stuck makes all the steps it may.
FOLD = Model(g=lambda X, y: X + X**3 / 3 - X**5 / 5 - y, W0=lambda y: -2 * y, W1=lambda X: 0 * X)
BLOW_UP = Model(g=lambda X, y: X - y, W0=lambda y: -(y**4), W1=lambda X: 0 * X)


def test_length_zero_is_singular_and_the_part_before_is_right(capfd: pytest.CaptureFixture[str]) -> None:
    model, start = StraightFibre(m=M, k0=K0, y_rest=-1.0, k1=K1), fibre_start(4)
    motion = solve_dae(model, start, TIMES, 1e-8, throw=False)
    reference = solve_ode(model, start, TIMES, 1e-10, throw=False)
    assert motion.status is reference.status is Status.SINGULAR
    assert 1 < len(motion.t) == len(reference.t) < len(TIMES)
    assert motion.multipliers == pytest.approx(reference.multipliers, abs=1e-7)
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("tol", [1e-5, 1e-10])
def test_a_fold_of_the_constraint_is_singular(tol: float, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(dae, "MAX_IDAS_STEPS", 5000)
    with pytest.raises(SolveFailed, match="det dg/dX") as caught:
        solve_dae(FOLD, State(X=[[0.1], [0.3]], y=[0.2], v=[0.1]), [0.1, 5.0], tol)
    assert caught.value.status is Status.SINGULAR
    assert caught.value.result.t.tolist() == [0.1]


def test_a_singularity_in_finite_time_and_too_many_steps(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    start = State(X=[[0.5]], y=[1.0], v=[0.0])
    monkeypatch.setattr(dae, "MAX_IDAS_STEPS", 5000)
    motion = solve_dae(BLOW_UP, start, [0.1, 9.0], 1e-6, throw=False)
    assert (motion.status, len(motion.t)) == (Status.STEP_TOO_SMALL, 1)
    monkeypatch.setattr(dae, "MAX_IDAS_STEPS", 50)
    motion = solve_dae(WavyFibre(**FIBRE), start, [0.1, 90.0], 1e-6, throw=False)
    assert (motion.status, len(motion.t)) == (Status.TOO_MANY_STEPS, 1)
    assert np.isfinite(motion.multipliers).all()
    assert capfd.readouterr() == ("", "")


def test_a_force_that_is_not_finite_at_the_start() -> None:
    model = Model(g=lambda X, y: X - y, W0=lambda y: y**1.5, W1=lambda X: 0 * X)
    motion = solve_dae(model, State(X=[[1.0]], y=[-1.0], v=[0.0]), [1.0], 1e-6, throw=False)
    assert motion.status is Status.NON_FINITE
    assert motion.X.shape == (0, 1, 1)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"t": [1.0, 0.5]}, "t = .*increasing"),
        ({"t": [1.0, 1.0 + 1e-9]}, "t = .*must differ by"),
        ({"tol": 0.0}, "tol = 0.0: must be"),
        ({"tol": 1e-16}, "tol = 1e-16: must be"),
        ({"start": State(X=[[1.0, 2.0]], y=[1.0], v=[0.0])}, "X of shape"),
        ({"start": State(X=[[1.0]], y=[1.0], v=[0.5], U=[[0.1]])}, "must satisfy the constraint"),
        ({"start": State(X=[[1.0]], y=[0.0], v=[0.5])}, "full rank"),
    ],
)
def test_refuses_invalid_input(change: dict[str, Any], message: str) -> None:
    given: dict[str, Any] = {"start": fibre_start(2), "t": [1.0], "tol": 1e-6} | change
    with pytest.raises(InvalidModel, match=message):
        solve_dae(StraightFibre(**FIBRE), **given)


def test_refuses_particles_on_both_sides_of_a_fold_and_too_many_pairs() -> None:
    with pytest.raises(InvalidModel, match="one sign"):
        solve_dae(FOLD, State(X=[[0.1], [3.0]], y=[0.2], v=[0.1]), [1.0], 1e-6)
    with pytest.raises(InvalidModel, match="N = 61 particles with interaction: must be at most 60"):
        solve_dae(PLAIN["askew"][0](), start_of("askew", 61), [1.0], 1e-6)
