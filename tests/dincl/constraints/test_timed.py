"""Sets that turn, close and grow: every way to state one set gives the same states, for every method."""

import copy
import pickle

import numpy as np
import pytest

import dincl
from tests.dincl.catalog import FIRST_ORDER, PROJECTIONS
from tests.dincl.own_constraints import InBall, InEllipse
from tests.twins import sweeps

METHODS = [*FIRST_ORDER, pytest.param(lambda dt: dincl.EventDriven(1e-10), id="EventDriven")]
EXACT = [dincl.scenes.drum(), dincl.scenes.drum(2), dincl.scenes.closing_walls(), dincl.scenes.growing_discs()]
START = np.array([[0.1, 0.6], [1.3, 0.7], [-0.9, 1.6]])


def angle(t):
    return 0.4 * np.sin(t)


def turn(a):
    return np.array([[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]])


def shift(t):
    return np.array([0.1 * t, 0.2 * np.sin(2 * t)])


def normal(t):
    return -np.sin(angle(t)), np.cos(angle(t))


def offset(t):
    """The offset of a wall through the origin that was turned and then translated."""
    return np.array(normal(t)) @ shift(t)


def radius(t):
    return 0.4 + 0.1 * t


def falling(*sets):
    wind = np.array([[0.2, -1.0], [-0.3, -1.0], [0.4, -1.2]])
    return dincl.Problem(START, lambda t, x: wind - 0.1 * x, [dincl.NonOverlap(0.5), *sets])


def gap(t, x):
    return x @ np.array(normal(t)) - offset(t) - 0.5


WALL = {
    "rigid motion": dincl.Moving(dincl.HalfSpace((0, 1), radius=0.5), dincl.RigidMotion(angle, shift)),
    "functions of time": dincl.HalfSpace(normal, offset, radius=0.5),
    "matrix": dincl.Moving(dincl.HalfSpace((0, 1), radius=0.5), dincl.RigidMotion(lambda t: turn(angle(t)), shift)),
    "moved twice": dincl.Moving(dincl.Moving(dincl.HalfSpace((0, 1), radius=0.5), dincl.RigidMotion(angle)), shift),
    "own function": dincl.Smooth(gap),
    "own function, moved": dincl.Moving(dincl.Smooth(lambda x: x[:, 1] - 0.5), dincl.RigidMotion(angle, shift)),
}
TIMES = [0.4, 1.0, 1.7]


@pytest.mark.slow_with("EventDriven", "own function, moved-XPBD")
@pytest.mark.parametrize("make", METHODS)
@pytest.mark.parametrize("way", list(WALL)[1:])
def test_a_wall_that_turns_is_the_same_however_it_is_stated(make, way):
    expected, found = (dincl.solve(falling(WALL[one]), make(0.05), t=TIMES) for one in ("rigid motion", way))
    assert np.abs(found.x - expected.x).max() < 1e-8
    assert gap(1.7, found.final).min() < (0.2 if isinstance(found.scheme, dincl.Penalty) else 0.01)


@pytest.mark.slow_with("EventDriven")
@pytest.mark.parametrize("make", METHODS)
def test_a_rigid_motion_without_rotation_is_a_path(make):
    sets = [dincl.HalfSpace((0, 1), radius=0.5), dincl.OutsideBall((2.5, 0.5), 1.0), dincl.InsideBall((0, 1), 3.0)]
    turned, moved = (
        falling(*(dincl.Moving(one, path) for one in sets)) for path in (dincl.RigidMotion(lambda t: 0.0, shift), shift)
    )
    found, expected = (dincl.solve(problem, make(0.02), t=TIMES) for problem in (turned, moved))
    # The midpoint scheme carries the linearisation of a curved set along a path, and changes its gap otherwise.
    tolerance = 1e-3 if isinstance(found.scheme, dincl.MidpointCatchUp) else 1e-8
    assert np.abs(found.x - expected.x).max() < tolerance


@pytest.mark.slow
@pytest.mark.parametrize("make", METHODS)
@pytest.mark.parametrize("own", [InEllipse((2.6, 1.9)), InBall(2.2)], ids=["own function", "own sweep"])
def test_a_set_of_your_own_turns(make, own):
    """An observer who turns with the set sees it at rest, and a drift that also turns."""

    motion = dincl.RigidMotion(lambda t: 0.5 * t)
    start, force = np.array([[0.1, 0.3], [-1.1, 0.4], [0.9, -0.6]]), np.array([1.0, 0.4])
    turning = dincl.Problem(
        start, lambda t, x: np.tile(turn(0.5 * t) @ force, (3, 1)), [dincl.NonOverlap(0.4), dincl.Moving(own, motion)]
    )
    spin = np.array([[0.0, 0.5], [-0.5, 0.0]])
    still = dincl.Problem(start, lambda t, x: force + x @ spin.T, [dincl.NonOverlap(0.4), own])
    seen, expected = (dincl.solve(problem, make(0.01), t=[1.5]).final for problem in (turning, still))
    assert np.abs(seen @ turn(0.75) - expected).max() < (1e-8 if make(0.1).__class__ is dincl.EventDriven else 0.02)


@pytest.mark.slow_with("CvxpyQP")
@pytest.mark.parametrize("projection", PROJECTIONS)
def test_every_projection_takes_sets_that_turn_and_grow(projection):
    def final(of):
        wall = dincl.HalfSpace(normal, offset, radius)
        problem = dincl.Problem(START, lambda t, x: -x, [dincl.NonOverlap(radius), wall, WALL["own function, moved"]])
        return dincl.solve(problem, dincl.CatchUp(0.1, of), t=[1.0]).final

    assert np.abs(final(projection(1e-9)) - final(dincl.ActiveSet(1e-12))).max() < 1e-6


@pytest.mark.slow
@pytest.mark.parametrize("scene", EXACT, ids=lambda scene: scene.title)
def test_orders_on_scenes_with_exact_solutions(scene):
    end = scene.times[-1]
    errors = {}
    for name, make in {
        "PBD": dincl.PBD,
        "penalty": lambda dt: dincl.Penalty(dt, strength=0.4 / dt),
        "catch-up": lambda dt: dincl.CatchUp(dt, dincl.ActiveSet(1e-12)),
        "linearised": lambda dt: dincl.LinearisedCatchUp(dt, dincl.ActiveSet(1e-12)),
        "midpoint": lambda dt: dincl.MidpointCatchUp(dt, dincl.ActiveSet(1e-12)),
    }.items():
        states = [dincl.solve(scene, make(end / steps), t=scene.times).x for steps in (160, 640)]
        errors[name] = [float(np.abs(x - scene.exact(scene.times)).max()) for x in states]
    # Catch-up is exact, also at any later time, while walls that do not turn back hold a disc.
    halvings = {name: np.log2(a / b) / 2 if a > 1e-12 else np.inf for name, (a, b) in errors.items()}
    assert all(halvings[name] > 0.7 for name in ("PBD", "penalty", "catch-up", "linearised"))
    assert halvings["midpoint"] > 1.8
    assert errors["midpoint"][1] < 1e-5


@pytest.mark.slow_with("closing", "Growing", "1e-11")
@pytest.mark.parametrize("scene", EXACT, ids=lambda scene: scene.title)
@pytest.mark.parametrize("tol", [1e-5, 1e-11])
def test_event_driven_states_its_error(scene, tol):
    times = np.linspace(0.1, scene.times[-1], 20)
    path = dincl.solve(scene, dincl.EventDriven(tol), t=times)
    error = np.abs(path.x - scene.exact(times)).max()
    assert error <= path.error.max() <= tol
    assert len(path.events) >= 2


@pytest.mark.slow
def test_growing_discs_are_swept_as_one_after_another():
    """The list of close pairs serves while discs grow; the reference looks at all pairs."""
    rng = np.random.default_rng(3)
    count = 300
    start = 1.3 * np.stack(np.unravel_index(np.arange(count), (15, 20)), axis=1) + rng.uniform(-0.1, 0.1, (count, 2))
    share = rng.uniform(0.8, 1.0, count)
    problem = dincl.Problem(start, lambda t, x: -0.02 * x, [dincl.NonOverlap(lambda t: (0.4 + 0.4 * t) * share)])
    path, x = dincl.solve(problem, dincl.PBD(0.05), t=[1.0]), start.copy()
    for k in range(20):
        x += 0.05 * (-0.02 * x)
        now = dincl.Problem(start, problem.drift, [dincl.NonOverlap(1e-3)])
        object.__setattr__(now, "constraints", (problem.constraints[0].at((k + 1) / 20),))
        sweeps.sweep(now, (k + 1) / 20, x)
    assert path.final == pytest.approx(x, abs=1e-9)
    assert 2 <= path.stats.neighbour_builds <= 15


@pytest.mark.slow_with("CatchUp")
@pytest.mark.parametrize("scheme", [dincl.CatchUp, dincl.MidpointCatchUp], ids=lambda scheme: scheme.__name__)
def test_many_growing_discs_in_a_box_that_turns(scheme):
    """More discs than are listed at once: candidates are searched anew as discs grow and walls turn."""
    start = 1.1 * (np.stack(np.unravel_index(np.arange(256), (16, 16)), axis=1) - 7.5)
    motion = dincl.RigidMotion(lambda t: 0.3 * t)
    walls = [dincl.Moving(dincl.HalfSpace(n, -9.0, 0.5), motion) for n in ((0, 1), (0, -1), (1, 0), (-1, 0))]
    problem = dincl.Problem(start, lambda t, x: 0 * x, [dincl.NonOverlap(lambda t: 0.5 + 0.06 * t), *walls])
    path = dincl.solve(problem, scheme(0.05, dincl.ProjectedCG(1e-9)), t=[0.6])
    few = dincl.solve(problem, scheme(0.05, dincl.ActiveSet(1e-9)), t=[0.6])
    tolerance = 1e-7 if scheme is dincl.CatchUp else 0.05
    assert problem.violation(0.6, path.final) < tolerance
    assert np.abs(path.final - few.final).max() < 1e-6
    assert np.abs(path.final - start).max() > 0.1


@pytest.mark.parametrize("make", METHODS)
def test_a_thread_that_shortens_pulls_its_ends_together(make):
    """Two particles without a drift: each moves half of what the thread loses, once it is taut."""
    pairs = [(0, 1), (1, 2)]
    thread = dincl.MaxDistance(pairs, lambda t: [1.2 - 0.4 * t, 9.0])
    start = [[0.0, 0.0], [1.0, 0.0], [5.0, 0.0]]
    problem = dincl.Problem(start, lambda t, x: 0 * x, [thread])
    found = dincl.solve(problem, make(0.01), t=[1.0]).final
    tolerance = 0.02 if isinstance(make(0.1), dincl.Penalty) else 1e-9
    assert np.abs(found - [[0.1, 0.0], [0.9, 0.0], [5.0, 0.0]]).max() < tolerance


def test_a_turning_wall_in_space():
    vector = np.array([0.3, -0.2, 0.1])
    wall = dincl.Moving(dincl.HalfSpace((0, 0, 1), radius=0.5), dincl.RigidMotion(lambda t: t * vector))
    problem = dincl.Problem([[0.5, 0.2, 0.6]], lambda t, x: np.array([[0.0, 0.0, -1.0]]), [wall])
    by_events = dincl.solve(problem, dincl.EventDriven(1e-11), t=[1.0]).final
    by_steps = dincl.solve(problem, dincl.MidpointCatchUp(1e-2, dincl.ActiveSet(1e-13)), t=[1.0]).final
    assert np.abs(by_events - by_steps).max() < 1e-4
    from scipy.spatial.transform import Rotation

    assert by_events @ Rotation.from_rotvec(vector).apply([0, 0, 1]) == pytest.approx([0.5], abs=1e-10)


def test_a_kink_of_a_rotation_is_located():
    wall = dincl.Moving(dincl.HalfSpace((0, 1)), dincl.RigidMotion(lambda t: 0.2 * abs(t - 0.7)))
    problem = dincl.Problem([[1.0, 0.3]], lambda t, x: np.array([[0.0, -1.0]]), [wall])
    coarse, fine = (dincl.solve(problem, dincl.EventDriven(tol), t=[2.0]) for tol in (1e-8, 1e-12))
    assert np.abs(coarse.final - fine.final).max() <= coarse.error.max() <= 1e-8


def test_the_velocity_of_the_inclusion_on_a_turning_wall():
    problem = dincl.Problem([[2.0, 0.0]], lambda t, x: 0 * x, [dincl.HalfSpace(lambda t: (-np.sin(t), np.cos(t)))])
    found = dincl.geometry.tangent_velocity(problem, 0.0, problem.x0, tol=1e-9)
    assert found.velocity == pytest.approx(np.array([[0.0, 2.0]]), abs=1e-9)


@pytest.mark.parametrize(
    ("bad", "message"),
    [
        (lambda: dincl.HalfSpace(lambda t: (0.0, 1.0 - 2 * t)), "normal"),
        (lambda: dincl.HalfSpace(lambda t: (0.0, 1.0), lambda t: np.inf if t > 0.4 else 0.0), "offset returned inf"),
        (lambda: dincl.NonOverlap(lambda t: 0.3 - t), "radius"),
        (lambda: dincl.InsideBall((0, 0), lambda t: 9.0 if t < 0.4 else [9.0] * 5), "distance"),
        (lambda: dincl.Moving(dincl.HalfSpace((0, 1)), dincl.RigidMotion(lambda t: np.eye(2) * (1 + t))), "orthogonal"),
        (lambda: dincl.Smooth(lambda t, x: x[:, 1] + (1.0 if t < 0.4 else np.nan)), "g returned nan"),
    ],
)
@pytest.mark.parametrize("make", METHODS[:1] + METHODS[2:3] + METHODS[-1:])
def test_what_is_wrong_at_a_later_time_ends_the_run_and_is_named(bad, message, make):
    problem = dincl.Problem([[0.0, 1.0], [2.0, 1.0]], lambda t, x: 0 * x, [bad()])
    path = dincl.solve(problem, make(0.1), t=[0.1, 1.0], throw=False)
    assert path.status is dincl.Status.CONSTRAINT_FAILED
    assert message in path.detail


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: dincl.Moving(dincl.HalfSpace((0, 1)), lambda t: np.eye(2)), "path.* of shape .2, 2.*RigidMotion"),
        (
            lambda: dincl.Moving(dincl.HalfSpace((0, 1)), dincl.RigidMotion(lambda t: (0.1, 0.2))),
            "an angle, or a matrix",
        ),
        (lambda: dincl.HalfSpace(lambda t: (0.0, 0.0, 1.0)), "normal of shape .3,."),
        (lambda: dincl.NonOverlap(lambda t: -1.0), "radius"),
        (lambda: dincl.NonOverlap(lambda t: [0.1, 0.2, 0.3]), "radius"),
        (lambda: dincl.Smooth(lambda t, x: x[:, 1], lambda x: np.eye(2)), "must be a callable of .t, x., as g is"),
        (lambda: dincl.Smooth(lambda t, x: x[:, 1], lambda t, x: np.zeros((2, 4))), "jacobian: along a test direction"),
        (lambda: dincl.RigidMotion(0.3), "rotation"),
        (lambda: dincl.Moving(dincl.HalfSpace((0, 1)), dincl.RigidMotion(lambda t: t, centre=(0, 0, 0))), "centre"),
    ],
)
def test_what_is_wrong_is_refused_and_named(make, message):
    with pytest.raises(dincl.InvalidProblem, match=message):
        dincl.Problem([[0.0, 1.0], [2.0, 1.0]], lambda t, x: 0 * x, [make()])


def test_sets_that_depend_on_time_travel_to_other_processes():
    scene = dincl.scenes.drum(2)
    for again in (pickle.loads(pickle.dumps(scene)), copy.deepcopy(scene)):
        states = [dincl.solve(one, dincl.PBD(0.1), t=[1.0]).final for one in (scene, again)]
        assert states[0].tobytes() == states[1].tobytes()
