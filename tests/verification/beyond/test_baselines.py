"""External programs solve the problem that they are given, or say that they cannot."""

import importlib.util

import numpy as np
import pytest

import dincl
from dincl.drifts import attraction, constant
from dincl.scenes import Scene
from verification.beyond.chart.baselines import Chipmunk, Lsoda, chipmunk
from verification.instruments.budget import CpuSeconds, DriftEvaluations, OutOfBudgetError, counted

SLIDE = dincl.scenes.sliding_disc()
TIMES = np.arange(1, 61) * 0.05
FLOOR = dincl.HalfSpace(normal=(0, 1), radius=0.5)


def a_scene(x0, drift, constraints, radius=0.5):
    return Scene(x0, drift, constraints, name="", title="", times=(1.0,), radius=radius)


def on_the_floor(speed=2.0):
    return a_scene([(0.0, 0.75)], constant(np.array([[0.3, -speed]])), [FLOOR])


def error(scheme):
    path = dincl.solve(SLIDE, scheme, t=TIMES)
    return np.linalg.norm(path.x - SLIDE.exact(TIMES), axis=-1).max()


@pytest.mark.parametrize("tol", [1e-2, 1e-4, 1e-7])
def test_springs_of_lsoda_give_way_by_tol(tol):
    path = dincl.solve(on_the_floor(), Lsoda(tol=tol), t=[1.0])
    assert path.final[0, 1] == pytest.approx(0.5 - tol, abs=0.02 * tol)
    assert path.final[0, 0] == pytest.approx(0.3, abs=tol)
    assert path.violation() == pytest.approx([tol], rel=0.02)


def test_lsoda_does_not_step_over_a_disc_and_gets_better_with_tol():
    errors = [error(Lsoda(tol=tol)) for tol in (1e-2, 1e-4, 1e-6)]
    assert errors[0] < 0.1
    assert errors[2] < errors[1] / 10 < errors[0] / 100
    assert errors[2] < 1e-5


def test_lsoda_solves_the_free_motion_to_its_own_tolerance():
    path = dincl.solve(a_scene([(1.0, 2.0)], attraction(0), []), Lsoda(tol=1e-6), t=[0.0, 0.37, 1.0])
    assert path.t.tolist() == [0.0, 0.37, 1.0]
    assert path.x[:, 0] == pytest.approx(np.exp(-path.t)[:, None] * (1.0, 2.0), abs=1e-6)


def test_lsoda_counts_its_work():
    calls = []

    def drift(t, x):
        calls.append(t)
        return -x

    problem = a_scene([(1.0, 0.5)], drift, [FLOOR])
    calls.clear()
    work = dincl.solve(problem, Lsoda(tol=1e-4), t=[1.0]).stats
    assert work.drift_evaluations == len(calls) - 1  # the speed at the start, which sets the strength
    assert 100 <= work.steps <= work.drift_evaluations
    assert work.solver_calls > 0


def test_jacobian_of_the_springs_is_their_derivative():
    from verification.beyond.chart.baselines import lsoda
    from verification.beyond.chart.baselines.kept import Kept

    problem = a_scene(
        [(0.0, 0.5), (1.0, 0.5)], constant(np.array([[1.0, -1.0], [-1.0, -1.0]])), [dincl.NonOverlap(0.5), FLOOR]
    )
    springs = lsoda._Springs(problem, 1e-5, 0.1, Kept(problem, np.array([1.0])))
    x = np.array([1e-5, 0.5 - 1e-5, 1.0, 0.5 - 2e-5])
    found, step = springs.jacobian(0.0, x), 1e-8
    differences = [(springs(0.0, x + step * e) - springs(0.0, x - step * e)) / (2 * step) for e in np.eye(4)]
    assert found == pytest.approx(np.array(differences).T, abs=2.0 + 1e-5 * np.abs(found).max())
    assert np.abs(found).max() > 1e4


@pytest.mark.parametrize("scheme", [Lsoda(tol=1e-3), Chipmunk(dt=0.01, iterations=10)])
def test_failures_end_a_run_with_their_status(scheme):
    def drift(t, x):
        if t > 0.5:
            raise ValueError("no more")
        return -x

    scene = a_scene([(1.0, 2.0)], drift, [FLOOR])
    path = dincl.solve(scene, scheme, t=[0.25, 1.0], throw=False)
    assert path.status is dincl.Status.DRIFT_FAILED
    assert "no more" in path.detail
    assert path.t.tolist() == [0.25]
    at_once = dincl.solve(scene, scheme, t=[1.0], throw=False)
    assert at_once.t.tolist() == [0.0]
    assert (at_once.final == scene.x0).all()


@pytest.mark.parametrize("scheme", [Lsoda(tol=1e-3), Chipmunk(dt=0.01, iterations=10), dincl.PBD(dt=0.01)])
def test_nobody_takes_a_spent_budget_for_an_error_of_its_own(scheme):
    with pytest.raises(OutOfBudgetError):
        dincl.solve(counted(SLIDE, DriftEvaluations(2))[0], scheme, t=[3.0], throw=False)
    patient = dincl.solve(counted(SLIDE, CpuSeconds(60.0))[0], scheme, t=[3.0])
    assert (patient.final == dincl.solve(SLIDE, scheme, t=[3.0]).final).all()


@pytest.mark.parametrize("scheme", [Lsoda(tol=1e-3), Chipmunk(dt=0.1, iterations=10)])
def test_each_step_of_an_external_program_counts_as_a_call_of_python(scheme):
    found = dincl.solve(SLIDE, scheme, t=[1.0]).stats
    assert found.callbacks == found.steps > 0


@pytest.mark.parametrize("scheme", [Lsoda(tol=1e-3), Chipmunk(dt=0.1, iterations=10)])
def test_kept_states_are_joined_by_straight_lines(scheme):
    path = dincl.solve(on_the_floor(), scheme, t=[0.0, 0.1, 0.4])
    assert path([0.0, 0.1, 0.4]) == pytest.approx(path.x, abs=1e-15)
    assert path(0.2) == pytest.approx((2 * path.x[1] + path.x[2]) / 3)
    assert np.isinf(path.normal_cone_residual()).all()


def test_chipmunk_makes_euler_steps_where_nothing_touches():
    path = dincl.solve(a_scene([(1.0, 2.0)], attraction(0), []), Chipmunk(dt=0.1, iterations=10), t=[0.3, 0.35, 1.0])
    at = [0.9**3, (0.9**3 + 0.9**4) / 2, 0.9**10]
    # t_end / dt steps end at 1, so 0.35 lies in the middle of the fourth.
    assert path.x[:, 0] == pytest.approx(np.array(at)[:, None] * (1.0, 2.0), rel=1e-12)
    assert path.stats.steps == 10
    assert path.stats.drift_evaluations == 11


def test_chipmunk_lets_discs_rest_and_slide_without_friction():
    h = 0.01
    path = dincl.solve(on_the_floor(), Chipmunk(dt=h, iterations=10), t=[0.5, 1.0])
    assert path.x[:, 0, 0] == pytest.approx([0.15, 0.3], abs=1e-12)
    assert np.abs(path.x[:, 0, 1] - 0.5).max() <= 2.0 * h


def test_chipmunk_converges_on_the_sliding_disc():
    errors = [error(Chipmunk(dt=dt, iterations=10)) for dt in (1e-2, 1e-3)]
    assert errors[0] < 0.02
    assert errors[1] < errors[0] / 5


@pytest.mark.slow
def test_chipmunk_converges_with_pairs_and_walls():
    for scene in (dincl.scenes.ten_disks_corner(), dincl.scenes.stack()):
        exact = dincl.solve(scene, dincl.LinearisedCatchUp(1e-3, dincl.Daqp(1e-10)), t=scene.times).x
        found = [dincl.solve(scene, Chipmunk(dt=dt, iterations=10), t=scene.times).x for dt in (1e-2, 1e-3)]
        coarse, fine = (np.linalg.norm(x - exact, axis=-1).max() for x in found)
        assert fine < 0.5 * coarse < 0.2


def test_discs_that_may_overlap_pass_each_other():
    scene = a_scene([(0.0, 0.6), (2.0, 0.6)], constant(np.array([[1.0, 0.0], [-1.0, 0.0]])), [FLOOR])
    path = dincl.solve(scene, Chipmunk(dt=0.1, iterations=10), t=[2.0])
    assert path.final == pytest.approx(np.array([(2.0, 0.6), (0.0, 0.6)]))


@pytest.mark.parametrize(
    "problem",
    [
        dincl.scenes.ball_pile(5),
        dincl.scenes.sweeping_interval(),
        dincl.Problem([(0.0, 1.0)], attraction(0)),
        a_scene([(0.0, 1.0)], attraction(0), [dincl.HalfSpace(normal=(0, 1), radius=0.4)]),
        a_scene([(0.0, 1.0)], attraction(0), [dincl.NonOverlap(0.4)]),
        a_scene([(0.0, 1.0)], attraction(0), [dincl.OutsideBall(centre=(0, 0), distance=0.5)]),
        a_scene([(0.0, 1.0)], attraction(0), [dincl.InsideBall(centre=(0, 0), distance=5.0)]),
    ],
)
def test_chipmunk_refuses_what_it_cannot_run(problem):
    with pytest.raises(dincl.InvalidProblem, match="Chipmunk"):
        dincl.solve(problem, Chipmunk(dt=0.1, iterations=10), t=[1.0])


def test_chipmunk_says_that_its_package_is_missing(monkeypatch):
    find = importlib.util.find_spec
    monkeypatch.setattr(chipmunk, "find_spec", lambda name: None if name == "pymunk" else find(name))
    with pytest.raises(dincl.InvalidProblem, match="pymunk"):
        dincl.solve(SLIDE, Chipmunk(dt=0.1, iterations=10), t=[1.0])


@pytest.mark.parametrize("scheme", [Lsoda(tol=1e-3), Chipmunk(dt=0.1, iterations=10)])
def test_a_run_to_the_start_is_the_start(scheme):
    path = dincl.solve(SLIDE, scheme, t=[0.0])
    assert path.status
    assert (path.x == SLIDE.x0).all()
    assert (path(0.0) == SLIDE.x0).all()


@pytest.mark.parametrize("make", [lambda: Lsoda(tol=0.0), lambda: Chipmunk(0.0, 1), lambda: Chipmunk(0.1, 0)])
def test_settings_are_checked(make):
    with pytest.raises(dincl.InvalidProblem):
        make()
