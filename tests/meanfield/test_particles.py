"""Constrained equations by IDAS: closed forms, invariants, how runs end, invalid input."""

from functools import partial

import numpy as np
import pytest

from meanfield import (
    Model,
    SolveFailed,
    State,
    Status,
    StraightFibre,
    WavyFibre,
    solve_dae,
    solve_ode,
)
from meanfield.solvers import dae
from tests.meanfield.exact import CLOSED, FIBRE, K0, K1, REST, TIMES, M, fibre_start, worst

WAVY = WavyFibre(**FIBRE)
FOLD = Model(g=lambda X, y: X + X**3 / 3 - X**5 / 5 - y, W0=lambda y: -2 * y, W1=lambda X: 0 * X)
BLOW_UP = Model(g=lambda X, y: X - y, W0=lambda y: -(y**4), W1=lambda X: 0 * X)
SETTINGS = [
    *((f"dae {tol:g}", partial(solve_dae, tol=tol), 10 * tol) for tol in (1e-6, 1e-10)),
    *((f"ode {tol:g}", partial(solve_ode, tol=tol), 50 * tol) for tol in (1e-6, 1e-12)),
]


@pytest.mark.parametrize(("solve", "error"), [pytest.param(*rest, id=name) for name, *rest in SETTINGS])
@pytest.mark.parametrize("name", CLOSED)
def test_agrees_with_the_closed_form(name, solve, error):
    make, closed = CLOSED[name]
    for n in (1, 20):
        motion = solve(make(**FIBRE), fibre_start(n), TIMES)
        assert motion.status
        assert worst(motion, closed(fibre_start(n), TIMES)) < error


def test_stiff_springs_over_many_periods_to_twelve_digits():
    """Test multipliers of size 1e6 that pass through zero: a purely relative tolerance of 1e-12 is impossible there."""
    motion = solve_dae(WavyFibre(m=M, k0=1e6, y_rest=REST, k1=K1), fibre_start(3), [0.0, 0.05], 1e-12)
    assert motion.energy()[1] == pytest.approx(motion.energy()[0], rel=1e-9)


def test_output_times_do_not_restart_the_integrator():
    few, many = (solve_dae(WAVY, fibre_start(5), np.linspace(0, 4, k), 1e-9) for k in (2, 401))
    assert few.y[-1] == pytest.approx(many.y[-1], abs=1e-8)
    assert many.work.steps < 1.1 * few.work.steps
    assert few.work.unknowns == 2 + 5 * 4 + 1  # y, v; X, U, lambda and a sum each; y''


def test_length_zero_is_singular_and_the_part_before_is_right(capfd):
    model, at = StraightFibre(m=M, k0=K0, y_rest=-1.0, k1=K1), fibre_start(4)
    motion = solve_dae(model, at, TIMES, 1e-8, throw=False)
    reference = solve_ode(model, at, TIMES, 1e-10, throw=False)
    assert motion.status is reference.status is Status.SINGULAR
    assert 1 < len(motion.t) == len(reference.t) < len(TIMES)
    assert motion.multipliers == pytest.approx(reference.multipliers, abs=1e-7)
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("tol", [1e-5, 1e-10])
def test_a_fold_of_the_constraint_is_singular(tol, monkeypatch):
    monkeypatch.setattr(dae, "MAX_IDAS_STEPS", 5000)
    with pytest.raises(SolveFailed, match="det dg/dX") as caught:
        solve_dae(FOLD, State(X=[[0.1], [0.3]], y=[0.2], v=[0.1]), [0.1, 5.0], tol)
    assert caught.value.status is Status.SINGULAR
    assert caught.value.result.t.tolist() == [0.1]


def test_how_idas_fails(monkeypatch, capfd):
    at = State(X=[[0.5]], y=[1.0], v=[0.0])
    for model, t, most, status in (
        (BLOW_UP, [0.1, 9.0], 5000, Status.STEP_TOO_SMALL),
        (WAVY, [0.1, 90.0], 50, Status.TOO_MANY_STEPS),
    ):
        monkeypatch.setattr(dae, "MAX_IDAS_STEPS", most)
        motion = solve_dae(model, at, t, 1e-6, throw=False)
        assert (motion.status, len(motion.t)) == (status, 1)
        assert np.isfinite(motion.multipliers).all()
    root = Model(g=lambda X, y: X - y, W0=lambda y: y**1.5, W1=lambda X: 0 * X)
    motion = solve_dae(root, State(X=[[1.0]], y=[-1.0], v=[0.0]), [1.0], 1e-6, throw=False)
    assert (motion.status, motion.X.shape) == (Status.NON_FINITE, (0, 1, 1))
    assert capfd.readouterr() == ("", "")
