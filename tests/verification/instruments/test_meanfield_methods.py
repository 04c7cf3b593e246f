"""The solvers of meanfield in the instruments: orders, a chart of all levels of the model, refusals."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

import meanfield as mf
import verification as v
from dincl import InvalidProblem

T = [0.5, 1.0]
LAW = mf.Density.bump(1.0, 0.6)
STRAIGHT = mf.StraightFibre(m=1.0, k0=1.0, y_rest=1.5, k1=0.5)
WAVY = mf.WavyFibre(m=1.0, k0=1.0, y_rest=1.5, k1=0.5)
START = mf.State(X=LAW.sample(np.random.default_rng(1), 4), y=[1.0], v=[0.5])
PARTICLES, DENSITY = v.particle_methods(), v.density_methods()


def limit(t: list[float]) -> np.ndarray:
    return mf.solve_moments(STRAIGHT, mf.Moments(*LAW.moments()), [1.0], [0.5], t, 1e-13).y


@pytest.mark.parametrize("name", PARTICLES)
def test_methods_of_particles_follow_their_tolerance(name):
    found = PARTICLES[name].run(v.ParticleProblem(STRAIGHT, START), 1e-9, T)
    np.testing.assert_allclose(found, mf.solve_ode(STRAIGHT, START, T, 1e-12).y, atol=1e-7)


@pytest.mark.slow_with("ode")
@pytest.mark.parametrize("name", DENSITY)
def test_every_method_finds_the_limit(name):
    """N quantiles miss the second moment by some 1/(30 N); the grid has an error of second order in 1/cells."""
    settings = {"tol": 1e-9, "1/N": 1 / 32, "1/cells": 1 / 32}
    errors = {"tol": 1e-7, "1/N": 1e-3, "1/cells": 3e-3}
    method = DENSITY[name]
    found = method.run(v.DensityProblem(STRAIGHT, LAW, [1.0], [0.5]), settings[method.setting], T)
    assert found.shape == (2, 1)
    assert np.abs(found - limit(T)).max() < errors[method.setting]


@pytest.mark.slow
def test_all_levels_of_a_model_stand_on_one_chart():
    chart = v.work_precision(
        v.DensityProblem(STRAIGHT, LAW, [1.0], [0.5]),
        [DENSITY[name] for name in ("ode", "moments", "pde")],
        {"tol": [1e-3, 1e-6], "1/N": [1 / 4, 1 / 128], "1/cells": [1 / 16, 1 / 32]},
        T,
        limit,
        v.CpuSeconds(5.0),
        errors=("largest",),
    )
    assert (chart.table["status"] == "SUCCESS").all()
    finest = chart.table.groupby("method")["largest"].min()
    assert finest["Moments"] < 1e-6 < finest["ODE (DOP853)"] < 1e-3
    assert len(chart.plot().lines) >= 3


def test_what_a_model_does_not_allow_is_a_refused_row():
    problem = v.DensityProblem(WAVY, LAW, [1.0], [0.5])
    study = v.order_study(problem, [DENSITY["moments"]], [10.0**-k for k in range(3, 8)], T, limit(T))
    assert study.table["status"].iloc[0] == "REFUSED"
    assert "do not close" in study.table["detail"].iloc[0]


def test_problems_of_the_other_kind_are_refused_with_the_name_of_the_right_one():
    with pytest.raises(InvalidProblem, match=r"must be a ParticleProblem\(model, start\)"):
        PARTICLES["dae"].run(v.DensityProblem(STRAIGHT, LAW, [1.0], [0.5]), 1e-6, T)
    with pytest.raises(InvalidProblem, match="must be a DensityProblem"):
        DENSITY["pde"].run(v.ParticleProblem(STRAIGHT, START), 1e-2, T)


def test_methods_and_problems_pickle():
    problem, method = pickle.loads(pickle.dumps((v.ParticleProblem(WAVY, START), PARTICLES["ode"])))
    same = PARTICLES["ode"].run(v.ParticleProblem(WAVY, START), 1e-6, T)
    np.testing.assert_array_equal(method.run(problem, 1e-6, T), same)
