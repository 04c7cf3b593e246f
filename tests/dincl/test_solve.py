"""The run: times, steps, output, residuals of its result; what comes back from pickle; what is no start."""

import copy
import pickle
import re
from dataclasses import dataclass

import numpy as np
import pytest

import dincl
from dincl import scenes

DISCS = dincl.NonOverlap(0.5)


def decay(x0=((1.0, -2.0),), constraints=()):
    return dincl.Problem(x0, lambda t, x: -x, constraints)


def fall(constraints=()):
    return dincl.Problem([[0.0]], lambda t, x: np.full_like(x, -1.0), constraints)


def test_euler_without_constraints():
    path = dincl.solve(decay(), dincl.PBD(0.1), t=[0.5, 1.0])
    assert path.t.tolist() == [0.5, 1.0]
    assert path.x.shape == (2, 1, 2)
    assert path.final.tolist() == path.x[-1].tolist()
    assert path.x[:, 0, 0] == pytest.approx([0.9**5, 0.9**10])
    assert (path.status, path.detail, path.violation().tolist()) == (dincl.Status.SUCCESS, "", [0.0, 0.0])
    assert path.stats.degrees_of_freedom == 2
    assert path.stats.drift_evaluations == path.stats.steps == 10
    start = dincl.solve(decay(), dincl.PBD(0.1), t=[0.0])
    assert start(0.0).tolist() == start.x[0].tolist() == [[1.0, -2.0]]


def test_output_times_lie_on_straight_lines_and_change_no_step():
    every = dincl.solve(decay(), dincl.PBD(0.1), t=np.arange(0, 11) / 10)
    some = dincl.solve(decay(), dincl.PBD(0.1), t=[0.0, 0.123, 0.25, 0.7, 1.0])
    assert some.final.tolist() == every.final.tolist()
    assert some.stats.steps == every.stats.steps
    times = np.array([[0.0, 0.05, 1.0], [0.61, 0.7, 0.33]])
    for path in (every, some):
        assert path(times).shape == (2, 3, 1, 2)
        assert path(times)[..., 0, 1] == pytest.approx(np.interp(times, every.t, every.x[:, 0, 1]), abs=1e-15)
        assert path(path.t) == pytest.approx(path.x, abs=1e-15)
    path = dincl.solve(fall(), dincl.SecondOrderPBD(0.1), t=[0.5, 1.0])
    assert path(0.7)[0, 0] == pytest.approx(-0.01 * 7 * 8 / 2)


@pytest.mark.parametrize(
    ("end", "dt", "steps"),
    [(1.0, 0.1, 10), (1.0, 0.3, 4), (3.0, 1e-3, 3000), (0.7, 0.1, 7), (1.0, 5.0, 1), (0.0, 0.1, 0)],
)
def test_equal_steps_no_longer_than_dt(end, dt, steps):
    path = dincl.solve(fall(), dincl.PBD(dt), t=end)
    assert path.stats.steps == steps
    assert path.final[0, 0] == pytest.approx(-end, abs=1e-12)


def test_catch_up_proves_its_velocity():
    """Two discs pressed together on a wall: the velocity differs from the drift by a normal vector only."""
    drift, floor = np.array([[0.0, -1.0], [-0.3, -1.0]]), dincl.HalfSpace((0, 1), radius=0.5)
    problem = dincl.Problem([[0.0, 0.5], [0.7, 1.4]], lambda t, x: drift, [DISCS, floor])
    schemes = dincl.CatchUp(0.01, dincl.Daqp(1e-12)), dincl.PBD(0.01)
    exact, pbd = (dincl.solve(problem, scheme, t=[0.0, 0.2, 0.4]) for scheme in schemes)
    assert exact.normal_cone_residual()[0] == np.inf
    assert (exact.normal_cone_residual()[1:] < 1e-9).all()
    assert (pbd.normal_cone_residual()[1:] > 1e-4).all()
    assert (exact.violation() < 1e-12).all()


def test_a_failed_run_says_when_and_what_to_try():
    with pytest.raises(dincl.StepFailed, match=r"smaller dt.*step from t = ") as caught:
        dincl.solve(dincl.Problem([[1.0]], lambda t, x: x**3), dincl.PBD(1.0), t=[100.0])
    path = caught.value.trajectory
    assert path.status is dincl.Status.DRIFT_FAILED
    assert np.isfinite(path.x).all()
    assert path.t[-1] == path.stats.steps


def test_what_is_not_defined_is_infinite():
    assert dincl.solve(fall(), dincl.SecondOrderPBD(0.1), t=[0.5]).normal_cone_residual().tolist() == [np.inf]
    late = dincl.Smooth(lambda x: np.array([1.0 if x[0, 0] > -0.95 else np.nan]), lambda x: np.zeros((1, 1)))
    path = dincl.solve(fall([late]), dincl.PBD(0.1), t=[0.9, 1.0], throw=False)
    assert path.status is dincl.Status.CONSTRAINT_FAILED
    assert path.problem.violation(1.0, np.array([[-1.0]])) == np.inf


def test_reprs_are_short():
    scene = scenes.pile(500)
    path = dincl.solve(scene, dincl.PBD(0.1), t=[0.1, 0.2])
    assert repr(scene) == "Scene(N = 500, d = 2, constraints = [NonOverlap, HalfSpace, HalfSpace, HalfSpace])"
    assert repr(path) == "Trajectory(SUCCESS, PBD, 2 output times to t = 0.2, N = 500, d = 2)"


# Sets that touch a particle at c up to rounding, and the direction out of them.
CONTACTS = {
    "wall": (lambda c: dincl.HalfSpace([1.0], offset=c - 0.3, radius=0.1 + 0.2), -1),
    "wall of time": (lambda c: dincl.HalfSpace([1.0], offset=lambda t: c - 0.3, radius=0.1 + 0.2), -1),
    "wall that moves": (lambda c: dincl.Moving(dincl.HalfSpace([1.0], -0.3), lambda t: (c + 0.1 + 0.2,)), -1),
    "obstacle": (lambda c: dincl.OutsideBall((c - 0.3,), 0.1 + 0.2), -1),
    "container": (lambda c: dincl.InsideBall((c - 0.1 - 0.2,), 0.3), 1),
}


@pytest.mark.parametrize(("contact", "out"), CONTACTS.values(), ids=CONTACTS)
@pytest.mark.parametrize("c", [0.0, 1e-12, 1.0, 1e3])
def test_a_start_in_contact_is_judged_alike_wherever_the_origin_is(contact, out, c):
    dincl.Problem([[c]], lambda t, x: 0 * x, [contact(c)])
    with pytest.raises(dincl.InvalidProblem, match=r"x0 violates .* the nearest point that is feasible"):
        dincl.Problem([[c + 1e-3 * out]], lambda t, x: 0 * x, [contact(c)])


def test_a_start_may_overlap_by_a_billionth_of_the_largest_coordinate():
    decay([[0.1 + 0.2], [1.3]], [DISCS])
    decay([[0.0], [1.0 - 1e-10]], [DISCS])
    with pytest.raises(dincl.InvalidProblem, match="x0 violates NonOverlap"):
        decay([[0.0], [1.0 - 3e-9]], [DISCS])


def pull(t, x):
    return -x


@dataclass(frozen=True)
class Weighted(dincl.FixedStep):
    """Euler with a weight from a function."""

    weight: object = None

    def stepper(self, problem):
        return Euler(problem)


class Euler(dincl.Stepper):
    """x + h F."""

    def step(self, t, h, state):
        return dincl.StepState(state.x + h * self.velocity(t, state.x))


@pytest.mark.parametrize("scene", [scenes.two_disks(), scenes.sweeping_interval()], ids=lambda scene: scene.name)
@pytest.mark.parametrize(
    "scheme", [dincl.PBD(0.05), dincl.MidpointCatchUp(0.05, dincl.Daqp(1e-9)), dincl.EventDriven(1e-8)]
)
def test_a_trajectory_comes_back_from_pickle(scheme, scene):
    path = dincl.solve(scene, scheme, t=[0.5, 1.3])
    back = pickle.loads(pickle.dumps(path))
    np.testing.assert_array_equal(back(0.77), path(0.77))
    np.testing.assert_array_equal(back.violation(), path.violation())
    np.testing.assert_array_equal(back.normal_cone_residual(), path.normal_cone_residual())
    assert back.stats == path.stats
    np.testing.assert_array_equal(back.problem.exact(1.0), scene.exact(1.0))


def shift(t):
    return (t,)


WALL = dincl.HalfSpace((1,), -9.0)
BAD = {
    "drift": dincl.Problem([[1.0]], lambda t, x: -x, [WALL]),
    "constraints[1].path": dincl.Problem([[1.0]], pull, [WALL, dincl.Moving(WALL, lambda t: (t,))]),
    "constraints[0].constraint.g": dincl.Problem(
        [[1.0]], pull, [dincl.Moving(dincl.Smooth(lambda x: x[0] + 9, np.ones_like), shift)]
    ),
}


@pytest.mark.parametrize("part", BAD)
def test_a_part_that_cannot_be_pickled_is_named_and_can_be_copied(part):
    problem = BAD[part]
    message = re.escape(part) + r" = <function .*<lambda>.*define it at module level, or keep path.to_frame\(\)"
    for scheme in (dincl.PBD(0.1), dincl.EventDriven(1e-6)):
        path = dincl.solve(problem, scheme, t=[1.0])
        for item in (problem, path):
            with pytest.raises(pickle.PicklingError, match=message):
                pickle.dumps(item)
        assert copy.copy(problem) is problem
        assert np.array_equal(copy.deepcopy(path)(0.5), path(0.5))


def test_a_scheme_that_cannot_be_pickled_is_named():
    path = dincl.solve(scenes.two_disks(), Weighted(0.1, lambda: 1), t=[0.2])
    with pytest.raises(pickle.PicklingError, match=r"^scheme.weight = <function"):
        pickle.dumps(path)


# Schemes that take t0, until and breaks.
SCHEMES = {
    "EventDriven": dincl.EventDriven(1e-8),
    "Auto": dincl.Auto(1e-4),
    "AdaptiveCatchUp": dincl.AdaptiveCatchUp(1e-6),
    "CatchUp": dincl.CatchUp(0.01, dincl.ActiveSet(1e-12)),
    "CatchUp in Python": dincl.CatchUp(0.01, dincl.Daqp(1e-12)),
    "LinearisedCatchUp": dincl.LinearisedCatchUp(0.01, dincl.ActiveSet(1e-12)),
    "MidpointCatchUp": dincl.MidpointCatchUp(0.01, dincl.ActiveSet(1e-12)),
    "PBD": dincl.PBD(0.01, sweeps=3),
    "XPBD": dincl.XPBD(0.01),
    "Penalty": dincl.Penalty(0.01, 10.0),
    "SecondOrderPBD": dincl.SecondOrderPBD(0.01),
    "own": Weighted(0.01),
}
# How far a run in two parts may be from one run: steps of a length of their own begin anew at each part.
PARTS = {"EventDriven": 1e-8, "Auto": 1e-4, "AdaptiveCatchUp": 1e-6}
every_scheme = pytest.mark.parametrize("name", SCHEMES)


def of_time(since=0.0):
    """Two discs above a floor that heaves, beside a wall that turns and a set that grows until t = 1."""

    def drift(t, x):
        return np.column_stack((np.cos(3 * (t + since)) + 0 * x[:, 0], 0 * x[:, 1] - 1.0))

    sets = [
        DISCS,
        dincl.Moving(dincl.HalfSpace((0, 1), radius=0.5), lambda t: (0.0, 0.2 * np.sin(t + since))),
        dincl.HalfSpace(lambda t: (np.sin(0.3 + 0.1 * (t + since)), np.cos(0.3 + 0.1 * (t + since))), -3.0, radius=0.5),
        dincl.OutsideBall((0.5, -2.0), lambda t: 1.0 + min(t + since, 1.0)),
    ]
    return dincl.Problem([(0.0, 1.0), (1.1, 1.0)], drift, sets)


@every_scheme
def test_functions_are_given_the_time_since_t0(name):
    scheme = SCHEMES[name]
    shifted = dincl.solve(of_time(since=2.0), scheme, t=[0.5, 1.0, 2.5])
    later = dincl.solve(of_time(), scheme, t=[2.5, 3.0, 4.5], t0=2.0)
    assert (later.t.tolist(), later.t0, later.stats.steps) == ([2.5, 3.0, 4.5], 2.0, shifted.stats.steps)
    np.testing.assert_allclose(later.x, shifted.x, atol=1e-13)
    np.testing.assert_allclose(later([2.0, 2.3, 3.7]), shifted([0.0, 0.3, 1.7]), atol=1e-13)
    np.testing.assert_allclose(later.normal_cone_residual(), shifted.normal_cone_residual(), atol=1e-9)
    if name != "own":  # it sees no set
        np.testing.assert_allclose(later.forces(3.2).force, shifted.forces(1.2).force, atol=1e-9)
    for ours, theirs in zip(later.events, shifted.events, strict=True):
        assert ours._replace(t=0.0) == theirs._replace(t=0.0)
        assert ours.t == pytest.approx(2.0 + theirs.t, abs=1e-9)
    with pytest.raises(dincl.InvalidProblem, match=r"t = 1.9: must lie in \[2, 4.5\]"):
        later(1.9)


@every_scheme
def test_a_run_in_parts_is_one_run(name):
    scheme = SCHEMES[name]
    whole = dincl.solve(of_time(), scheme, t=[2.5, 3.0, 3.5], t0=2.0)
    half = dincl.solve(of_time(), scheme, t=2.5, t0=2.0)
    rest = dincl.solve(half, scheme, t=[3.0, 3.5])
    assert (rest.t0, rest.problem.x0.tolist()) == (2.5, half.final.tolist())
    np.testing.assert_allclose(rest.x, whole.x[1:], atol=PARTS.get(name, 1e-14))
    np.testing.assert_allclose(rest(2.8), whole(2.8), atol=PARTS.get(name, 1e-14))
    assert dincl.solve(rest, scheme, t=3.5).final.tolist() == rest.final.tolist()


@every_scheme
@pytest.mark.parametrize("t0", [0.0, 1.0])
def test_a_run_ends_where_until_changes_its_sign(name, t0):
    problem = dincl.Problem([(0.0, 2.0), (1.0, 2.0)], lambda t, x: np.full_like(x, (0.0, -1.0)), [DISCS])
    seen = []

    def until(t, x):
        seen.append(x)
        return x[0, 1] - 1.234

    path = dincl.solve(problem, SCHEMES[name], t=t0 + np.array([0.25, 0.5, 3.0, 4.0]), t0=t0, until=until)
    assert (path.status, bool(path.status), path.detail) == (dincl.Status.STOPPED, True, "")
    exact = 1.25 if name == "SecondOrderPBD" else 0.766
    assert path.t[-1] - t0 == pytest.approx(exact, abs=1e-12 if name != "SecondOrderPBD" else 0.02)
    assert (path.t[:-1] - t0).tolist() == [0.25, 0.5]
    assert path.final[:, 1] == pytest.approx(1.234, abs=1e-13)
    assert path(path.t[-1]) == pytest.approx(path.final, abs=1e-13)
    assert path.normal_cone_residual()[-1] == pytest.approx(0.0, abs=1e-9) or name == "SecondOrderPBD"
    assert not seen[0].flags.writeable
    path = dincl.solve(dincl.Problem([[1.0]], pull), SCHEMES[name], t=4.0, until=lambda t, x: x[0, 0] - 0.5)
    assert pickle.loads(pickle.dumps(path))(path.t[-1]) == pytest.approx(path.final, abs=1e-15)


@every_scheme
def test_until_ends_a_run_before_it_fails(name):
    scheme = SCHEMES[name]
    path = dincl.solve(dincl.Problem([[1.0]], lambda t, x: x**3), scheme, t=[9.0], until=lambda t, x: x[0, 0] - 3.0)
    assert path.status is dincl.Status.STOPPED
    assert path.final == pytest.approx(3.0)
    if path.error is not None:
        assert abs(path.t[-1] - 4 / 9) <= path.error[-1]
        assert abs(path.final - (1 - 2 * path.t[-1]) ** -0.5) <= path.error[-1]


@every_scheme
def test_what_until_never_meets_changes_nothing(name):
    """Nor does a sign that it has only at the start, or a value that is zero there."""
    plain = dincl.solve(of_time(), SCHEMES[name], t=[0.3, 1.0])
    for until in (lambda t, x: 1.0, lambda t, x: t, lambda t, x: float(x[0, 0] > 1e9) - 1):
        watched = dincl.solve(of_time(), SCHEMES[name], t=[0.3, 1.0], until=until)
        assert watched.status is dincl.Status.SUCCESS
        np.testing.assert_array_equal(watched.x, plain.x)
        np.testing.assert_array_equal(watched(0.77), plain(0.77))
        assert watched.events == plain.events


@every_scheme
def test_until_that_fails_ends_the_run_with_its_name(name):
    with pytest.raises(dincl.StepFailed, match=r"until\(t = .*\) raised KeyError") as caught:
        dincl.solve(decay(), SCHEMES[name], t=[0.5, 1.0], until=lambda t, x: 1.0 if t < 0.3 else {}["k"])
    assert caught.value.trajectory.status is dincl.Status.FUNCTION_FAILED


def test_a_jump_of_a_set_can_meet_until():
    lift = dincl.HalfSpace((0, 1), offset=lambda t: 0.0 if t < 0.6 else 1.0)
    for scheme in (dincl.EventDriven(1e-9), dincl.AdaptiveCatchUp(1e-6), dincl.Auto(1e-4)):
        path = dincl.solve(
            dincl.Problem([(0.0, 0.5)], lambda t, x: 0 * x, [lift]), scheme, t=1.0, until=lambda t, x: x[0, 1] - 0.8
        )
        assert path.t[-1] == pytest.approx(0.6, abs=1e-12)
        assert path.final[0, 1] == pytest.approx(1.0)
