"""The event-driven reference against exact solutions, symmetry, catch-up, and its own error estimate."""

import numpy as np
import pytest

import dincl
from dincl import scenes
from dincl.scenes.discs import PAST_OTHER
from tests.dincl.catalog import SCENES
from tests.twins.events.scheme import PlainEventDriven

EXACT = [scene for scene in SCENES if scene.exact]
HEXAGON = np.array([[0, 0], *([np.cos(a), np.sin(a)] for a in np.arange(6) * np.pi / 3)])


def farthest(x, y):
    return np.sqrt(((x - y) ** 2).sum(axis=-1)).max(axis=-1)


def turned(x, angle):
    c, s = np.cos(angle), np.sin(angle)
    return x @ np.array([[c, s], [-s, c]])


def random_discs(n, d, kind, seed):
    """Discs of different radii above a floor, drawn together, stirred, or shaken."""
    rng = np.random.default_rng(seed)
    radius, places = rng.uniform(0.3, 0.6, n), []
    while len(places) < n:
        place = 1.1 * n ** (1 / d) * rng.uniform(-1, 1, d)
        if all(np.linalg.norm(place - other) > radius[len(places)] + radius[j] for j, other in enumerate(places)):
            places.append(place)
    x0, direction = np.array(places), rng.normal(size=(n, d))
    drifts = {
        "drawn": lambda t, x: -x * np.linspace(0.5, 1.5, n)[:, None],
        "stirred": lambda t, x: np.roll(x, 1, axis=1) * np.array([1, *[-1] * (d - 1)]) - 0.7 * x,
        "shaken": lambda t, x: np.sin(3 * t) * direction - x,
    }
    floor = dincl.HalfSpace(normal=(*[0] * (d - 1), 1), offset=x0[:, -1].min() - 0.8, radius=radius)
    return dincl.Problem(x0, drifts[kind], [dincl.NonOverlap(radius), floor])


@pytest.mark.slow_with("sweeping_interval", "drum", "closing_walls", "growing_discs")
@pytest.mark.parametrize("scene", EXACT, ids=lambda scene: scene.name)
def test_exact_scenes_to_twelve_digits(scene):
    t = np.linspace(0, scene.times[-1], 9)
    path = dincl.solve(scene, dincl.EventDriven(tol=1e-12), t)
    error = farthest(path.x, scene.exact(t))
    assert error.max() <= 1e-12
    assert (error <= path.error).all()
    assert path.error.max() <= 1e-12


@pytest.mark.slow_with("sweeping_interval-0.001", "drum-0.001", "drum-1e-09", "closing_walls", "growing_discs")
@pytest.mark.parametrize("tol", [1e-3, 1e-6, 1e-9])
@pytest.mark.parametrize("scene", EXACT, ids=lambda scene: scene.name)
def test_stated_error_is_honest_at_any_tolerance(scene, tol):
    t = np.linspace(0, scene.times[-1], 23)[1:]
    path = dincl.solve(scene, dincl.EventDriven(tol), t)
    assert (farthest(path.x, scene.exact(t)) <= path.error).all()
    assert path.error.max() <= tol


@pytest.mark.slow_with("sweeping_interval", "drum", "closing_walls", "growing_discs")
@pytest.mark.parametrize("scene", EXACT, ids=lambda scene: scene.name)
def test_dense_output_between_kept_times(scene, rng):
    t = np.sort(rng.uniform(0, scene.times[-1], 60))
    path = dincl.solve(scene, dincl.EventDriven(tol=1e-12), scene.times)
    assert farthest(path(t), scene.exact(t)).max() <= 1e-11
    assert max(scene.violation(time, state) for time, state in zip(t, path(t), strict=True)) <= 1e-13


@pytest.mark.parametrize(
    ("n", "d", "kind", "seed"), [(12, 2, "drawn", 0), (20, 2, "shaken", 5), (12, 3, "stirred", 1), (14, 3, "shaken", 3)]
)
def test_random_scenes_with_many_releases(n, d, kind, seed):
    problem, t = random_discs(n, d, kind, seed), [0.5, 1.0, 2.0]
    fine = dincl.solve(problem, dincl.EventDriven(tol=1e-12), t, throw=False)
    coarse = dincl.solve(problem, dincl.EventDriven(tol=1e-10), t)
    assert coarse.error.max() <= 1e-10
    assert (farthest(coarse.x, fine.x) <= coarse.error + fine.error).all()
    assert fine.violation().max() <= 1e-13
    assert fine.normal_cone_residual().max() <= 1e-9
    assert sum(event.kind == "contact" for event in fine.events) >= 8
    assert kind != "shaken" or sum(event.kind == "release" for event in fine.events) >= 15


@pytest.mark.slow
def test_catch_up_converges_to_it():
    """Independent of all that is shared by two event-driven runs; events keep the error from being c h exactly."""
    problem, t = random_discs(12, 2, "shaken", 4), [0.5, 1.0, 2.0]
    path = dincl.solve(problem, dincl.EventDriven(tol=1e-11), t)
    steps = (1 / 64, 1 / 256, 1 / 1024)
    runs = [dincl.solve(problem, dincl.LinearisedCatchUp(h, dincl.Daqp(1e-11)), t) for h in steps]
    coarse, middle, fine = (farthest(run.x, path.x).max() for run in runs)
    assert len(path.events) >= 20
    assert 2 < coarse / middle < 8
    assert 2 < middle / fine < 8
    assert fine <= 2e-3


def test_thesis_scenes_to_twelve_digits():
    for scene in (scenes.four_disks(), scenes.ten_disks_corner()):
        path = dincl.solve(scene, dincl.EventDriven(tol=1e-12), scene.times)
        assert path.error.max() <= 1e-12
        assert path.normal_cone_residual().max() <= 1e-12
        assert path.violation().max() <= 1e-13


def test_events_of_two_disks():
    path = dincl.solve(scenes.two_disks(), dincl.EventDriven(tol=1e-12), [4.0])
    found = [(event.kind, event.constraint, event.row) for event in path.events]
    assert found == [("contact", 0, "particle 1 and 0"), ("release", 0, "particle 1 and 0")]
    touches, leaves = (float(t) for t in PAST_OTHER.events())
    assert path.events[0].t == pytest.approx(touches, abs=1e-12)
    # A push that vanishes linearly leaves its time known to the threshold only; the path does not feel that.
    assert path.events[1].t == pytest.approx(leaves, abs=1e-8)


def test_redundant_contacts_turn_as_one():
    """Seven equal discs have twelve contacts and eleven relative freedoms: many multipliers, one velocity."""
    problem = dincl.Problem(HEXAGON, lambda t, x: turned(x, np.pi / 2) - x, [dincl.NonOverlap(0.5)])
    path = dincl.solve(problem, dincl.EventDriven(tol=1e-10), [1.0, 3.0])
    assert farthest(path.x, np.array([turned(HEXAGON, t) for t in path.t])).max() <= 1e-10
    assert path.events == ()


def test_twelve_contacts_open_at_once():
    problem = dincl.Problem(HEXAGON, lambda t, x: (t - 1) * x, [dincl.NonOverlap(0.5)])
    path = dincl.solve(problem, dincl.EventDriven(tol=1e-11), [1.0, 2.0])
    assert farthest(path.final, HEXAGON * np.exp(0.5)).max() <= 1e-11
    assert len(path.events) == 12
    assert {event.kind for event in path.events} == {"release"}
    assert max(abs(event.t - 1) for event in path.events) <= 1e-8


def test_twelve_contacts_close_at_once():
    problem = dincl.Problem(2 * HEXAGON, lambda t, x: -x, [dincl.NonOverlap(0.5)])
    path = dincl.solve(problem, dincl.EventDriven(tol=1e-11), [0.5, 3.0])
    assert farthest(path.x, np.array([2 * np.exp(-0.5) * HEXAGON, HEXAGON])).max() <= 1e-11
    assert [event.kind for event in path.events] == ["contact"] * 12
    assert np.ptp([event.t for event in path.events]) <= 1e-12


@pytest.mark.parametrize("height", [1e-3, 1e-9, 0.0, -1e-13, -1e-10, -1e-6])
def test_a_graze_is_no_trouble(height):
    problem = dincl.Problem([[-2.0, 1 + height]], lambda t, x: np.array([[1.0, 0.0]]), [dincl.OutsideBall((0, 0), 1.0)])
    path = dincl.solve(problem, dincl.EventDriven(tol=1e-12), [4.0])
    # Met at sin(a) = half left of the top, slid up with a' = -cos(a) for the time artanh(half), left at the top.
    half = np.sqrt(max(0.0, 1 - (1 + height) ** 2))
    expected = [2 + half - np.arctanh(half), max(1 + height, 1.0)]
    assert np.abs(path.final[0] - expected).max() <= 1e-11
    assert len(path.events) == (2 if height < 0 else 0)


@pytest.mark.slow
def test_brief_contact_after_a_release_is_seen(monkeypatch):
    """The gaps are found also when they dip below zero between two nodes: plain Python with denser nodes finds none."""
    problem, t = random_discs(20, 3, "shaken", 2), [1.5]
    path = dincl.solve(problem, dincl.EventDriven(tol=1e-8), t)
    monkeypatch.setattr("tests.twins.events.watch.PARTS", 32)
    dense = dincl.solve(problem, PlainEventDriven(tol=1e-8), t)
    assert [event[1:] for event in path.events] == [event[1:] for event in dense.events]
    assert farthest(path.final, dense.final) <= path.error[0] + dense.error[0]


def test_smooth_constraint_comes_to_rest_where_the_normal_is_the_drift():
    inside = dincl.Smooth(
        lambda x: np.array([1 - x[0, 0] ** 2 / 4 - x[0, 1] ** 2]), lambda x: np.array([[-x[0, 0] / 2, -2 * x[0, 1]]])
    )
    problem = dincl.Problem([[0.1, 0.2]], lambda t, x: np.array([[1.0, 0.3]]), [inside])
    path = dincl.solve(problem, dincl.EventDriven(tol=1e-11), [1.0, 60.0])
    assert np.abs(path.x[0] - [[1.1, 0.5]]).max() <= 1e-12
    # At rest (x/2, 2y) is parallel to (1, 0.3) and x^2/4 + y^2 = 1: x = 4 s, y = 0.3 s ... with 4 s^2 + 0.0225 s^2 = 1.
    scale = 1 / np.sqrt(1.0 + 0.0225)
    assert np.abs(path.final[0] - [2 * scale, 0.15 * scale]).max() <= 1e-10


def test_a_smooth_set_is_met_and_left_as_a_built_in_one():
    """Its gaps are known to Python alone: a particle falls down the side of a ball."""
    centre = np.array([0.1, -2.0])
    ball = dincl.Smooth(lambda x: ((x - centre) ** 2).sum(axis=1) - 1, lambda x: 2 * (x - centre))
    fall, t = np.array([[1.0, -3.0]]), [0.5, 0.7, 1.0, 2.0]
    paths = [
        dincl.solve(dincl.Problem([[0.0, 0.0]], lambda t, x: fall, [body]), dincl.EventDriven(tol=1e-10), t)
        for body in (ball, dincl.OutsideBall(centre, 1.0))
    ]
    assert np.abs(paths[0].x - paths[1].x).max() <= 1e-10
    assert [[event.kind for event in path.events] for path in paths] == [["contact", "release"]] * 2
    assert paths[0].violation().max() <= 1e-12


def test_moving_set_with_a_kink_in_its_path():
    wall = dincl.Moving(dincl.HalfSpace((1,)), lambda t: (1 - abs(t - 1),))
    path = dincl.solve(dincl.Problem([[0.2]], lambda t, x: 0 * x, [wall]), dincl.EventDriven(tol=1e-9), [0.5, 1.5, 3.0])
    assert np.abs(path.x[:, 0, 0] - [0.5, 1.0, 1.0]).max() <= 1e-9


def test_start_that_violates_within_its_tolerance_is_put_right():
    problem = dincl.Problem([[0.0, 0.0], [1 - 5e-10, 0.0]], lambda t, x: 0 * x, [dincl.NonOverlap(0.5)])
    path = dincl.solve(problem, dincl.EventDriven(tol=1e-11), [0.0, 1.0])
    assert path.violation().max() <= 1e-13
    assert np.abs(path.final - [[-2.5e-10, 0.0], [1 - 2.5e-10, 0.0]]).max() <= 1e-14


def test_no_constraints_and_no_time():
    problem = dincl.Problem([[1.0]], lambda t, x: -x)
    path = dincl.solve(problem, dincl.EventDriven(tol=1e-11), [0.0, 2.0])
    assert abs(path.final[0, 0] - np.exp(-2)) <= 1e-11
    assert np.array_equal(path(1e-9 * 0), problem.x0)
    only_start = dincl.solve(problem, dincl.EventDriven(tol=1e-11), [0.0])
    assert np.array_equal(only_start.final, problem.x0)


def test_failures_keep_what_was_reached():
    def breaks(t, x):
        if t > 1:
            raise ValueError("no drift after t = 1")
        return -x

    problem = dincl.Problem([[2.0]], breaks, [dincl.HalfSpace((1,), 1.0)])
    path = dincl.solve(problem, dincl.EventDriven(tol=1e-9), [0.5, 3.0], throw=False)
    assert path.status is dincl.Status.DRIFT_FAILED
    assert "no drift after t = 1" in path.detail
    assert path.x[0, 0, 0] == pytest.approx(2 * np.exp(-0.5), abs=1e-9)
    assert 0.5 < path.t[-1] <= 1.0
    assert path.error is None

    walls = [dincl.Moving(dincl.HalfSpace((1,)), lambda t: (t,)), dincl.HalfSpace((-1,), -1.0)]
    crushed = dincl.Problem([[0.5]], lambda t, x: 0 * x, walls)
    path = dincl.solve(crushed, dincl.EventDriven(tol=1e-9), [3.0], throw=False)
    assert path.status is dincl.Status.INFEASIBLE
    assert path.t[-1] == pytest.approx(1.0, abs=1e-9)

    blows = dincl.Problem([[1.0]], lambda t, x: x * x)
    with pytest.raises(dincl.StepFailed, match="integrator stopped"):
        dincl.solve(blows, dincl.EventDriven(tol=1e-9), [2.0])


def test_tolerance_below_rounding_is_not_claimed():
    path = dincl.solve(scenes.ten_disks_corner(), dincl.EventDriven(tol=1e-18), [1.0], throw=False)
    assert path.status is dincl.Status.NOT_CONVERGED
    assert path.error[0] > 1e-18
    assert "estimated error" in path.detail


def test_two_runs_have_no_step_in_common():
    path = dincl.solve(scenes.sliding_disc(), dincl.EventDriven(tol=1e-3), [4.0])
    assert path.error[0] > 1e-9  # equal steps would differ by rounding only, and state an error far too small


@pytest.mark.parametrize("tol", [0.0, -1.0, np.nan, "1e-9"])
def test_tolerance_must_be_positive(tol):
    with pytest.raises(dincl.InvalidProblem, match="tol"):
        dincl.EventDriven(tol)


def held_by_a_ball(radius):
    """A chain whose first bead is in a ball, and whose last one is pulled: it is taut after a while."""
    x0 = np.column_stack([0.9 * np.arange(3), [0.0, 0.08, 0.09]])
    pull = np.array([[0.0, 0.0], [0.0, 0.0], [1.0, 0.0]])
    sets = [dincl.MaxDistance([(0, 1), (1, 2)], 1.0), dincl.InsideBall((0, 0), [radius, 1e3, 1e3])]
    return dincl.Problem(x0, lambda t, x: pull, sets)


def test_too_many_steps_name_the_contact_that_makes_them_short():
    assert dincl.solve(held_by_a_ball(0.05), dincl.EventDriven(1e-6), [2.0]).status
    stiff = dincl.solve(held_by_a_ball(1e-6), dincl.EventDriven(1e-6), [2.0], throw=False)
    assert stiff.status is dincl.Status.TOO_MANY_STEPS
    assert "particle 0 (constraints[1]) is pulled against a set so curved" in stiff.detail
    drift = dincl.solve(
        dincl.Problem([[1.0]], lambda t, x: -1e7 * (x - np.cos(t))), dincl.EventDriven(1e-6), [2.0], throw=False
    )
    assert "the drift is stiff" in drift.detail
