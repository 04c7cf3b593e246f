"""Functions of a user that fail in the middle of a run: what fails, where, under which scheme.

A run ends with a Status that names the function, and keeps what was computed; what is no Exception passes through.
"""

import pickle
import signal
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numba
import numpy as np
import pytest

import dincl
from dincl.projection import Solver
from verification.instruments.budget import DriftEvaluations, OutOfBudgetError, counted

X0 = np.array([[0.0, 0.5], [1.0, 0.5]])
TIMES = [0.25, 0.5, 1.0]
# After this time functions fail; it lies between two steps, on the floor.
LATE, DT = 0.62, 1 / 32

ACTIVE, DAQP = dincl.ActiveSet(1e-10), dincl.Daqp(1e-10)
SCHEMES = {
    "PBD": dincl.PBD(DT),
    "XPBD": dincl.XPBD(DT, sweeps=3),
    "SecondOrderPBD": dincl.SecondOrderPBD(DT, v0=[[0.1, -1.0], [0.1, -1.0]]),
    "Penalty": dincl.Penalty(DT, strength=5.0),
    "CatchUp": dincl.CatchUp(DT, ACTIVE),
    "CatchUp Daqp": dincl.CatchUp(DT, DAQP),
    "LinearisedCatchUp": dincl.LinearisedCatchUp(DT, ACTIVE),
    "MidpointCatchUp": dincl.MidpointCatchUp(DT, ACTIVE),
    "MidpointCatchUp Daqp": dincl.MidpointCatchUp(DT, DAQP),
    "AdaptiveCatchUp": dincl.AdaptiveCatchUp(1e-4),
    "Auto": dincl.Auto(1e-4),
    "EventDriven": dincl.EventDriven(1e-8),
}


class OwnError(Exception):
    pass


def raises(error):
    def fault(value):
        raise error

    return fault


class Strange:
    def __array__(self, *_, **__):
        raise RuntimeError("no numbers here")


FAULTS = {
    "raises": (raises(ValueError("not here")), "raised ValueError: not here"),
    "own error": (raises(OwnError("mine")), "raised OwnError: mine"),
    "nan": (lambda value: np.multiply(value, np.nan), "returned nan"),
    "large": (lambda value: np.add(value, 1e101), "must be finite"),
    "shape": (lambda value: np.append(value, [[1.0], [1.0]]), "shape"),
    "None": (lambda value: None, "returned None"),
    "text": (lambda value: "fast", "returned 'fast'"),
    "complex": (lambda value: np.multiply(value, 1j), "real numbers"),
    "ragged": (lambda value: [[1.0], [1.0, 2.0]], "real numbers"),
    "masked": (lambda value: np.ma.masked_less(np.add(value, 0.0), 1e9), "real numbers"),
    "strange": (lambda value: Strange(), "real numbers"),
}
PASSED_ON = {"interrupt": KeyboardInterrupt(), "exit": SystemExit(3), "memory": MemoryError()}
PLACES = ["drift", "g", "jacobian", "values", "path", "rotation", "offset"]


def normals(x):
    rows = np.zeros((2, 2, 2))
    rows[[0, 1], [0, 1]] = np.stack((0.02 * x[:, 0], np.ones(2)), axis=1)
    return rows


def broken(place, fault):
    """Two particles that fall onto a floor, which one function of place ``place`` describes until it fails."""
    now = 0.0

    def late(where, t, value):
        return fault(value) if where == place and t > LATE else value

    def drift(t, x):
        nonlocal now
        if not np.array_equal(x, X0):  # before a run, x0 is looked at for all times
            now = t
        return late("drift", t, np.tile([0.1, -1.0], (2, 1)))

    def height(x):
        return x[:, 1] + 0.01 * x[:, 0] ** 2

    class Floor(dincl.DifferentiableConstraint):
        def values(self, x):
            return late("values", now, height(x))

        def jacobian(self, x):
            return normals(x)

    wall = dincl.HalfSpace((0, 1))
    floors = {
        "values": Floor(),
        "path": dincl.Moving(wall, lambda t: late("path", t, np.array([0.0, 0.05 * t]))),
        "rotation": dincl.Moving(wall, dincl.RigidMotion(lambda t: late("rotation", t, np.array(0.01 * t)))),
        "offset": dincl.HalfSpace((0, 1), lambda t: late("offset", t, 0.05 * t)),
    }
    smooth = dincl.Smooth(lambda x: late("g", now, height(x)), lambda x: late("jacobian", now, normals(x)))
    return dincl.Problem(X0, drift, [floors.get(place, smooth), dincl.NonOverlap(0.4)])


places = pytest.mark.parametrize("place", PLACES)
schemes = pytest.mark.parametrize("name", SCHEMES)


@pytest.mark.slow_with("EventDriven", "Auto")
@schemes
@places
def test_a_function_that_fails_ends_the_run_and_is_named(place, name):
    scheme, healthy = SCHEMES[name], dincl.solve(broken(place, None), SCHEMES[name], TIMES[:2])
    for fault, words in FAULTS.values():
        with pytest.raises(dincl.StepFailed) as caught:
            dincl.solve(broken(place, fault), scheme, TIMES)
        path, cause = caught.value.trajectory, caught.value.__cause__
        drift = place == "drift"
        assert path.status is (dincl.Status.DRIFT_FAILED if drift else dincl.Status.CONSTRAINT_FAILED)
        assert place in path.detail
        assert words in path.detail or (place, words) == ("offset", "shape")
        if "raised" in words:
            assert type(cause) is dincl.FunctionFailed
            assert type(cause.__cause__) in (ValueError, OwnError)
        if isinstance(scheme, dincl.FixedStep):
            assert path.t[:2].tolist() == TIMES[:2]
            assert LATE - 2 * DT < path.t[-1] < LATE + DT
            assert np.array_equal(path.x[:2], healthy.x)
        else:  # which may have looked past the failure from before an output time
            assert 0.25 == path.t[0] < path.t[-1] < LATE + 0.05
            assert np.abs(path.x[0] - healthy.x[0]).max() < 1e-2


@pytest.mark.parametrize("fault", PASSED_ON)
@schemes
@places
def test_what_is_no_exception_of_the_function_passes_through(place, name, fault, capfd):
    """So does an interrupt that the system delivers while the function is at work."""
    with pytest.raises(type(PASSED_ON[fault])) as caught:
        dincl.solve(broken(place, raises(PASSED_ON[fault])), SCHEMES[name], TIMES)
    assert caught.value is PASSED_ON[fault]
    assert capfd.readouterr() == ("", "")


@schemes
def test_an_interrupt_of_the_system_ends_a_run(name):
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        for place in ("drift", "path"):
            with pytest.raises(KeyboardInterrupt):
                dincl.solve(
                    broken(place, lambda value: signal.raise_signal(signal.SIGINT) or value), SCHEMES[name], TIMES
                )
    finally:
        signal.signal(signal.SIGINT, before)


@pytest.mark.parametrize("error", [OwnError, KeyboardInterrupt])
@pytest.mark.parametrize("name", ["PBD", "CatchUp", "MidpointCatchUp", "EventDriven"])
def test_what_is_raised_once_is_heard_though_nothing_is_touched(error, name):
    """In whichever of the calls it comes: also where only a gap far away is looked at."""
    calls, last, heard, ended = 0, 1, 0, True
    while ended is not None:

        def path(t, last=last):
            nonlocal calls
            calls += 1
            if calls == last:
                raise error
            return np.array([0.0, 0.1 * t])

        calls = -1000
        wall = dincl.Moving(dincl.HalfSpace((0, 1), -5.0), path)
        problem = dincl.Problem(X0, lambda t, x: np.tile([0.1, -1.0], (2, 1)), [wall])
        calls, ended = 0, None
        try:
            dincl.solve(problem, SCHEMES[name], [0.25])
        except (error, dincl.StepFailed, dincl.FunctionFailed) as raised:
            ended = raised
            chain = [ended, ended.__cause__, getattr(ended.__cause__, "__cause__", None)]
            assert error in map(type, chain)
            heard, last = heard + 1, last + 1 + last // 2
    assert heard > 2
    assert calls < last


class Failing(Solver):
    """A solver of the user's own."""

    name = "failing"
    answer: object = None

    def compute(self, *given):
        return self.answer() if callable(self.answer) else self.answer


@dataclass(frozen=True)
class Own(dincl.Projection):
    answer: object

    def solver(self):
        made = Failing(self.tol)
        made.answer = self.answer
        return made


@pytest.mark.parametrize("make", [dincl.CatchUp, dincl.LinearisedCatchUp, dincl.MidpointCatchUp])
@pytest.mark.parametrize("error", [OwnError("mine"), KeyboardInterrupt(), ZeroDivisionError()])
def test_what_an_own_solver_raises_is_heard(make, error):
    with pytest.raises(type(error)):
        dincl.solve(broken("nothing", None), make(DT, Own(1e-9, lambda: raises(error)(0))), TIMES)


@pytest.mark.parametrize("make", [dincl.CatchUp, dincl.LinearisedCatchUp])
def test_an_own_solver_that_gives_up_or_is_wrong_ends_the_run(make):
    """Its answer is judged by residuals recomputed from the rows: here the multipliers are missing."""
    gives_up = raises(dincl.StepFailure(dincl.Status.NOT_CONVERGED, "tired"))
    wrong = dincl.Projected(X0 - 9.0, np.zeros(3), np.inf, 0.0, 0.0, 1, "failing")
    for answer in (lambda: gives_up(0), wrong):
        path = dincl.solve(broken("nothing", None), make(DT, Own(1e-9, answer)), TIMES, throw=False)
        assert path.status is dincl.Status.NOT_CONVERGED
        assert path.t.tolist()[:1] == [0.25]


@schemes
def test_arguments_may_be_kept_and_cannot_be_written_to(name):
    kept, copies = [], []

    def drift(t, x):
        assert not x.flags.writeable
        kept.append(x[1:] if len(kept) % 2 else x)  # a part keeps the whole
        copies.append(kept[-1].copy())
        return np.tile([0.1, -1.0], (2, 1))

    def g(x):
        kept.append(x)
        copies.append(x.copy())
        return x[:, 1]

    problem = dincl.Problem(X0, drift, [dincl.Smooth(g, lambda x: normals(0 * x)), dincl.NonOverlap(0.4)])
    dincl.solve(problem, SCHEMES[name], [1.0])
    assert len(kept) > 10
    assert all(map(np.array_equal, kept, copies))

    def overwrites(t, x):
        while x.base is not None:
            x = x.base
        x.flags.writeable = True
        x[...] = 7.0
        return np.zeros((2, 2))

    problem = dincl.Problem(X0, overwrites)
    dincl.solve(problem, SCHEMES[name], [1.0])
    assert np.array_equal(problem.x0, X0)


@numba.njit
def falling(t, x):
    return np.full(x.shape, -0.5)


@pytest.mark.parametrize("drift", [lambda t, x: np.full(x.shape, -0.5), dincl.drifts.constant((-0.5, -0.5)), falling])
@pytest.mark.parametrize("name", ["PBD", "CatchUp", "CatchUp Daqp", "MidpointCatchUp", "EventDriven"])
def test_a_budget_ends_a_run(name, drift):
    """At the evaluation, or soon after it where the drift is compiled."""
    problem, count = counted(dincl.Problem(X0, drift, [dincl.HalfSpace((0, 1))]), DriftEvaluations(100))
    scheme = dincl.EventDriven(1e-11) if name == "EventDriven" else SCHEMES[name]
    with pytest.raises(OutOfBudgetError):
        dincl.solve(problem, scheme, np.linspace(0.5, 1000, 2000))
    assert 100 < count.evaluations < 10_000


MAY_RETURN = {
    "view": lambda t, x: np.full((4, 2), -0.5)[::2],
    "whole numbers": lambda t, x: np.full(x.shape, -1) // 2 + 0.5 * np.ones(x.shape),
    "single precision": lambda t, x: np.full(x.shape, -0.5, np.float32),
    "list": lambda t, x: [[-0.5, -0.5]] * len(x),
    "swapped bytes": lambda t, x: np.full(x.shape, -0.5).astype(">f8"),
    "constant": dincl.drifts.constant((-0.5, -0.5)),
    "numba": falling,
    "numba in object mode": numba.jit(forceobj=True)(lambda t, x: np.full(x.shape, -0.5)),
    "numba list": numba.njit(lambda t, x: [(-0.5, -0.5) for _ in range(x.shape[0])]),
}


@pytest.mark.filterwarnings("ignore::numba.core.errors.NumbaPendingDeprecationWarning")
@pytest.mark.parametrize("form", MAY_RETURN)
def test_what_a_drift_may_return(form):
    plain = MAY_RETURN["view"]
    for name in ("PBD", "CatchUp Daqp", "MidpointCatchUp", "EventDriven"):
        one, other = (
            dincl.solve(dincl.Problem(X0, drift, [dincl.HalfSpace((0, 1))]), SCHEMES[name], [0.3, 1.5])
            for drift in (plain, MAY_RETURN[form])
        )
        assert np.abs(other.x - one.x).max() < 1e-14


@numba.njit
def late_shape(t, x):
    return x[:1] if t > 0.62 else -x


@numba.njit
def late_nan(t, x):
    return x * np.nan if t > 0.62 else -x


@numba.njit
def late_raise(t, x):
    if t > 0.62:
        raise ValueError("too late")
    return -x


@numba.njit
def late_division(t, x):
    return -x if t < 0.62 else x * (1 / (t - t))


@pytest.mark.slow_with("late_shape", "late_nan", "late_division")
@pytest.mark.parametrize(
    ("drift", "words"),
    [(late_shape, "shape (1, 2)"), (late_nan, "nan"), (late_raise, "too late"), (late_division, "ZeroDivisionError")],
)
def test_a_drift_that_the_user_compiled_fails_alike(drift, words, capfd):
    for name in ("PBD", "CatchUp Daqp", "EventDriven"):
        path = dincl.solve(dincl.Problem(X0, drift), SCHEMES[name], TIMES, throw=False)
        assert path.status is dincl.Status.DRIFT_FAILED
        assert words in path.detail
        assert path.t.tolist()[:1] == [0.25]
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("name", ["PBD", "CatchUp", "EventDriven"])
def test_two_runs_interleaved_in_two_threads(name):
    """Each callback lets the other thread go on; the hook of the interpreter is left as it was."""
    hook, problems = sys.unraisablehook, [broken("nothing", None) for _ in range(2)]

    def made(k):
        def drift(t, x):
            time.sleep(0)
            return problems[k].drift(t, x)

        return dincl.solve(dincl.Problem(X0 + k, drift, problems[k].constraints), SCHEMES[name], TIMES).x

    alone = [made(k) for k in range(2)]
    with ThreadPoolExecutor(2) as pool:
        assert all(map(np.array_equal, alone, pool.map(made, range(2))))
    assert sys.unraisablehook is hook


def test_what_is_read_later_fails_alike():
    """States between the steps are evaluated when they are asked for; residuals that cannot be are infinite.

    Functions of time alone are called before the run and not after it.
    """
    failing = ""
    floor = dincl.Smooth(lambda t, x: np.nan * x[:, 1] if failing == "g" else x[:, 1] - 0.3 * t)
    wall = dincl.Moving(dincl.HalfSpace((0, 1), -1.0), lambda t: (0.0, np.nan if failing == "path" else 0.3 * t))
    problem = dincl.Problem(
        X0, lambda t, x: np.full_like(x, np.nan) if failing == "drift" else np.tile([0.3, -1.0], (2, 1)), [floor, wall]
    )
    path = dincl.solve(problem, dincl.EventDriven(1e-9), [0.5, 1.0])
    assert path(0.75)[0] == pytest.approx([0.225, 0.225], abs=1e-9)
    failing = "path"
    assert path(0.75)[0] == pytest.approx([0.225, 0.225], abs=1e-9)
    failing = "g"
    with pytest.raises(dincl.FunctionFailed, match="g returned nan"):
        path(0.75)
    failing = "drift"
    assert path.normal_cone_residual().tolist() == [np.inf, np.inf]


def test_errors_with_a_status_pass_between_processes():
    for kind in (dincl.FunctionFailed, dincl.StepFailure, dincl.ProjectionFailed):
        again = pickle.loads(pickle.dumps(kind(dincl.Status.DRIFT_FAILED, "so")))
        assert (type(again), again.status, again.detail) == (kind, dincl.Status.DRIFT_FAILED, "so")
