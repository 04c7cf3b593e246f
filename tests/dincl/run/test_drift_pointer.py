"""A drift called by its address gives the same numbers, and fails with the same words, as problem.velocity."""

import ctypes
import gc
import weakref
from functools import partial

import numba
import numpy as np
import pytest

import dincl
from dincl.compile import kernel
from dincl.drifts import attraction, compiled, constant, swirl
from dincl.kernels.pointers import OK, call_path, velocity
from dincl.run.drift_pointer import DriftPointer
from verification.budget import DriftEvaluations, OutOfBudgetError, counted

X = np.array([[0.5, -0.25], [1.0, 3.0], [-0.0, 2.0]])


@partial(kernel, references=False)
def descend(address, data, h, steps, x, out):
    """Explicit Euler; the evaluations made, and the code of the last one."""
    for k in range(steps):
        code = velocity(address, k * h, x, out, x.shape[0], x.shape[1], data)
        if code != OK:
            return k + 1, code
        for i in range(x.shape[0]):
            for j in range(x.shape[1]):
                x[i, j] += h * out[i, j]
    return steps, OK


@partial(kernel, references=False)
def interrupted(interrupt, address, data, x, out):
    """An interrupt that arrives in compiled code, before the drift is called."""
    call_path(interrupt, 0.0, out)
    return velocity(address, 0.0, x, out, x.shape[0], x.shape[1], data)


def run(problem, steps=7, h=0.1, slices=1):
    """A small compiled run."""
    pointer, x = DriftPointer(problem), problem.x0.copy()
    out = np.empty_like(x)
    with pointer:
        for _ in range(slices):
            evaluations, code = descend(pointer.address, pointer.data, h, steps, x, out)
            pointer.made(evaluations)
            if code != OK:
                pointer.failure((evaluations - 1) * h, x, out, code)
    return x


def plain(problem, steps=7, h=0.1):
    x = problem.x0.copy()
    for k in range(steps):
        x = x + h * problem.velocity(k * h, x)
    return x


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


@pytest.mark.filterwarnings("ignore::numba.core.errors.NumbaPendingDeprecationWarning")
@pytest.mark.parametrize("name", GOOD)
def test_the_numbers_are_those_of_the_problem(name):
    problem = dincl.Problem(X, GOOD[name])
    assert (compiled(problem.drift) is not None) == (name in IN_MACHINE_CODE)
    assert run(problem).tobytes() == plain(problem).tobytes()


def after(t, wrong):
    """Good at first, so that the problem can be made, then wrong."""
    return lambda at, x: wrong(x) if at > t else -x


class Strange:
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
    code = velocity(pointer.address, 0.5, X, out, 3, 2, pointer.data)
    with pytest.raises(RuntimeError, match="of my own"):
        pointer.failure(0.5, X, out, code)
    assert velocity(pointer.address, 0.0, X, out, 3, 2, pointer.data) == OK
    assert np.array_equal(out, -X)


def test_an_interrupt_before_the_first_line_of_the_drift_is_heard(capfd):
    pointer, out = DriftPointer(dincl.Problem(X, lambda t, x: -x)), np.zeros_like(X)
    interrupt = ctypes.cast(ctypes.pythonapi.PyErr_SetInterrupt, ctypes.c_void_p).value
    with pointer:
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

    with DriftPointer(dincl.Problem(X, lambda t, x: -x)):
        Noisy()
    Noisy()
    assert [found.exc_type for found in heard] == [RuntimeError, RuntimeError]


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
