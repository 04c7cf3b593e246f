"""Contract of every solver on every model: shapes, start, constraint, energy, agreement, failures."""

from dataclasses import FrozenInstanceError
from functools import partial

import numpy as np
import pytest

import meanfield
from meanfield import Density, State, Status
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


BUMP, CORNERS = Density.bump(0.3, 1.0), State([[0.1], [3.0]], [0.2], [0.1])
PARTICLES_GOOD = {"model": MODELS["straight"], "start": State([[0.2]], [1.0], [1.0]), "t": [1.0], "tol": 1e-6}
DENSITY_GOOD = {"model": MODELS["wavy"], "density": BUMP, "y0": [0.2], "v0": [0.5], "t": [1.0]}
FOLD = meanfield.Model(g=lambda X, y: X + X**3 / 3 - X**5 / 5 - y, W0=lambda y: -2 * y, W1=lambda X: 0 * X)
PLANE = meanfield.Model(g=lambda X, y: X - y, W0=lambda y: y, W1=lambda X: X[0], nx=2)
BOTH, LIMITS = ("solve_ode", "solve_dae"), ("solve_characteristics", "solve_pde")
BAD = [  # solvers, what is changed, the message
    (BOTH, {"start": State([[0.2, 0.1]], [1.0], [1.0])}, "must have X of shape"),
    (BOTH, {"start": State([[0.2]], [0.0], [1.0])}, r"y = array\(\[0.\]\): dg/dX must have full rank"),
    (BOTH, {"model": FOLD, "start": CORNERS}, "1 positive and 1 other values at the start: must be of one sign"),
    (BOTH, {"t": [2.0, 1.0]}, "increasing times"),
    (BOTH, {"tol": 0.0}, "tol = 0.0: must be"),
    (BOTH, {"tol": 1e-15}, "tol = 1e-15: must be from 1e-13"),
    (("solve_dae",), {"t": [1.0, 1.0 + 1e-9]}, "t = .*must differ by"),
    (("solve_dae",), {"model": MODELS["bending"], "start": start("bending", 61)}, "N = 61 .*: must be at most 60"),
    (LIMITS, {"density": Density.uniform((0.0, 0.0), (1.0, 1.0))}, "density has nx = 2: must be 1"),
    (LIMITS, {"y0": [0.0, 1.0]}, "y0 = .*shape"),
    (LIMITS, {"v0": [np.inf]}, "v0 = inf"),
    (LIMITS, {"t": [-1.0, 1.0]}, "t = .*increasing"),
    (("solve_characteristics",), {"tol": 0.0}, "tol = 0.0: must be"),
    (("solve_characteristics",), {"model": MODELS["straight"], "y0": [0.0]}, "dg/dX"),
    (("solve_pde",), {"cells": 7}, "cells = 7: must be an integer from 8"),
    (("solve_pde",), {"cells": 40.0}, "cells = 40.0"),
    (("solve_pde",), {"bounds": (2.0, -2.0)}, "lower one must be below"),
    (("solve_pde",), {"bounds": (-2.0, 2.0, 3.0)}, "bounds = .*shape"),
    (("solve_pde",), {"bounds": (0.0, 4.0)}, "bounds hold 0.82828.* of the mass"),
    (("solve_pde",), {"model": MODELS["straight"], "y0": [0.0], "bounds": (-2.0, 4.0)}, "y0 = .*the model must hold"),
    (("solve_pde",), {"model": PLANE, "density": Density.bump([0, 0], 1.0)}, "nx = 2: must be 1"),
]


@pytest.mark.parametrize(
    ("solver", "change", "message"), [(name, change, message) for names, change, message in BAD for name in names]
)
def test_bad_input(solver, change, message):
    good = PARTICLES_GOOD if solver in BOTH else DENSITY_GOOD
    more = {"tol": 1e-8} if solver == "solve_characteristics" else {"cells": 20} if solver == "solve_pde" else {}
    with pytest.raises(meanfield.InvalidModel, match=message):
        getattr(meanfield, solver)(**(good | more | change))
