"""Adaptive midpoint catch-up: errors follow the tolerance, contacts are seen at any speed, steps end at contacts."""

import numpy as np
import pytest

import dincl
from tests.dincl.catalog import SCENES

EXACT = [scene for scene in SCENES if scene.exact is not None]
T = [0.25, 0.6, 1.0]


def solved(problem, tol, t=1.0):
    return dincl.solve(problem, dincl.AdaptiveCatchUp(tol), t=t)


def off(path, exact):
    return float(np.linalg.norm(path.x - exact, axis=-1).max())


@pytest.mark.parametrize("scene", EXACT, ids=lambda scene: scene.title)
@pytest.mark.parametrize("tol", [1e-3, 1e-5])
def test_error_follows_the_tolerance(scene, tol):
    path = solved(scene, tol, T)
    assert off(path, np.array([scene.exact(t) for t in T])) < 3 * tol
    assert path.violation().max() < tol


@pytest.mark.parametrize("radius", [1e-1, 1e-2, 1e-3, 1e-4])
@pytest.mark.parametrize("d", [1, 2, 3])
def test_small_discs_do_not_pass_through_each_other(radius, d):
    """Two discs that meet at speed 1, at places that no equal steps know, and a tolerance above their radius."""
    e = np.eye(d)[0]
    problem = dincl.Problem([-0.5 * e, 0.47 * e], dincl.drifts.constant([e, -e]), [dincl.NonOverlap(radius)])
    path = solved(problem, 1e-2)
    assert np.abs(path.final[:, 0] - [-0.015 - radius, -0.015 + radius]).max() < 1e-9
    assert path.stats.steps < 100


@pytest.mark.parametrize("radius", [1e-2, 1e-3, 1e-4])
def test_a_small_disc_that_passes_another_is_not_held_back(radius):
    """The linearised row of a far pair bars a half space: a long step would stop the disc before its partner."""
    velocity = [[1.0, 0.0], [0.0, 0.0]]
    problem = dincl.Problem(
        [[0.0, 3 * radius], [0.5, 0.0]], dincl.drifts.constant(velocity), [dincl.NonOverlap(radius)]
    )
    assert np.abs(solved(problem, 1e-2).final - [[1.0, 3 * radius], [0.5, 0.0]]).max() < 3e-2
    assert np.abs(solved(problem, 1e-5).final - [[1.0, 3 * radius], [0.5, 0.0]]).max() < 3e-5


@pytest.mark.parametrize("angle", [1e-1, 1e-2, 1e-4, 1e-6])
def test_a_point_rests_in_a_narrow_wedge(angle):
    walls = [dincl.HalfSpace((s * np.cos(angle), np.sin(angle))) for s in (1, -1)]
    problem = dincl.Problem([[0.0, 1.0]], dincl.drifts.constant((0.0, -1.0)), walls)
    assert np.abs(solved(problem, 1e-3, 3.0).final).max() < 1e-9


def test_a_fast_obstacle_takes_a_particle_along():
    """A small ball that flies over a particle at rest pushes it for as long as it moves, straight ahead."""
    ball = dincl.Moving(dincl.OutsideBall((0.0,), 0.01), lambda t: (-1.0 + 5.0 * t,))
    problem = dincl.Problem([[0.0]], dincl.drifts.constant((0.0,)), [ball])
    assert solved(problem, 1e-2).final[0, 0] == pytest.approx(4.01, abs=1e-6)


@pytest.mark.parametrize("tol", [1e-3, 1e-6])
def test_a_contact_that_begins_and_ends_within_a_long_step(tol):
    """B pushes C until its thread to A, which flies off, becomes taut and takes it away."""
    problem = dincl.Problem(
        [[-1.0], [0.0], [0.5588]],
        dincl.drifts.constant([[-3.0], [1.0], [0.0]]),
        [dincl.Ordered([1, 2], 0), dincl.MaxDistance([[0, 1]], 1 + 4 * 0.5636)],
    )
    assert off(solved(problem, tol), dincl.solve(problem, dincl.EventDriven(1e-11), t=1.0).x) < 1e-9


def corner():
    """A point slides down a floor inclined by 30 degrees until a wall takes it off the floor; exact for t >= 1."""
    slope = np.array([np.cos(np.pi / 6), -np.sin(np.pi / 6)])
    normal = np.array([np.sin(np.pi / 6), np.cos(np.pi / 6)])
    # The drift presses on the floor, and has a part up along the wall, which leans over to the particle's side.
    wall = np.array([-np.cos(0.9), np.sin(0.9)])
    drift = 1.0 * slope - 0.3 * normal
    at = 0.337 * slope
    problem = dincl.Problem(
        [[0.0, 0.0]], dincl.drifts.constant(drift), [dincl.HalfSpace(normal), dincl.HalfSpace(wall, wall @ at)]
    )
    along = drift - min(wall @ drift, 0.0) * wall
    assert normal @ along > 0 > wall @ drift  # the wall takes it off
    return problem, lambda t: t * slope if t <= 0.337 else at + (t - 0.337) * along


def test_a_contact_that_ends_another_one_is_at_the_end_of_a_step():
    problem, exact = corner()
    t = [0.3, 0.7, 1.0]
    wanted = np.array([[exact(s)] for s in t])
    path = solved(problem, 1e-6, t)
    assert off(path, wanted) < 1e-5
    equal = dincl.solve(problem, dincl.MidpointCatchUp(1.0 / path.stats.steps, dincl.ActiveSet(1e-10)), t=t)
    assert off(equal, wanted) > 100 * off(path, wanted)


@pytest.mark.parametrize("tol", [1e-3, 1e-5])
def test_a_drift_that_jumps_between_two_steps(tol):
    problem = dincl.Problem(
        [[0.0, 1.0]], lambda t, x: np.array([[1.0, -1.0]]) if t < 0.3141 else np.array([[-2.0, 0.5]])
    )
    assert off(solved(problem, tol), [[0.3141 - 2 * 0.6859, 1 - 0.3141 + 0.5 * 0.6859]]) < 2 * tol


def test_between_the_steps_are_straight_lines_of_the_same_run():
    scene = dincl.scenes.four_disks()
    path = solved(scene, 1e-3, T)
    assert (path(path.t) == path.x).all()
    fine = dincl.solve(scene, dincl.EventDriven(1e-9), t=T)
    times = np.linspace(0.0, 1.0, 41)
    assert off(dincl.solve(scene, dincl.AdaptiveCatchUp(1e-3), t=times[1:]), fine(times[1:])) < 1e-3
    assert np.abs(path(times) - fine(times)).max() < 1e-2  # a contact inside of a step is cut off
    again = solved(scene, 1e-3, T)
    assert (again.x == path.x).all()
    assert path.normal_cone_residual().max() < 0.2


def test_a_run_that_fails_keeps_its_states():
    shrinking = dincl.InsideBall((0.0, 0.0), lambda t: 1.0 - t)
    problem = dincl.Problem([[0.1, 0.0], [-0.1, 0.3]], lambda t, x: -x, [dincl.NonOverlap(0.1), shrinking])
    path = dincl.solve(problem, dincl.AdaptiveCatchUp(1e-4), t=[0.5, 0.99], throw=False)
    assert not path.status
    assert path.t[0] == 0.5
    assert 0.5 < path.t[-1] < 0.99
    assert len(path.x) == 2


@pytest.mark.parametrize("tol", [0.0, -1.0, np.nan, "fine"])
def test_tolerances_that_are_none(tol):
    with pytest.raises(dincl.InvalidProblem, match="tol"):
        dincl.AdaptiveCatchUp(tol)


@pytest.mark.parametrize("tol", [1e-2, 1e-4, 1e-6])
def test_sets_that_jump(tol):
    """Away from a point that leans on it: a wall. Onto a point: an obstacle, which moves it at once."""
    wall = dincl.HalfSpace((1.0,), lambda t: -1.0 if t <= 0.7137 else 3.0)
    problem = dincl.Problem([[0.5]], lambda t, x: np.ones_like(x), [wall])
    assert solved(problem, tol, 2.0).final[0, 0] == pytest.approx(5.0 - 0.7137, abs=10 * tol)
    leaning = dincl.HalfSpace((-1.0,), lambda t: -0.5 if t <= 0.6 else -9.0)
    problem = dincl.Problem([[0.0]], lambda t, x: np.ones_like(x), [leaning])
    assert np.abs(solved(problem, tol, [0.55, 0.6, 0.75]).x.ravel() - [0.5, 0.5, 0.65]).max() < 10 * tol
    ball = dincl.OutsideBall(lambda t: (5.0, 0.0) if t <= 0.7137 else (0.2, 0.6), 0.5)
    problem = dincl.Problem([[0.0, 0.0]], dincl.drifts.constant((0.0, 1.0)), [ball])
    exact = dincl.solve(problem, dincl.EventDriven(1e-9), t=[0.72, 1.0])
    assert off(solved(problem, tol, [0.72, 1.0]), exact.x) < 30 * tol


@pytest.mark.parametrize("drift", [lambda t, x: -np.sign(x - 0.1), lambda t, x: np.sin(1e9 * t) + 0 * x])
def test_a_drift_that_no_step_resolves_ends_the_run(drift):
    path = dincl.solve(dincl.Problem([[0.5]], drift), dincl.AdaptiveCatchUp(1e-7), t=[2.0], throw=False)
    assert path.status in (dincl.Status.TOO_MANY_STEPS, dincl.Status.STEP_TOO_SMALL)
