"""Contract of every solver on every model: shapes, start, constraint, energy, agreement, failures."""

from dataclasses import FrozenInstanceError
from functools import partial

import numpy as np
import pytest

import meanfield
from meanfield import Status
from tests.meanfield.models import EVERY, MODELS, start

TIMES = np.array([0.0, 0.4, 1.0])
PARTICLES = 4
ERROR = 1e-6


# Each solver of particles, at a setting with an error below ERROR.
SOLVERS = {
    "ode": partial(meanfield.solve_ode, tol=1e-8),
    "dae": partial(meanfield.solve_dae, tol=1e-8),
}
ON_ALL = pytest.mark.parametrize("solver", SOLVERS)


@pytest.fixture(scope="module")
def best():
    """Compute the motions at a tighter tolerance."""
    return {name: meanfield.solve_ode(MODELS[name], start(name, PARTICLES), TIMES, 1e-12) for name in MODELS}


@ON_ALL
@pytest.mark.parametrize("name", EVERY)
def test_solvers_agree(solver, name, best):
    model, state = MODELS[name], start(name, PARTICLES)
    motion = SOLVERS[solver](model, state, TIMES)
    assert motion.status is Status.SUCCESS
    assert motion.detail == ""
    np.testing.assert_array_equal(motion.t, TIMES)
    assert motion.y.shape == motion.v.shape == (3, model.ny)
    assert motion.X.shape == motion.U.shape == motion.multipliers.shape == (3, PARTICLES, model.nx)
    np.testing.assert_allclose(motion.X[0], state.X, atol=1e-12)
    np.testing.assert_allclose(motion.y[0], state.y, atol=1e-15)
    for part in ("y", "v", "X", "U", "multipliers"):
        np.testing.assert_allclose(getattr(motion, part), getattr(best[name], part), atol=ERROR, err_msg=part)
    assert motion.constraint_drift().max() < ERROR
    assert motion.velocity_drift().max() < ERROR
    np.testing.assert_allclose(motion.energy(), best[name].energy()[0], atol=ERROR)
    with pytest.raises(FrozenInstanceError):
        motion.y = None


@ON_ALL
def test_a_failure_is_returned_or_raised(solver):
    """Test a fibre that is pushed through y = 0 near t = 0.33."""
    state = meanfield.State(X=[[0.5], [-1.0]], y=[1.0], v=[-3.0])
    t = [0.0, 0.1, 0.2, 0.6, 0.7]
    motion = SOLVERS[solver](MODELS["straight"], state, t, throw=False)
    assert not motion.status
    assert motion.detail
    np.testing.assert_array_equal(motion.t, [0.0, 0.1, 0.2])
    assert np.isfinite(motion.X).all()
    assert motion.constraint_drift().max() < ERROR
    with pytest.raises(meanfield.SolveFailed) as caught:
        SOLVERS[solver](MODELS["straight"], state, t)
    np.testing.assert_array_equal(caught.value.result.y, motion.y)


@ON_ALL
@pytest.mark.parametrize(
    ("state", "t", "message"),
    [
        (meanfield.State([[0.2, 0.1]], [1.0], [1.0]), [1.0], "must have X of shape"),
        (meanfield.State([[0.2]], [0.0], [1.0]), [1.0], "full rank"),
        (meanfield.State([[0.2]], [1.0], [1.0]), [2.0, 1.0], "increasing times"),
    ],
)
def test_bad_input(solver, state, t, message):
    with pytest.raises(meanfield.InvalidModel, match=message):
        SOLVERS[solver](MODELS["straight"], state, t)
