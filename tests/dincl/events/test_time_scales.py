"""Functions of time that come and go, jump, or have noise: the event-driven method resolves sets and drifts."""

import numpy as np
import pytest

import dincl
from dincl.system.time_scales import MOST_VALUES, TimeScales, time_scales

SHAKER = dincl.Moving(dincl.HalfSpace(normal=(1, 0)), lambda t: (0.6 * np.sin(t), 0.0))
BUMP = dincl.Moving(dincl.HalfSpace(normal=(1, 0)), lambda t: (np.exp(-(((t - 0.713) / 0.05) ** 2)), 0.0))
BALL = dincl.OutsideBall(centre=lambda t: (t - 2.0, 0.0), distance=0.3)
WALL = dincl.HalfSpace(normal=(1,))


class Counted:
    """A function of time that counts its calls."""

    def __init__(self, function):
        self.function, self.calls = function, 0

    def __call__(self, t):
        self.calls += 1
        return self.function(t)


def scales(path, drift=lambda t: 0.0, times=(1.0,), accuracy=0.0):
    """Those of a wall on a path (numbers) under a drift of time."""
    moving = dincl.Moving(WALL, lambda t: np.atleast_1d(path(t)))
    return time_scales(dincl.Problem([[9.0]], lambda t, x: 0 * x + drift(t), [moving]), times, accuracy)


@pytest.mark.parametrize(
    ("moving", "start", "t", "exact"), [(SHAKER, 0.5, 100.0, 0.6), (BUMP, 0.5, 4.0, 1.0), (BALL, 0.0, 4.0, 2.3)]
)
def test_a_set_that_comes_and_goes_pushes_what_is_at_rest(moving, start, t, exact):
    """Nothing else limits the step: a wall that shakes 16 times, one that comes once, a ball whose centre is met."""
    problem = dincl.Problem([[start, 0.0]], lambda t, x: 0 * x, [moving])
    path = dincl.solve(problem, dincl.EventDriven(1e-9), [t])
    assert path.final[0, 0] == pytest.approx(exact, abs=1e-9)
    assert abs(path.final[0, 0] - exact) <= path.error[0]


def test_a_contact_that_is_missed_is_no_success(monkeypatch):
    """Steps as long as the run meet no wall; the overlap between the output times says so."""
    monkeypatch.setattr("dincl.events.run.time_scales", lambda problem, times, accuracy: TimeScales())
    problem = dincl.Problem([[0.5, 0.0]], lambda t, x: 0 * x, [SHAKER])
    path = dincl.solve(problem, dincl.EventDriven(1e-9), [100.0], throw=False)
    assert path.status is dincl.Status.NOT_CONVERGED
    assert path.error[0] > 0.05


def test_scales_of_functions_of_time():
    """A straight path asks for four steps, a jump or a root of the drift for few more, a shaker for two a period."""
    assert scales(lambda t: -t).shortest == 0.25
    assert scales(lambda t: -t, lambda t: float(t > 0.3)).shortest > 0.05
    assert scales(lambda t: -t, lambda t: abs(t - 0.3) ** 0.5).shortest > 1e-4
    assert 0.004 < scales(lambda t: -np.sin(200 * t)).shortest < np.pi / 200


@pytest.mark.parametrize(
    ("path", "end", "exact", "most"),
    [
        (lambda t: -0.5 if t <= 0.6 else -100.5, 0.75, [0.6], 500),
        (lambda t: -0.5 if t < 0.3 else -0.1, 1.0, [0.3], 500),
        (lambda t: -1.0 if t < 1.0 else -2.0, 1.0, [1.0], 500),
        (lambda t: -1.0 if t <= 0.0 else -2.0, 1.0, [0.0], 500),
        (lambda t: -1 - 1e-12 * (t > 0.37), 1.0, [0.37], 500),
        (lambda t: -np.floor(7 * t), 1.0, np.arange(1, 8) / 7, 1100),
        (lambda t: min(1.0, 2 * t), 1.2, [0.5], 500),
        (lambda t: [np.cos(30 * t) + abs((3 * t) % 1 - 0.5)], 1.2, np.arange(1, 8) / 6, 1500),
        (lambda t: np.interp(t, [0, 9.9, 10, 10.1, 30], [0, 0, 2, 0, 0]), 30.0, [9.9, 10.0, 10.1], 700),
        (lambda t: np.interp(t, [0, 0.5, 0.5 + 1e-6, 1], [0, 0, 1, 1]), 1.0, [0.5, 0.5 + 1e-6], 1000),
        (lambda t: np.interp(t, [0, 0.5, 0.5 + 1e-10, 1], [0, 0, 1, 1]), 1.0, [0.5, 0.5 + 1e-10], 1000),
        (lambda t: -(abs(t - 0.37) ** 0.5), 1.0, None, 3500),
        (lambda t: -(max(t - 0.3, 0.0) ** 2), 1.0, None, 1000),
        (lambda t: -1e3 + np.cos(40 * t), 2.0, [], 1000),
        (lambda t: np.exp(-(((t - 0.713) / 0.003) ** 2)), 2.0, [], 1000),
    ],
)
def test_breaks_are_located_with_few_calls(path, end, exact, most):
    """Jumps to the last bit, kinks to rounding, and none in what is smooth."""
    counted = Counted(path)
    found = scales(counted, times=[end])
    assert counted.calls <= most
    assert found.rest == 0.0
    if exact is not None:
        assert len(found.breaks) == len(exact)
        assert np.abs(found.breaks - np.reshape(exact, (-1, 1))).max(initial=0.0) <= 5e-15 * end


@pytest.mark.parametrize("function", ["single", "noise", "random", "stairs"])
def test_the_search_ends_after_a_stated_number_of_values(function):
    rng = np.random.default_rng(3)
    functions = {
        "single": lambda t: float(np.float32(np.sin(3 * t))),
        "noise": lambda t: np.sin(3 * t) + 1e-9 * rng.random(),
        "random": lambda t: rng.random(),
        "stairs": lambda t: np.floor(1000 * t),
    }
    path, drift = Counted(functions[function]), Counted(functions[function])
    found = scales(path, drift)
    assert found.rest > 0.0
    assert "constraints[0] (Moving)" in found.detail
    # The problem and its sets ask a few times, too.
    assert max(path.calls, drift.calls) <= MOST_VALUES + 200
    if function in ("single", "noise"):  # a drift with less noise than the accuracy notices
        drift.calls = 0
        assert len(scales(lambda t: -t, drift, accuracy=1e-3).pieces) < 100
        assert drift.calls < 1000


def test_what_is_not_resolved_is_no_success_with_a_small_error():
    """A wall that goes up and down a thousand times, and one with noise."""
    rng = np.random.default_rng(0)
    for path, tol, status in (
        (lambda t: abs((1000 * t) % 1 - 0.5), 1e-6, dincl.Status.NOT_CONVERGED),
        (lambda t: np.sin(3 * t) + 1e-9 * rng.random(), 1e-10, dincl.Status.NOT_CONVERGED),
        (lambda t: np.sin(3 * t) + 1e-9 * rng.random(), 1e-6, dincl.Status.SUCCESS),
    ):
        problem = dincl.Problem([[2.0]], lambda t, x: 0 * x, [dincl.Moving(WALL, lambda t, path=path: [path(t)])])
        run = dincl.solve(problem, dincl.EventDriven(tol), [1.0], throw=False)
        assert run.status is status
        assert run.error[0] > 1e-10
        if not run.status:
            assert "constraints[0] (Moving) changes too often, near t = " in run.detail


@pytest.mark.parametrize(
    ("times", "width"),
    [
        ([1.005, 2.0], 0.01),
        ([1.005, 2.0], 1e-6),
        ([1.0, 1.01, 2.0], 0.01),
        ([1.0, 1.01, 2.0], 1e-4),
        ([0.999, 1.002, 1.005, 1.008, 1.011, 2.0], 0.01),
    ],
)
def test_output_times_in_or_beside_a_pulse_show_it(times, width):
    """A drift of size 1/width for a time of this width, and a wall that strikes then."""
    start = 1.0 if times[0] != 1.005 else 1.005 - width / 2
    stop = start + width
    pulse = dincl.Problem([[1.0]], lambda t, x: -x + (start < t < stop) / width)
    right = np.exp(-2) + np.exp(start - 2) * np.expm1(stop - start) / width
    path = dincl.solve(pulse, dincl.EventDriven(1e-8), times)
    assert abs(path.final[0, 0] - right) <= path.error[-1]
    stroke = dincl.HalfSpace((1.0,), lambda t: 2.0 if start < t < stop else 0.0)
    path = dincl.solve(dincl.Problem([[1.0]], lambda t, x: 0 * x, [stroke]), dincl.EventDriven(1e-8), times)
    assert abs(path.final[0, 0] - 2.0) <= path.error[-1]


def test_a_pulse_of_the_drift_is_seen():
    """It takes a fortieth of the run, before and after which nothing moves: x = 1/2 + sqrt(pi)."""
    pulse = dincl.Problem([[0.5]], lambda t, x: 0 * x + np.exp(-(((t - 0.713) / 0.03) ** 2)) / 0.03)
    path = dincl.solve(pulse, dincl.EventDriven(1e-9), [2.0])
    assert abs(path.final[0, 0] - 0.5 - np.sqrt(np.pi)) <= path.error[0]
    assert path.stats.drift_evaluations > 500


@pytest.mark.parametrize("is_drift", [True, False])
def test_one_stroke_of_a_long_run(is_drift):
    """For 0.2 of 30 time units: a drift of area 0.2, or a wall that pushes to 2; at most 5,000 calls."""
    stroke = Counted(lambda t: float(np.interp(t, [0.0, 9.9, 10.0, 10.1, 30.0], [0.0, 0.0, 2.0, 0.0, 0.0])))
    sets = [] if is_drift else [dincl.HalfSpace((1.0,), stroke)]
    problem = dincl.Problem([[1.0]], lambda t, x: 0 * x + (stroke(t) if is_drift else 0.0), sets)
    path = dincl.solve(problem, dincl.EventDriven(1e-8), [30.0])
    assert abs(path.final[0, 0] - (1.2 if is_drift else 2.0)) <= path.error[0] <= 1e-9
    assert stroke.calls <= 5000


def test_a_function_whose_array_changes_its_shape_is_refused_with_the_reason():
    discs = dincl.NonOverlap(lambda t: 0.5 if t <= 0.3 else [0.5, 0.5])
    problem = dincl.Problem([[0.0], [2.0]], dincl.drifts.constant([[1.0], [-1.0]]), [discs])
    path = dincl.solve(problem, dincl.EventDriven(1e-6), [1.0], throw=False)
    assert path.status is dincl.Status.CONSTRAINT_FAILED
    assert "constraints[0] (NonOverlap)" in path.detail
    assert "the shape of each array must stay the same" in path.detail


def test_a_set_that_turns_in_space_is_resolved():
    """Entries of its rotation and displacement that are zero but for rounding are no functions of time."""
    turn = dincl.RigidMotion(lambda t: (0.0, 0.3 * np.sin(4 * t), 0.0), centre=(0.7, 1.3, -0.4))
    floor = dincl.Moving(dincl.HalfSpace((0, 0, 1), -0.5, 0.1), turn)
    problem = dincl.Problem([[0.5, 1.0, 0.4]], dincl.drifts.constant((0.1, 0.0, -1.0)), [floor])
    assert time_scales(problem, [2.0]).rest == 0.0
