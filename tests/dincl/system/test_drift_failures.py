"""A drift called by its address fails with the same words as problem.velocity."""

import ctypes
from functools import partial

import numba
import numpy as np
import pytest

import dincl
from dincl.compiled import kernel
from dincl.drifts import attraction, compiled
from dincl.drifts.functions import OK, call_drift, velocity
from dincl.system.callbacks import DriftPointer, catching
from tests.dincl.system.drift_runs import X, asked, plain, run
from verification.instruments.budget import OutOfBudgetError


@partial(kernel, references=False)
def interrupted(interrupt, address, data, x, out):
    """An interrupt that arrives in compiled code, before the drift is called."""
    call_drift(interrupt, 0.0, x, out, 0, 0, data)
    return velocity(address, 0.0, x, out, x.shape[0], x.shape[1], data)


def after(t, wrong):
    """Good at first, so that the problem can be made, then wrong."""
    return lambda at, x: wrong(x) if at > t else -x


class Strange:
    def __repr__(self):
        return "Strange()"

    def __array__(self, *_, **__):
        raise RuntimeError("no numbers here")


def raises(error):
    def wrong(x):
        raise error

    return wrong


def fails_itself(x):
    return dincl.Problem([[0.0]], lambda t, x: x).velocity(0.0, np.array([[np.nan]]))


WRONG = {
    "shape": lambda x: x[0],
    "more": lambda x: np.vstack((x, x)),
    "number": lambda x: 1.0,
    "nan": lambda x: np.where(x == x[1, 1], np.nan, x),
    "inf of a list": lambda x: [[1.0, np.inf]] * len(x),
    "large": lambda x: x * 1e101,
    "nothing": lambda x: None,
    "text": lambda x: "fast",
    "bool": lambda x: x > 0,
    "complex": lambda x: x * 1j,
    "ragged": lambda x: [[1.0], [1.0, 2.0], []],
    "strange": lambda x: Strange(),
    "index": lambda x: x[99],
    "name": lambda x: nowhere,  # noqa: F821
    "division": lambda x: 1 / 0,
    "writes": lambda x: x.__setitem__(0, 0.0),
    "runtime": raises(RuntimeError("of my own")),
    "budget": raises(OutOfBudgetError()),
    "interrupt": raises(KeyboardInterrupt()),
    "exit": raises(SystemExit(3)),
    "assertion": raises(AssertionError("so")),
    "failure": fails_itself,
}


def raised(function, *arguments):
    try:
        function(*arguments)
    except BaseException as error:  # noqa: BLE001
        return error
    return None


def words(error):
    cause = error.__cause__
    return (
        type(error),
        str(error),
        getattr(error, "detail", None),
        getattr(error, "status", None),
        type(cause),
        str(cause),
    )


@pytest.mark.parametrize("name", WRONG)
def test_what_goes_wrong_comes_out_as_from_the_problem(name, capfd):
    problem = dincl.Problem(X, after(0.35, WRONG[name]))
    expected = raised(plain, problem)
    assert expected is not None
    assert words(raised(run, problem)) == words(expected)
    assert capfd.readouterr() == ("", "")


@numba.njit
def njit_shape(t, x):
    return x[:2] if t > 0.35 else -x


@numba.njit
def njit_nan(t, x):
    return x * np.nan if t > 0.35 else -x


@numba.njit
def njit_raises(t, x):
    if t > 0.35:
        raise ValueError("too late")
    return -x


@numba.njit
def njit_says(t, x):
    if t > 0.35:
        raise RuntimeError("at", t)
    return -x


@numba.njit
def njit_divides(t, x):
    return -x if t < 0.35 else x * (1 / (t - t))


@pytest.mark.slow_with("njit_nan", "njit_shape", "njit_says", "njit_divides")
@pytest.mark.parametrize("drift", [njit_shape, njit_nan, njit_raises, njit_says, njit_divides])
def test_compiled_functions_fail_with_the_same_words(drift, capfd):
    problem = dincl.Problem(X, drift)
    assert compiled(drift) is not None
    expected = raised(plain, problem)
    assert expected is not None
    assert words(raised(run, problem)) == words(expected)
    assert capfd.readouterr() == ("", "")


def test_an_affine_drift_that_overflows_says_where():
    problem = dincl.Problem([[1.0, 0.0]], attraction(0, -1e50))
    expected = raised(plain, problem)
    assert "at index (0, 0): must be finite" in str(expected)
    assert words(raised(run, problem)) == words(expected)


def test_a_failure_is_told_once():
    problem = dincl.Problem(X, after(0.35, WRONG["runtime"]))
    pointer, out = DriftPointer(problem), np.empty_like(X)
    code = asked(pointer.address, 0.5, X, out, 3, 2, pointer.data)
    with pytest.raises(RuntimeError, match="of my own"):
        pointer.failure(0.5, X, out, code)
    assert asked(pointer.address, 0.0, X, out, 3, 2, pointer.data) == OK
    assert np.array_equal(out, -X)


@pytest.mark.usefixtures("interruptible")
def test_an_interrupt_before_the_first_line_of_the_drift_is_heard(capfd):
    pointer, out = DriftPointer(dincl.Problem(X, lambda t, x: -x)), np.zeros_like(X)
    interrupt = ctypes.cast(ctypes.pythonapi.PyErr_SetInterrupt, ctypes.c_void_p).value
    with catching([pointer]):
        code = interrupted(interrupt, pointer.address, pointer.data, X, out)
        assert code != OK
        with pytest.raises(KeyboardInterrupt):
            pointer.failure(0.0, X, out, code)
    assert capfd.readouterr() == ("", "")


def test_others_hear_of_what_is_not_of_the_drift(monkeypatch):
    heard = []
    monkeypatch.setattr("sys.unraisablehook", heard.append)

    class Noisy:
        def __del__(self):
            raise RuntimeError

    with catching([DriftPointer(dincl.Problem(X, lambda t, x: -x))]):
        Noisy()
    Noisy()
    assert [found.exc_type for found in heard] == [RuntimeError, RuntimeError]
