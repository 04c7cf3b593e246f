"""Functions of a user that fail in the middle of a compiled run: it ends as the run of plain Python does."""

import ctypes
import re
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from functools import partial

import numpy as np
import pytest

import dincl
from dincl.compiled import kernel
from dincl.drifts.functions import call_drift
from dincl.rows.table import DISPLACEMENTS, call_python
from dincl.system.arrays import SETS
from dincl.system.compiled_problem import CompiledProblem
from tests.twins.events.scheme import PlainEventDriven

X0 = np.array([[0.0, 0.5], [1.0, 0.5]])
TIMES = [0.25, 0.5, 1.0]
# After this time functions fail; it lies between two steps.
LATE = 0.62


@partial(kernel, references=False)
def interrupted(interrupt, sets, x, out):
    """An interrupt that arrives in compiled code, before the sets are asked for."""
    if interrupt != 0:
        call_drift(interrupt, 0.0, x, out, 0, 0, out)
    return call_python(sets, 0.0, x, DISPLACEMENTS)


class OwnError(Exception):
    pass


class Counting:
    """x' = (1, -1): falls onto the floor y = 0 at t = 0.5, and tells all functions what time it is."""

    def __init__(self):
        self.t = 0.0

    def __call__(self, t, x):
        if not np.array_equal(x, X0):  # before a run, x0 is looked at for all times
            self.t = t
        return np.tile([0.1, -1.0], (2, 1))


def raises(error):
    def fault(value):
        raise error

    return fault


FAULTS = {
    "value": raises(ValueError("not here")),
    "own": raises(OwnError("mine")),
    "interrupt": raises(KeyboardInterrupt()),
    "exit": raises(SystemExit(3)),
    "nan": lambda value: value * np.nan,
    "shape": lambda value: np.append(value, 1.0),
    "nothing": lambda value: None,
}


def broken(place, fault):
    """Two particles that fall onto a floor, with a function that fails late: which one, and how."""
    clock = Counting()

    def late(where, t, value):
        return FAULTS[fault](value) if where == place and t > LATE else value

    def drift(t, x):
        return late("drift", t, clock(t, x))

    def g(x):
        return late("g", clock.t, x[:, 1] + 0.01 * x[:, 0] ** 2)

    def jacobian(x):
        rows = np.zeros((2, 2, 2))
        rows[[0, 1], [0, 1]] = np.stack((0.02 * x[:, 0], np.ones(2)), axis=1)
        return late("jacobian", clock.t, rows)

    def path(t):
        return late("path", t, np.array([0.0, 0.05 * np.sin(t)]))

    floor = dincl.Smooth(g, jacobian)
    if place == "path":
        floor = dincl.Moving(dincl.HalfSpace((0, 1)), path)
    return dincl.Problem(X0, drift, [floor, dincl.NonOverlap(0.4)])


def ending(problem, scheme):
    """How a run ended: the Trajectory, or what it raised."""
    try:
        return dincl.solve(problem, scheme, TIMES, throw=False)
    except (OwnError, ValueError, KeyboardInterrupt, SystemExit) as error:
        return error


STEPS = [dincl.CatchUp, dincl.LinearisedCatchUp, dincl.MidpointCatchUp]
PAIRS = [(make(1 / 32, dincl.ActiveSet(1e-10)), make(1 / 32, dincl.Daqp(1e-10))) for make in STEPS]


def same_ending(one, other):
    assert type(one) is type(other)
    if isinstance(one, BaseException):
        assert repr(one) == repr(other)
        return
    assert one.status is other.status
    assert one.detail == other.detail
    assert np.array_equal(one.t, other.t)
    assert np.abs(one.x - other.x).max() <= 1e-9


@pytest.mark.parametrize("pair", PAIRS, ids=lambda pair: type(pair[0]).__name__)
@pytest.mark.parametrize("fault", FAULTS)
@pytest.mark.parametrize("place", ["drift", "g", "jacobian", "path"])
def test_steps_end_as_in_plain_python(place, fault, pair):
    same_ending(*[ending(broken(place, fault), scheme) for scheme in pair])


@pytest.mark.parametrize("fault", FAULTS)
@pytest.mark.parametrize("place", ["drift", "g", "jacobian", "path"])
def test_event_driven_ends_as_in_plain_python(place, fault):
    run, plain = (ending(broken(place, fault), make(1e-8)) for make in (dincl.EventDriven, PlainEventDriven))
    assert type(run) is type(plain)
    if isinstance(run, BaseException):
        assert repr(run) == repr(plain)
        return
    assert run.status is plain.status
    # Plain Python lists the rows of g anew at each event, and so learns their number.
    told = [
        re.sub(r" This was.*|(?<=path)\(.*?\)|(?<=t = )[\d.]+| of shape \([2n],\)\.$", "", words)
        for words in (run.detail.split(" This was")[0], plain.detail.split(" This was")[0])
    ]
    assert told[0].rstrip(".") == told[1].rstrip(".") or (place, fault) == ("g", "shape")
    # Steps end at events and not at kept times: the last one may have looked past the failure from before 0.5.
    assert 0.4 < run.t[-1] <= LATE + 0.1
    kept = int((run.t[:-1] == plain.t[: len(run.t) - 1]).sum())
    assert kept == len(run.t) - 1 >= 1
    assert np.abs(run.x[:kept] - plain.x[:kept]).max() <= 1e-7


@pytest.mark.parametrize("scheme", [dincl.EventDriven(1e-8), *(pair[0] for pair in PAIRS)], ids=repr)
@pytest.mark.parametrize("error", [OwnError, KeyboardInterrupt])
def test_what_is_raised_once_is_heard_though_nothing_is_touched(error, scheme):
    """In whichever of the places where sets are asked for it comes: also where only a gap far away is looked at."""
    calls, last = 0, 1
    heard = []
    while True:

        def path(t, last=last):
            nonlocal calls
            calls += 1
            if calls == last:
                raise error
            return np.array([0.0, 0.1 * t])

        wall = dincl.Moving(dincl.HalfSpace((0, 1), -5.0), path)
        calls = -1000
        problem = dincl.Problem(X0, lambda t, x: np.tile([0.1, -1.0], (2, 1)), [wall])
        calls = 0
        try:
            dincl.solve(problem, scheme, [0.1])
        except (error, dincl.StepFailed, dincl.FunctionFailed) as ended:
            heard.append({type(ended), type(ended.__cause__), type(getattr(ended.__cause__, "__cause__", None))})
            last += 1 + last // 2
            continue
        break
    # Every run in which it was raised has ended with it.
    assert 5 < calls < last
    assert all(error in kinds for kinds in heard)


@pytest.mark.usefixtures("interruptible")
def test_an_interrupt_before_the_first_line_of_a_path_is_heard(capfd):
    wall = dincl.Moving(dincl.HalfSpace((0, 1), -5.0), lambda t: np.zeros(2))
    system = CompiledProblem(dincl.Problem(X0, lambda t, x: 0 * x, [wall]))
    interrupt = ctypes.cast(ctypes.pythonapi.PyErr_SetInterrupt, ctypes.c_void_p).value
    with system.callbacks():
        interrupted(interrupt, system.sets.arrays, X0.ravel().copy(), np.zeros(4))
        with pytest.raises(KeyboardInterrupt):
            system.failure(SETS)
        assert interrupted(0, system.sets.arrays, X0.ravel().copy(), np.zeros(4)) == 0
    assert capfd.readouterr() == ("", "")


def test_two_runs_interleaved_in_two_threads():
    """Each callback lets the other thread go on; the hook of the interpreter is left as it was."""
    hook, problems = sys.unraisablehook, [broken("nowhere", "nan") for _ in range(2)]

    def made(k, scheme):
        def drift(t, x):
            time.sleep(0)
            return problems[k].drift(t, x)

        problem = dincl.Problem(X0 + k, drift, problems[k].constraints)
        return dincl.solve(problem, scheme, TIMES)

    for scheme in (dincl.EventDriven(1e-8), PAIRS[0][0]):
        alone = [made(k, scheme).x for k in range(2)]
        with ThreadPoolExecutor(2) as pool:
            together = [run.x for run in pool.map(made, range(2), [scheme, scheme])]
        assert all(np.array_equal(x, y) for x, y in zip(alone, together, strict=True))
    assert sys.unraisablehook is hook
