"""A drift called by its address gives the same numbers as problem.velocity, and is called as often."""

import gc
import weakref

import numba
import numpy as np
import pytest

import dincl
from dincl.drifts import attraction, compiled, constant, swirl
from dincl.problem import with_counted_drift
from dincl.system.callbacks import DriftPointer
from tests.dincl.system.drift_runs import X, plain, run
from verification.instruments.budget import DriftEvaluations, OutOfBudgetError, counted


@numba.njit
def njit_decay(t, x):
    return -x * (1 + t)


@numba.njit
def njit_same(t, x):
    return x


@numba.njit
def njit_whole(t, x):
    return np.full(x.shape, 2)


@numba.njit
def njit_transposed(t, x):
    return np.ascontiguousarray(x.T).T


@numba.njit(numba.float64[:, :](numba.float64, numba.types.Array(numba.float64, 2, "A", readonly=True)))
def njit_declared(t, x):
    return -1 * x


@numba.jit(forceobj=True)
def jit_object(t, x):
    return -x


@numba.njit
def njit_list(t, x):
    return [(1.0, 2.0) for _ in range(x.shape[0])]


GOOD = {
    "lambda": lambda t, x: -x,
    "time": lambda t, x: np.sin(t) * x,
    "same": lambda t, x: x,
    "view": lambda t, x: x[::-1],
    "whole": lambda t, x: np.ones(x.shape, int),
    "single": lambda t, x: x.astype(np.float32),
    "list": lambda t, x: [[1, 2]] * len(x),
    "swapped": lambda t, x: x.astype(">f8"),
    "constant": constant((1.0, 2.0)),
    "swirl": swirl((1.0, 0.0), 3.0) + attraction(0),
    "njit": njit_decay,
    "njit same": njit_same,
    "njit whole": njit_whole,
    "njit transposed": njit_transposed,
    "njit list": njit_list,
    "njit declared": njit_declared,
    "jit object": jit_object,
}
IN_MACHINE_CODE = {"constant", "swirl", "njit", "njit same", "njit whole", "njit transposed"}


@pytest.mark.slow_with("njit whole", "njit transposed")
@pytest.mark.filterwarnings("ignore::numba.core.errors.NumbaPendingDeprecationWarning")
@pytest.mark.parametrize("name", GOOD)
def test_the_numbers_are_those_of_the_problem(name):
    problem = dincl.Problem(X, GOOD[name])
    assert (compiled(problem.drift) is not None) == (name in IN_MACHINE_CODE)
    assert run(problem).tobytes() == plain(problem).tobytes()


def test_a_drift_cannot_write_to_the_state_but_may_keep_it():
    kept = []

    def keeps(t, x):
        assert not x.flags.writeable
        kept.append(x if len(kept) % 2 else x[1:])  # a part keeps the whole
        return -x

    problem = dincl.Problem(X, keeps)
    found = []
    for made in (run, plain):
        kept.clear()
        made(problem)
        found.append([x.tobytes() for x in kept])
    assert found[0] == found[1]
    assert len(set(found[0])) == 7


def test_a_drift_is_called_once_for_each_evaluation():
    calls = []
    problem = dincl.Problem(X, lambda t, x: calls.append(t) or -x)
    calls.clear()
    run(problem, steps=5, h=0.5)
    assert calls == [0.0, 0.5, 1.0, 1.5, 2.0]


def test_a_function_of_numba_is_compiled_once():
    assert compiled(njit_decay).pointer()[0] == compiled(njit_decay).pointer()[0]
    assert DriftPointer(dincl.Problem(X, njit_decay)).address == compiled(njit_decay).pointer()[0]


@pytest.mark.parametrize("drift", [lambda t, x: -x, constant((1.0, 0.0))])
def test_nothing_outlives_the_pointer(drift):
    pointer = DriftPointer(dincl.Problem(X, drift))
    gone = weakref.ref(pointer)
    del pointer
    gc.collect()
    assert gone() is None


@pytest.mark.slow
def test_a_function_of_numba_is_forgotten_with_its_machine_code():
    function = numba.njit(lambda t, x: 3 * x)
    assert run(dincl.Problem(X, function)).tobytes() == plain(dincl.Problem(X, function)).tobytes()
    gone = weakref.ref(function)
    del function
    gc.collect()
    assert gone() is None


@pytest.mark.parametrize("drift", [attraction(0), njit_decay])
def test_a_counted_drift_stays_compiled_and_stops_the_run(drift):
    problem, count = counted(dincl.Problem(X, drift), DriftEvaluations(20))
    assert compiled(problem.drift).pointer()[0] == compiled(drift).pointer()[0]
    assert run(problem, steps=20).tobytes() == plain(dincl.Problem(X, drift), steps=20).tobytes()
    assert count.evaluations == 20
    with pytest.raises(OutOfBudgetError):
        run(problem, steps=10, slices=100)
    assert count.evaluations == 30
    with pytest.raises(OutOfBudgetError):
        problem.velocity(0.0, X)


def test_a_counted_function_of_python_stops_the_run_at_the_evaluation():
    problem, count = counted(dincl.Problem(X, lambda t, x: -x), DriftEvaluations(20))
    with pytest.raises(OutOfBudgetError):
        run(problem, steps=100)
    assert count.evaluations == 21


def test_a_limit_is_looked_at_whenever_python_is_asked_for_the_sets():
    """The drift is compiled and says late how often it was called; a slow set must not keep the run from ending."""
    asked = []

    def radius(t):
        asked.append(t)
        return 0.5 * (1 + 1e-3 * t)

    growing = dincl.Problem([[0.0, 0.0], [2.0, 0.0]], constant((0.0, 1.0)), [dincl.NonOverlap(radius)])
    limited, _ = with_counted_drift(growing, lambda _: len(asked) > 400)
    for scheme in (dincl.EventDriven(1e-6), dincl.PBD(1e-3)):
        asked.clear()
        with pytest.raises(OutOfBudgetError):
            dincl.solve(limited, scheme, [10.0])
        assert 400 < len(asked) < 460
