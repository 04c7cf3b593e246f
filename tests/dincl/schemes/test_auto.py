"""Solving to an error: it is kept and stated, passes are made again to the bit, and what no pass reaches is said."""

import pickle

import numpy as np
import pytest

import dincl
from dincl.schemes.resolution import distance_outside, stable_step

SCENES = [dincl.scenes.sliding_disc(), dincl.scenes.stack(), dincl.scenes.four_disks(), dincl.scenes.closing_walls()]


def solved(problem, error, t):
    return dincl.solve(problem, dincl.Auto(error), t=t, throw=False)


def off(path, exact):
    return float(np.linalg.norm(path.x - exact, axis=-1).max())


def thrown(d, radius):
    """Two discs that run into each other at speed 1, and their end at t = 1."""
    e = np.eye(d)[0]
    problem = dincl.Problem([-0.5 * e, 0.47 * e], dincl.drifts.constant([e, -e]), [dincl.NonOverlap(radius)])
    return problem, np.array([-0.015 - radius, -0.015 + radius])[:, None] * e


def wedge(angle):
    """A point that falls into a wedge of this half angle, and rests at its apex."""
    walls = [dincl.HalfSpace((s * np.cos(angle), np.sin(angle))) for s in (1, -1)]
    return dincl.Problem([[0.0, 1.0]], dincl.drifts.constant((0.0, -1.0)), walls)


@pytest.mark.parametrize("scene", SCENES, ids=lambda scene: scene.name)
@pytest.mark.parametrize("error", [1e-2, 1e-4, 1e-7])
def test_the_error_is_the_one_asked_for(scene, error):
    times = np.linspace(0.0, scene.times[-1], 5)[1:]
    path = solved(scene, error, times)
    exact = dincl.solve(scene, dincl.EventDriven(1e-11), t=times).x if scene.exact is None else scene.exact(times)
    assert off(path, exact) <= path.error.max() <= error
    again = solved(scene, error, times)
    assert (again.x == path.x).all()
    assert again.scheme == path.scheme
    assert again.stats == path.stats
    assert path.stats.drift_evaluations > dincl.solve(scene, path.scheme, t=times).stats.drift_evaluations


@pytest.mark.parametrize("radius", [1e-1, 1e-2, 1e-3, 1e-4])
@pytest.mark.parametrize("d", [1, 2, 3])
@pytest.mark.parametrize("error", [1e-2, 1e-3])
def test_small_discs_do_not_pass_through_each_other(d, radius, error):
    problem, exact = thrown(d, radius)
    path = solved(problem, error, 1.0)
    assert path.status
    assert off(path, exact) <= path.error.max() <= error


@pytest.mark.parametrize("angle", [1e-1, 1e-2, 1e-3, 1e-4, 1e-6])
def test_a_point_does_not_fall_through_a_narrow_wedge(angle):
    path = solved(wedge(angle), 1e-3, [0.3, 1.0, 3.0])
    assert path.status
    assert off(path, [[[0.0, 0.7]], [[0.0, 0.0]], [[0.0, 0.0]]]) <= path.error.max() <= 1e-3


def test_radii_of_many_sizes():
    """Seven discs whose radii are six orders of magnitude apart are drawn together."""
    radii = 3 * np.logspace(-9, -3, 7)
    turn = 2 * np.pi * np.arange(7) / 7
    x0 = 1e-2 * np.column_stack((np.cos(turn), np.sin(turn)))
    problem = dincl.Problem(x0, dincl.drifts.attraction((0.0, 0.0)), [dincl.NonOverlap(radii)])
    exact = dincl.solve(problem, dincl.EventDriven(1e-9), t=[1.0, 5.0]).x
    path = solved(problem, 1e-5, [1.0, 5.0])
    assert path.status
    assert off(path, exact) <= path.error.max() <= 1e-5


@pytest.mark.parametrize("end", [3.0, 3.3, 4.0, 5.9])
def test_discs_are_pushed_together(end):
    """In a row, or in a corner, where long steps would put two centres onto one point."""
    row = dincl.Problem(
        [[0.5], [2.0], [3.5], [5.0], [6.5], [9.0]],
        lambda t, x: np.array([[-0.2]] * 5 + [[-3.0]]),
        [dincl.NonOverlap(0.5), dincl.HalfSpace([1.0], 0.0, 0.5)],
    )
    corner = dincl.Problem(
        [[0.6, 0.6], [0.6, 1.7], [1.7, 0.6]],
        dincl.drifts.constant((-1.3, -1.2)),
        [dincl.NonOverlap(0.5), dincl.HalfSpace((1, 0), 0.0, 0.5), dincl.HalfSpace((0, 1), 0.0, 0.5)],
    )
    for problem in (row, corner):
        path = solved(problem, 1e-3, [end, end + 5.0])
        exact = dincl.solve(problem, dincl.EventDriven(1e-9), t=[end, end + 5.0])
        assert off(path, exact.x) <= path.error.max() <= 1e-3


@pytest.mark.parametrize("rate", [100.0, 1e4])
def test_a_stiff_drift(rate):
    """x' = rate (cos t - x) stays near cos t until that falls below 0.2, a wall onto which long steps throw x."""
    wall = dincl.HalfSpace((1, 0), 0.2)
    problem = dincl.Problem([[0.9, 0.0]], lambda t, x: -rate * (x - [[np.cos(t), 0.0]]), [wall])
    times = np.array([0.5, 1.0, 2.0])
    path = solved(problem, 1e-2, times)
    exact = np.maximum(np.cos(times) + np.sin(times) / rate, 0.2)
    assert np.abs(path.x[:, 0, 0] - exact).max() <= path.error.max() + 1 / rate**2


def test_what_comes_and_goes_between_steps_is_seen():
    """A wall pushes the particle to 1 within a hundredth of the run."""
    bump = dincl.Moving(dincl.HalfSpace((1, 0)), lambda t: (np.exp(-(((t - 0.713) / 0.01) ** 2)), 0.0))
    problem = dincl.Problem([[0.5, 0.0]], lambda t, x: 0 * x, [bump])
    path = solved(problem, 1e-2, [4.0])
    assert abs(path.final[0, 0] - 1.0) <= path.error[0] <= 1e-2


@pytest.mark.parametrize("error", [1e-2, 1e-4])
def test_runs_are_cut_where_the_drift_jumps(error):
    """A particle is blown to and fro against a wall; each reversal is at a time that no equal steps know."""
    turns = np.array([0.0, 0.31, 0.77, 1.23, 1.5])
    problem = dincl.Problem(
        [[0.2]], lambda t, x: [[(-1.0) ** (np.searchsorted(turns, t, "right"))]], [dincl.HalfSpace([1.0])]
    )
    path = solved(problem, error, [1.5])
    exact = 0.0
    for sign, length in zip((1, -1, 1), np.diff(turns)[1:], strict=True):
        exact = max(exact + sign * length, 0.0)
    assert abs(path.final[0, 0] - exact) <= path.error[0] <= error
    assert path.stats.steps < 400


def test_what_is_not_resolved_of_a_set_is_stated():
    """A wall shakes so often that no values resolve it."""
    wall = dincl.HalfSpace([1.0], lambda t: 0.1 * np.sin(1e5 * t))
    path = solved(dincl.Problem([[0.05]], dincl.drifts.constant([-1.0]), [wall]), 1e-3, [1.0])
    assert path.status is dincl.Status.NOT_CONVERGED
    assert path.error[0] > 0.05
    assert "constraints[0] (HalfSpace) changes too often" in path.detail


def test_an_empty_set_has_no_solution():
    """Two walls come closer than the disc between them is wide at t = 0.5."""
    walls = [dincl.HalfSpace((side, 0), lambda t: t - 1, 0.5) for side in (1, -1)]
    jaw = dincl.Problem([[0.0, 0.0]], lambda t, x: 0 * x, walls)
    path = solved(jaw, 1e-3, [0.25, 1.0, 2.0])
    assert path.status is dincl.Status.INFEASIBLE
    assert path.t[0] == 0.25
    assert path.t[-1] == pytest.approx(0.5, abs=0.05)


def test_the_stated_error_is_at_least_the_violation():
    """A wall jumps at t = 1 into two discs."""
    walls = [dincl.NonOverlap(0.5), dincl.HalfSpace((0, 1), lambda t: 0.0 if t < 1 else 0.6, 0.1)]
    jump = dincl.Problem([[-0.6, 0.9], [0.7, 0.8]], lambda t, x: -x, walls)
    path = solved(jump, 1e-3, [1.0, 2.0])
    assert path.status
    assert (path.error >= path.violation() / 2).all()


@pytest.mark.parametrize("error", [1e-7, 1e-9])
def test_events_are_taken_where_they_need_less_work(error):
    scene = dincl.scenes.four_disks()
    path = solved(scene, error, [1.0, 2.0])
    assert path.scheme == dincl.EventDriven(error)
    assert path.events
    sent = pickle.loads(pickle.dumps(path))
    assert (sent([0.5, 1.5]) == path([0.5, 1.5])).all()
    assert (path([2.0]) == path.x[-1]).all()


def test_work_of_all_passes_is_counted_and_states_between_are_those_of_the_last():
    scene = dincl.scenes.four_disks()
    path = solved(scene, 1e-3, [1.0, 2.0])
    assert isinstance(path.scheme, dincl.AdaptiveCatchUp)
    assert path.stats.steps > 1.4 * dincl.solve(scene, path.scheme, t=[1.0, 2.0]).stats.steps
    assert (path([1.0]) == path.x[0]).all()
    fine = dincl.solve(scene, dincl.EventDriven(1e-10), t=[0.3, 1.7])
    assert np.abs(path([0.3, 1.7]) - fine.x).max() < 5e-3


def test_more_particles_than_events_serve():
    many = dincl.Problem(2.0 * np.arange(1200.0)[:, None], dincl.drifts.constant([-1.0]), [dincl.HalfSpace([1.0])])
    path = solved(many, 1e-6, [0.5])
    assert off(path, np.maximum(many.x0 - 0.5, 0.0)) <= 1e-6


@pytest.mark.slow
def test_what_no_pass_reaches_is_said():
    """A drift with noise has no solution that finer steps approach."""
    rng = np.random.default_rng(0)
    noisy = dincl.Problem([[0.0, 1.0]], lambda t, x: rng.normal(size=(1, 2)), [dincl.HalfSpace((0, 1))])
    path = solved(noisy, 1e-9, [1.0])
    assert not path.status
    assert path.detail


def test_a_drift_that_fails_ends_the_run():
    late = dincl.Problem([[0.0]], lambda t, x: -1 / (0.5 - t) if t > 0.5 else [[np.nan]] if t == 0.5 else [[1.0]])
    path = solved(late, 1e-3, [0.25, 1.0])
    assert path.status is dincl.Status.DRIFT_FAILED
    assert path.t[0] == 0.25
    assert path.error is None


def test_nothing_to_do():
    path = solved(dincl.scenes.four_disks(), 1e-3, [0.0])
    assert path.status
    assert (path.x[0] == dincl.scenes.four_disks().x0).all()
    assert path.error[0] <= 1e-3


@pytest.mark.parametrize("error", [0.0, -1.0, np.nan, "small"])
def test_bad_errors_are_refused(error):
    with pytest.raises(dincl.InvalidProblem, match="error"):
        dincl.Auto(error)


def test_distance_outside_and_stable_step():
    """Of two discs, each is off by half the overlap at least; a linear drift of rate r is stable to 2 / r."""
    discs = dincl.Problem([[0.0, 0.0], [1.0, 0.0]], lambda t, x: 0 * x, [dincl.NonOverlap(0.5)])
    states = np.array([[[0.0, 0.0], [1.0, 0.0]], [[0.0, 0.0], [0.9, 0.0]]])
    assert distance_outside(discs, np.array([0.0, 1.0]), states) == pytest.approx(0.05)
    for rate in (100.0, 1e4):
        linear = dincl.Problem([[0.9, 0.0]], lambda t, x, r=rate: -r * (x - [[np.cos(t), 0.0]]))
        assert stable_step(linear, np.zeros(1), linear.x0[None]) == pytest.approx(2 / rate, rel=1e-6)
