"""The run: times, steps, output, residuals of its result; what comes back from pickle; what is no start."""

import pickle
import re
from dataclasses import dataclass

import numpy as np
import pytest

import dincl
from dincl import scenes
from dincl.steps.grid import TimeGrid

DISCS = dincl.NonOverlap(0.5)
WALL_ABOVE = dincl.HalfSpace((0, 1), -1.0)


def decay(x0=((1.0, -2.0),), constraints=()):
    return dincl.Problem(x0, lambda t, x: -x, constraints)


def fall(constraints=()):
    return dincl.Problem([[0.0]], lambda t, x: np.full_like(x, -1.0), constraints)


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


def test_a_run_that_fails_behind_a_break_has_each_time_once():
    fails = dincl.Problem([[1.0]], lambda t, x: -x if t <= 0.5 else x.no)
    for t, kept in ((1.0, [0.5]), ([0.5, 1.0], [0.5]), ([0.0, 0.2, 1.0], [0.0, 0.2, 0.5])):
        for scheme in (dincl.PBD(0.1), dincl.Penalty(0.1, 1.0), Weighted(0.1)):
            path = dincl.solve(fails, scheme, t, breaks=[0.5], throw=False)
            assert path.status is dincl.Status.DRIFT_FAILED
            assert path.t == pytest.approx(kept, abs=1e-15)


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
    assert (later.t.tolist(), later.t0) == ([2.5, 3.0, 4.5], 2.0)
    # By the rounding of times EventDriven may make one step in two.
    assert abs(later.stats.steps - shifted.stats.steps) <= (name == "EventDriven")
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
def test_until_that_fails_ends_the_run_with_its_name_and_the_state_of_its_time(name):
    for t in ([2.0], [0.3, 2.0]):
        path = dincl.solve(fall(), SCHEMES[name], t, until=lambda t, x: {}["k"] if t > 0.6 else 1.0, throw=False)
        assert path.status is dincl.Status.FUNCTION_FAILED
        assert re.match(r"until\(t = .*\) raised KeyError", path.detail)
        assert path.t[-1] > 0.5
        np.testing.assert_allclose(path.final, dincl.solve(fall(), SCHEMES[name], path.t[-1]).final, atol=0.02)
        np.testing.assert_allclose(path(0.3), dincl.solve(fall(), SCHEMES[name], 0.3).final, atol=0.02)


def test_a_jump_of_a_set_can_meet_until():
    lift = dincl.HalfSpace((0, 1), offset=lambda t: 0.0 if t < 0.6 else 1.0)
    for scheme in (dincl.EventDriven(1e-9), dincl.AdaptiveCatchUp(1e-6), dincl.Auto(1e-4)):
        path = dincl.solve(
            dincl.Problem([(0.0, 0.5)], lambda t, x: 0 * x, [lift]), scheme, t=1.0, until=lambda t, x: x[0, 1] - 0.8
        )
        assert path.t[-1] == pytest.approx(0.6, abs=1e-12)
        assert path.final[0, 1] == pytest.approx(1.0)


# Jumps of the drift below, none at a multiple of a step.
BREAKS = (1 / 3, 0.7123, 1.1)


def jumpy(t, x):
    return np.full_like(x, np.select([t < BREAKS[0], t < BREAKS[1], t < BREAKS[2]], [1.0, -2.0, 3.0]))


def late(t, x):
    """The same, with its old values at the breaks."""
    return np.full_like(x, np.select([t <= BREAKS[0], t <= BREAKS[1], t <= BREAKS[2]], [1.0, -2.0, 3.0]))


def after_jumps(t):
    spent = np.diff(np.minimum([0.0, *BREAKS], t))
    return spent @ (1.0, -2.0, 3.0)


@every_scheme
@pytest.mark.parametrize("drift", [jumpy, late])
def test_steps_end_at_named_breaks(name, drift):
    """Of a drift that is constant between them nothing is left but rounding; equal steps are the fewest in between."""
    scheme, t = SCHEMES[name], [0.0, 0.2, BREAKS[0], 1.0, 1.5]
    path = dincl.solve(dincl.Problem([[0.0]], drift), scheme, t=t, breaks=[0.0, *BREAKS, 1.5])
    assert path.t.tolist() == t
    if name != "SecondOrderPBD":
        assert path.x[:, 0, 0] == pytest.approx([after_jumps(s) for s in t], abs=1e-12)
        assert path(0.9)[0, 0] == pytest.approx(after_jumps(0.9), abs=1e-12)
        assert path.normal_cone_residual()[[1, 3, 4]].max() <= 1e-10
    if isinstance(scheme, dincl.FixedStep):
        assert path.stats.steps == 34 + 38 + 39 + 40
        back = pickle.loads(pickle.dumps(path))
        np.testing.assert_array_equal(back([0.1, 0.5, 1.4]), path([0.1, 0.5, 1.4]))
    up = dincl.solve(dincl.Problem([[0.0]], drift), scheme, t=t, breaks=BREAKS, until=lambda t, x: x[0, 0] + 0.3)
    assert up.status is dincl.Status.STOPPED or name == "SecondOrderPBD"
    if name != "SecondOrderPBD":
        assert up.t.tolist() == pytest.approx([0.0, 0.2, 1 / 3, 1 / 3 + (1 / 3 + 0.3) / 2], abs=1e-12)


@every_scheme
def test_breaks_that_agree_to_rounding_are_one(name):
    for breaks in ([1e-17, 0.5, 1.0 - 1e-16], [0.5 - 1e-16, 0.5 + 1e-16], [0.5 + 1e-15, 0.5 + 2e-15]):
        path = dincl.solve(fall(), SCHEMES[name], t=[0.5, 1.0], breaks=breaks)
        assert path.t.tolist() == [0.5, 1.0]
        np.testing.assert_allclose(path.x, dincl.solve(fall(), SCHEMES[name], t=[0.5, 1.0], breaks=[0.5]).x, atol=1e-9)


@pytest.mark.parametrize("scheme", [dincl.EventDriven(1e-8), dincl.Auto(1e-4), dincl.AdaptiveCatchUp(1e-6)], ids=repr)
def test_named_breaks_show_what_no_look_before_the_run_finds(scheme):
    """A stroke of a wall in a ten-thousandth of the run, and a force that acts only where the particle will be."""
    begins, ends = 0.777, 0.7771

    def stroke(t):
        return (0.3 * np.sin(np.pi * (t - begins) / (ends - begins)) if begins < t < ends else 0.0, 0.0)

    wall = dincl.Moving(dincl.HalfSpace((1, 0)), stroke)
    struck = dincl.solve(dincl.Problem([[0.0, 0.0]], lambda t, x: 0 * x, [wall]), scheme, 1.0, breaks=[begins, ends])
    assert struck.final[0, 0] == pytest.approx(0.3, abs=1e-4 if struck.error is not None else 1e-5)

    def kick(t, x):
        return np.where((x > 0.05) & (begins <= t < ends), 5.0, 0.1)

    kicked = dincl.solve(dincl.Problem([[0.0]], kick), scheme, t=1.0, breaks=[begins, ends])
    assert kicked.final[0, 0] == pytest.approx(0.1 + 4.9 * (ends - begins), abs=1e-12)


@pytest.mark.parametrize("late", [False, True])
def test_a_set_that_jumps_at_a_named_output_time_is_on_the_side_that_it_says(late):
    def centre(t):
        return (5.0 if t > 0.6 or (t == 0.6 and not late) else 0.0, 0.0)

    sets = [dincl.InsideBall(centre, 1.0), dincl.Moving(WALL_ABOVE, lambda t: (0.0, 0.1 * np.sin(t)))]
    problem = dincl.Problem([[0.0, 0.0]], dincl.drifts.constant((0.0, -0.1)), sets)
    for scheme in (dincl.EventDriven(1e-9), dincl.AdaptiveCatchUp(1e-6), dincl.CatchUp(0.01, dincl.ActiveSet(1e-12))):
        for breaks in (None, [0.6]):
            path = dincl.solve(problem, scheme, t=[0.6, 1.0], breaks=breaks)
            assert path.violation().max() <= 1e-6
            assert path.x[:, 0, 0] == pytest.approx([0.0 if late else 4.0, 4.0], abs=0.01)


def test_many_named_breaks_are_all_resolved():
    """A wall that goes up and down between breaks, faster than the particle falls; with the breaks it is tabulated."""
    count = 100
    wall = dincl.Moving(dincl.HalfSpace((0, 1)), lambda t: (0.0, abs((t * count) % 2.0 - 1.0)))
    problem = dincl.Problem([[0.0, 1.0]], dincl.drifts.constant((0.0, -1.0)), [wall])
    for scheme in (dincl.PBD(1e-4), dincl.EventDriven(1e-9)):
        path = dincl.solve(problem, scheme, t=[0.505, 1.0], breaks=np.arange(1, count) / count)
        assert path.stats.callbacks == 0
        assert path.x[:, 0, 1] == pytest.approx([0.995, 1.0], abs=1e-9)
    found = dincl.solve(problem, dincl.EventDriven(1e-6), t=[1.0], breaks=np.arange(1, 50) / 50, throw=False)
    assert found.status is not dincl.Status.SUCCESS or found.final[0, 1] == pytest.approx(1.0, abs=1e-6)


def test_a_run_of_many_steps_calls_a_function_of_time_no_more_often_than_is_said():
    noise, calls = np.random.default_rng(0).normal(size=1009), []

    def path(t):
        calls.append(t)
        if len(calls) > 60_000:
            raise KeyboardInterrupt
        return 0.0, -1e-3 * abs(noise[int(1e7 * t) % 1009])

    problem = dincl.Problem([[0.0, 1.0]], dincl.drifts.constant((0.0, 0.0)), [dincl.Moving(WALL_ABOVE, path)])
    dincl.PBD(1e-6).stepper(problem).prepare((TimeGrid(1.0, 10**6),), np.ones(1))
    assert 50_000 <= len(calls) <= 50_000 + 5_000 + 100
