"""The scheme that chooses: its errors are those asked for, its forecasts follow Richardson's estimate."""

from types import SimpleNamespace

import numpy as np
import pytest

import dincl
from dincl.schemes.auto import Choice, _errors
from dincl.schemes.pilots import AIM, FARTHEST, FIRST, LEAST_RUNS, SAFETY, Candidate, Pilot, event_driven
from dincl.schemes.resolution import distance_outside, stable_step

SCENES = [dincl.scenes.sliding_disc(), dincl.scenes.stack(), dincl.scenes.four_disks(), dincl.scenes.closing_walls()]


def pilot(errors, order, wanted=1e-6, dt=1.0):
    """A pilot whose runs with 8, 16, ... steps have these errors, and a cost of 1 ms a step."""
    found = Pilot(None, Candidate("made up", dincl.PBD, order), np.array([dt]), wanted)
    for k, error in enumerate(errors):
        found.steps.append(8 * 2**k)
        found.outcomes.append(SimpleNamespace(x=np.array([[[error, 0.0]]])))
        found.seconds.append(1e-3 * 8 * 2**k)
        found.outside.append(0.0)
    return found


@pytest.mark.parametrize("order", [1, 2])
def test_error_and_order_follow_from_the_differences(order):
    """Differences of runs of order p fall by 2^p; the finest one, taken as of order one, is the error."""
    made = pilot([2.0 ** (-order * k) for k in range(5)], order, wanted=1e-4)
    error, observed = made.estimate()
    finest = 2.0 ** (-order * 4)
    assert error == pytest.approx((2**order - 1) * finest, rel=1e-9)
    assert error >= finest
    assert observed == pytest.approx(order)
    steps = 1.0 / made.forecast().setting
    assert steps == pytest.approx(128 * (SAFETY * error / (AIM * 1e-4)) ** (1 / order), rel=1e-2)
    assert made.forecast().seconds == pytest.approx(1e-3 * steps, rel=0.1)
    assert made.forecast().low == made.forecast().error / 8
    assert made.forecast().error <= made.forecast().high


@pytest.mark.parametrize(("seen", "believed"), [(1.0, 0.7 * 2), (1.7, 1.7), (3.0, 2)])
def test_an_order_is_believed_between_a_part_of_that_in_smooth_motion_and_all_of_it(seen, believed):
    assert pilot([2.0 ** (-seen * k) for k in range(5)], 2).estimate()[1] == pytest.approx(believed)


def test_runs_that_agree_by_chance_are_not_believed():
    """The last difference is tiny, the ones before are not: the estimate rests on all."""
    made = pilot([1.0, 0.5, 0.25, 0.25 + 1e-12], 1)
    assert made.estimate()[0] > 0.1
    assert not made.is_done()


def test_few_runs_decide_nothing():
    made = pilot([1e-9, 1e-10, 1e-11], 1, wanted=1e-4)
    assert len(made.steps) < LEAST_RUNS
    assert not made.is_done()


def test_an_error_that_is_reached_costs_nothing_more():
    made = pilot([4.0**-k for k in range(12)], 2, wanted=1e-4)
    assert made.is_done()
    assert made.forecast().seconds == 0.0


def test_states_are_at_least_so_wrong_as_they_are_outside_of_the_set():
    """Runs agree, but all are 0.01 outside: of two discs, each is off by half the overlap at least."""
    made = pilot([4.0**-k for k in range(12)], 1, wanted=1e-3)
    made.outside = [0.01] * 12
    assert made.is_contradicted()
    assert not made.is_done()
    discs = dincl.Problem([[0.0, 0.0], [1.0, 0.0]], lambda t, x: 0 * x, [dincl.NonOverlap(0.5)])
    states = np.array([[[0.0, 0.0], [1.0, 0.0]], [[0.0, 0.0], [0.9, 0.0]]])
    assert distance_outside(discs, np.array([0.0, 1.0]), states) == pytest.approx(0.05)


@pytest.mark.parametrize("end", [3.0, 3.3, 4.0, 5.9])
def test_long_steps_may_put_two_centres_onto_one_point(end):
    """Discs in a row, or in a corner, are pushed together: a coarse pilot run leaves them on each other."""
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
        path = dincl.solve(problem, dincl.Auto(1e-3), t=[end, end + 5.0])
        exact = dincl.solve(problem, dincl.EventDriven(1e-9), t=[end, end + 5.0])
        assert np.abs(path.x - exact.x).max() <= 1e-3


def test_a_run_whose_centres_coincide_is_repeated_with_finer_steps(monkeypatch):
    made = pilot([], 1, wanted=1e-3)
    found = iter([np.inf, 0.0])
    monkeypatch.setattr("dincl.schemes.pilots.distance_outside", lambda *_: next(found))
    made.problem = dincl.Problem([[1.0]], lambda t, x: -x)
    made.refine()
    assert made.steps == [2 * FIRST]
    assert not made.why


@pytest.mark.parametrize("error", [1e-3, 1e-300])
def test_predictions_do_not_overflow(error):
    assert pilot([1e3, 1e2, 1e1, 1.0], 1, wanted=error).forecast().seconds > 0


def test_an_error_at_one_time_is_not_small_by_chance():
    """The difference of two runs changes its sign at the second time."""
    made = pilot([1.0, 0.5, 0.25, 0.125], 1, wanted=1e-3)
    coarse, fine = np.reshape([0.1, 0.0, 0.2], (3, 1, 1)), np.zeros((3, 1, 1))
    made.outcomes[-2:] = [SimpleNamespace(x=coarse), SimpleNamespace(x=fine)]
    errors = _errors(made)
    assert errors[0] == errors[1] < errors[2]


def test_an_empty_set_has_no_solution():
    """Two walls come closer than the disc between them is wide at t = 0.5; all PBD runs agree from there on."""
    walls = [dincl.HalfSpace((side, 0), lambda t: t - 1, 0.5) for side in (1, -1)]
    jaw = dincl.Problem([[0.0, 0.0]], lambda t, x: 0 * x, walls)
    path = dincl.solve(jaw, dincl.Auto(1e-3), t=[1.0, 2.0], throw=False)
    assert path.status is dincl.Status.NOT_CONVERGED


def test_the_stated_error_is_at_least_the_violation():
    """A wall jumps at t = 1 into two discs, which PBD then leaves on each other: its runs agree to 2e-6."""
    walls = [dincl.NonOverlap(0.5), dincl.HalfSpace((0, 1), lambda t: 0.0 if t < 1 else 0.6, 0.1)]
    jump = dincl.Problem([[-0.6, 0.9], [0.7, 0.8]], lambda t, x: -x, walls)
    path = dincl.solve(jump, dincl.Auto(1e-3), t=[1.0, 2.0])
    assert (path.error >= path.violation() / 2).all()


@pytest.mark.parametrize("rate", [100.0, 1e4])
def test_steps_that_are_unstable_agree_on_a_wall(rate):
    """x' = rate (cos t - x) stays near cos t until that falls below 0.2, a wall onto which long steps throw x."""
    wall = dincl.HalfSpace((1, 0), 0.2)
    problem = dincl.Problem([[0.9, 0.0]], lambda t, x: -rate * (x - [[np.cos(t), 0.0]]), [wall])
    times = np.array([0.5, 1.0, 2.0])
    assert stable_step(problem, np.zeros(1), problem.x0[None]) == pytest.approx(2 / rate, rel=1e-6)
    path = dincl.solve(problem, dincl.Auto(1e-2), t=times)
    exact = np.maximum(np.cos(times) + np.sin(times) / rate, 0.2)
    assert np.abs(path.x[:, 0, 0] - exact).max() <= path.error.max() + 1 / rate**2


def test_what_comes_and_goes_between_steps_is_seen():
    """A wall pushes the particle to 1 within a hundredth of the run."""
    bump = dincl.Moving(dincl.HalfSpace((1, 0)), lambda t: (np.exp(-(((t - 0.713) / 0.01) ** 2)), 0.0))
    problem = dincl.Problem([[0.5, 0.0]], lambda t, x: 0 * x, [bump])
    path = dincl.solve(problem, dincl.Auto(1e-2), t=[4.0])
    assert abs(path.final[0, 0] - 1.0) <= path.error[0]


def test_other_methods_are_begun_only_where_they_can_save_something():
    """A point that moves freely to 1e-2 is solved by the first runs of the first method."""
    free = dincl.Problem([[0.0, 1.0]], dincl.drifts.constant((1.0, 0.0)), [dincl.HalfSpace((0, 1))])
    path = dincl.solve(free, dincl.Auto(1e-2), t=[1.0])
    assert path.stats.steps == 8 + 16 + 32 + 45
    assert type(path.scheme) is dincl.PBD


@pytest.mark.slow
def test_a_method_with_slow_steps_is_given_a_share_of_what_the_best_one_costs():
    """Steps of the second method take as long as they may and longer; they are ended, and begun again later."""
    scene, begun = dincl.scenes.four_disks(), []

    class Slow(dincl.PBD):
        """As PBD, over and over again."""

        def run(self, problem, times):
            begun.append(times[-1])
            for _ in range(1000 if times[-1] > 1 else 1):
                super().run(problem, times)

    def slow(dt):
        return Slow(1e-4 * dt)

    methods = [Candidate("quick", dincl.PBD, 1), Candidate("slow", slow, 1)]
    choice = Choice(scene, np.array([scene.times[-1]]), 1e-4, methods)
    choice.begin(0.5)
    quick, other = choice.pilots
    assert other.tried == pytest.approx(0.5 * quick.forecast().seconds)
    assert other.unfinished
    assert "takes more than" in other.forecast().why
    choice.begin(0.9)  # not twice as much
    assert begun == [1e-6 * scene.times[-1], scene.times[-1]]
    choice.begin(5.0)
    assert len(begun) == 3
    assert choice.forecasts[0].label == "quick"


@pytest.mark.slow_with("closing_walls")
@pytest.mark.parametrize("scene", SCENES, ids=lambda scene: scene.name)
@pytest.mark.parametrize("error", [1e-2, 1e-4, 1e-7])
def test_the_error_is_the_one_asked_for(scene, error):
    times = np.linspace(0.0, scene.times[-1], 5)[1:]
    path = dincl.solve(scene, dincl.Auto(error), t=times)
    exact = dincl.solve(scene, dincl.EventDriven(1e-11), t=times).x if scene.exact is None else scene.exact(times)
    assert np.abs(path.x - exact).max() <= path.error.max() <= error
    assert type(path.scheme) is not dincl.Auto
    again = dincl.solve(scene, path.scheme, t=times)
    assert again.x == pytest.approx(path.x, abs=1e-12)
    assert path.stats.drift_evaluations > again.stats.drift_evaluations


@pytest.mark.slow
def test_what_no_method_reaches_is_said():
    """A drift with noise has no solution that finer steps approach."""
    rng = np.random.default_rng(0)
    noisy = dincl.Problem([[0.0, 1.0]], lambda t, x: rng.normal(size=(1, 2)), [dincl.HalfSpace((0, 1))])
    path = dincl.solve(noisy, dincl.Auto(1e-9), t=[1.0], throw=False)
    assert not path.status
    assert path.detail


def test_a_drift_that_fails_ends_the_run():
    def drift(t, x):
        raise ValueError("no wind")

    with pytest.raises(dincl.InvalidProblem, match="no wind"):
        dincl.Problem([[0.0]], drift)
    late = dincl.Problem([[0.0]], lambda t, x: -1 / (0.5 - t) if t > 0.5 else [[np.nan]] if t == 0.5 else [[1.0]])
    path = dincl.solve(late, dincl.Auto(1e-3), t=[1.0], throw=False)
    assert path.status is dincl.Status.DRIFT_FAILED or not path.status


def test_the_event_driven_method_is_left_out_in_words():
    scene, times = dincl.scenes.ten_disks_corner(), np.array([3.0])
    method = Candidate("event-driven", dincl.EventDriven, 0)
    assert "takes more than" in event_driven(scene, method, times, 1e-6, 1e-9).why
    assert event_driven(scene, method, times, 1e-6, 60.0).why == ""
    many = dincl.Problem(2.0 * np.arange(1200.0)[:, None], lambda t, x: 0 * x)
    assert event_driven(many, method, times, 1e-6, 60.0).why == "serves at most 1000 particles"


@pytest.mark.parametrize("error", [0.0, -1.0, np.nan, "small"])
def test_bad_errors_are_refused(error):
    with pytest.raises(dincl.InvalidProblem, match="error"):
        dincl.Auto(error)


def test_one_run_is_at_most_so_many_times_finer_than_the_one_before():
    made = pilot([1.0, 0.5, 0.25], 1, wanted=1e-12)
    asked = []
    made.run = lambda steps: asked.append(steps) or True
    made.refine()
    assert asked == [FARTHEST * 32]
