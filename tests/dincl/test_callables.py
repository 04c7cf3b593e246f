"""Functions of users: what they raise comes out chained, under one error that names the function and its arguments."""

import pickle

import numpy as np
import pytest

import dincl
from dincl.callables import UserFunction

PDF = UserFunction("pdf", ("x", "scale"), dincl.Status.FUNCTION_FAILED)


def raising(error):
    def function(*_):
        raise error

    return function


@pytest.mark.parametrize("error", [KeyError("k"), RuntimeError(), OSError(2, "no"), dincl.InvalidProblem("within")])
def test_what_is_raised_is_the_cause(error):
    with pytest.raises(dincl.FunctionFailed) as caught:
        PDF.call(raising(error), np.zeros((4, 2)), 0.5)
    assert caught.value.__cause__ is error
    said = f": {error}" if str(error) else ""
    assert caught.value.detail == f"pdf(x of shape (4, 2), scale = 0.5) raised {type(error).__name__}{said}."
    assert isinstance(caught.value, dincl.InvalidProblem)
    assert isinstance(caught.value, dincl.StepFailure)


@pytest.mark.parametrize("error", [KeyboardInterrupt, SystemExit, MemoryError, GeneratorExit])
def test_what_is_not_of_the_function_passes_through(error):
    with pytest.raises(error):
        PDF.call(raising(error), 0.0)


@pytest.mark.parametrize(
    ("value", "words"),
    [
        (None, "returned None: must be real numbers of shape (n, 2)"),
        (np.ones(3), "returned an array of shape (3,): must be"),
        ([[0.0, np.nan]], "returned nan at index (0, 1): must be finite"),
        ([[0, 10**400]], "returned inf at index (0, 1)"),
        (np.ma.masked_less([[1.0, 2.0]], 1.5), "must be real numbers"),
    ],
)
def test_what_is_returned_is_judged(value, words):
    with pytest.raises(dincl.FunctionFailed) as caught:
        PDF.evaluated(lambda x: value, 0.0, shape=(None, 2))
    assert words in caught.value.detail


def test_errors_with_a_status_pass_between_processes():
    for kind in (dincl.FunctionFailed, dincl.StepFailure, dincl.ProjectionFailed):
        again = pickle.loads(pickle.dumps(kind(dincl.Status.DRIFT_FAILED, "so")))
        assert (type(again), again.status, again.detail) == (kind, dincl.Status.DRIFT_FAILED, "so")


@pytest.mark.parametrize("scheme", [dincl.PBD(0.1), dincl.EventDriven(1e-6), dincl.CatchUp(0.1, dincl.Daqp(1e-9))])
def test_a_run_keeps_what_was_computed_and_the_cause(scheme):
    def drift(t, x):
        return -x if t < 0.55 else {}["k"]

    problem = dincl.Problem([[1.0, 2.0]], drift, [dincl.HalfSpace((0, 1))])
    with pytest.raises(dincl.StepFailed) as caught:
        dincl.solve(problem, scheme, [0.2, 1.0])
    assert caught.value.trajectory.status is dincl.Status.DRIFT_FAILED
    assert 0.05 < caught.value.trajectory.t[-1] < 0.61
    assert isinstance(caught.value.__cause__, dincl.FunctionFailed)
    assert isinstance(caught.value.__cause__.__cause__, KeyError)
