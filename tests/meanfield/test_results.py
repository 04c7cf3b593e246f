"""Results of all solvers: one line and pickling."""

import pickle
from dataclasses import fields

import numpy as np
import pytest

import meanfield as mf
from tests.meanfield.models import EVERY, MODELS, start

T = [0.0, 0.5, 1.0]
FIBRE = mf.WavyFibre(m=0.5, k0=1.0, y_rest=1.5, k1=0.5)
CLOSED = mf.StraightFibre(m=0.5, k0=1.0, y_rest=1.5, k1=0.5)
LINE = mf.Density.bump(1.0, 0.6)
RESULTS = {
    "Motion": (lambda: mf.solve_dae(FIBRE, few(), T, 1e-8), "N = 6, nx = 1"),
    "Flow": (lambda: mf.solve_characteristics(FIBRE, LINE, [1.0], [0.5], T, 1e-6), "nodes, nx = 1"),
    "GridMotion": (lambda: mf.solve_pde(FIBRE, LINE, [1.0], [0.5], T, 40), "40 cells"),
    "MomentMotion": (
        lambda: mf.solve_moments(CLOSED, mf.Moments(*LINE.moments()), [1.0], [0.5], T, 1e-8), "nx = 1"
    ),
}  # fmt: skip


def few():
    return mf.State(X=LINE.sample(np.random.default_rng(1), 6), y=[1.0], v=[0.5])


@pytest.mark.parametrize("name", RESULTS)
def test_line_and_pickle(name):
    make, size = RESULTS[name]
    result = make()
    assert repr(result).startswith(f"{name}(SUCCESS, 3 output times to t = 1, ")
    assert repr(result).endswith(f"{size}, ny = 1)")
    again = pickle.loads(pickle.dumps(result))
    for field in fields(result):
        if field.name != "model":
            np.testing.assert_equal(getattr(again, field.name), getattr(result, field.name))
    np.testing.assert_array_equal(again.energy(), result.energy())


def test_a_run_that_failed_at_once_has_a_line():
    model = mf.StraightFibre(m=0.5, k0=1.0, y_rest=-5.0, k1=0.0)
    motion = mf.solve_ode(model, mf.State(X=[[0.5]], y=[0.1], v=[-2.0]), [5.0], 1e-8, throw=False)
    assert not motion.status
    assert len(motion.t) == 0
    assert repr(motion).startswith(f"Motion({motion.status.name}, 0 output times, N = 1")


@pytest.mark.parametrize("name", EVERY)
def test_a_pickled_model_gives_the_same_bits(name):
    model, at = MODELS[name], start(name, 4)
    again = pickle.loads(pickle.dumps(model))
    assert again.m == model.m
    one, two = (mf.solve_ode(m, at, [0.2], 1e-8) for m in (model, again))
    for part in ("y", "X", "multipliers"):
        np.testing.assert_array_equal(getattr(one, part), getattr(two, part))


def test_densities_pickle():
    for density in (mf.Density.uniform(0.0, 1.0), mf.Density.normal([0.0, 1.0], [1.0, 2.0]), LINE):
        again = pickle.loads(pickle.dumps(density))
        one, two = (law.sample(np.random.default_rng(0), 20) for law in (density, again))
        np.testing.assert_array_equal(one, two)
        np.testing.assert_array_equal(again.density(one), density.density(one))


def test_a_failure_pickles_with_its_result():
    model = mf.StraightFibre(m=0.5, k0=1.0, y_rest=-5.0, k1=0.0)
    with pytest.raises(mf.SolveFailed) as caught:
        mf.solve_ode(model, mf.State(X=[[0.5]], y=[0.1], v=[-2.0]), [0.01, 5.0], 1e-8)
    again = pickle.loads(pickle.dumps(caught.value))
    assert str(again) == str(caught.value)
    assert again.status is mf.Status.SINGULAR
    np.testing.assert_array_equal(again.result.y, caught.value.result.y)
