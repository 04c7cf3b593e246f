"""External programs solve the problem that they are given, or say that they cannot."""

import numpy as np
import pytest

import dincl
from dincl.drifts import attraction, constant
from dincl.scenes import Scene
from verification.instruments.budget import CpuSeconds, DriftEvaluations, OutOfBudgetError, counted
from verification.methods.chart.chipmunk import chipmunk
from verification.methods.chart.lsoda import Springs, lsoda

SLIDE = dincl.scenes.sliding_disc()
TIMES = np.arange(1, 61) * 0.05
FLOOR = dincl.HalfSpace(normal=(0, 1), radius=0.5)
BOTH = pytest.mark.parametrize(("run", "setting"), [(lsoda, 1e-3), (chipmunk, 0.01)])


def a_scene(x0, drift, constraints, radius=0.5):
    return Scene(x0, drift, constraints, name="", title="", times=(1.0,), radius=radius)


def on_the_floor(speed=2.0):
    return a_scene([(0.0, 0.75)], constant(np.array([[0.3, -speed]])), [FLOOR])


def error(run, setting):
    return np.linalg.norm(run(SLIDE, setting, TIMES) - SLIDE.exact(TIMES), axis=-1).max()


@pytest.mark.parametrize("tol", [1e-2, 1e-4, 1e-7])
def test_springs_of_lsoda_give_way_by_tol(tol):
    (x,) = lsoda(on_the_floor(), tol, np.array([1.0]))
    assert x[0, 1] == pytest.approx(0.5 - tol, abs=0.02 * tol)
    assert x[0, 0] == pytest.approx(0.3, abs=tol)


def test_lsoda_does_not_step_over_a_disc_and_gets_better_with_tol():
    errors = [error(lsoda, tol) for tol in (1e-2, 1e-4, 1e-6)]
    assert errors[0] < 0.1
    assert errors[2] < errors[1] / 10 < errors[0] / 100
    assert errors[2] < 1e-5


def test_lsoda_solves_the_free_motion_to_its_own_tolerance():
    t = np.array([0.0, 0.37, 1.0])
    x = lsoda(a_scene([(1.0, 2.0)], attraction(0), []), 1e-6, t)
    assert x[:, 0] == pytest.approx(np.exp(-t)[:, None] * (1.0, 2.0), abs=1e-6)


def test_jacobian_of_the_springs_is_their_derivative():
    drift = constant(np.array([[1.0, -1.0], [-1.0, -1.0]]))
    springs = Springs(a_scene([(0.0, 0.5), (1.0, 0.5)], drift, [dincl.NonOverlap(0.5), FLOOR]), 1e-5, 0.1)
    x = np.array([1e-5, 0.5 - 1e-5, 1.0, 0.5 - 2e-5])
    found, step = springs.jacobian(0.0, x), 1e-8
    differences = [(springs(0.0, x + step * e) - springs(0.0, x - step * e)) / (2 * step) for e in np.eye(4)]
    assert found == pytest.approx(np.array(differences).T, abs=2.0 + 1e-5 * np.abs(found).max())
    assert np.abs(found).max() > 1e4


@BOTH
def test_nobody_takes_a_spent_budget_for_an_error_of_its_own(run, setting):
    with pytest.raises(OutOfBudgetError):
        run(counted(SLIDE, DriftEvaluations(2))[0], setting, np.array([3.0]))
    patient = run(counted(SLIDE, CpuSeconds(60.0))[0], setting, np.array([3.0]))
    assert (patient == run(SLIDE, setting, np.array([3.0]))).all()


@BOTH
def test_what_a_drift_raises_ends_the_run(run, setting):
    def drift(t, x):
        if t > 0.5:
            raise ValueError("no more")
        return -x

    with pytest.raises(Exception, match="no more"):
        run(a_scene([(1.0, 2.0)], drift, [FLOOR]), setting, np.array([1.0]))


def test_chipmunk_makes_euler_steps_where_nothing_touches():
    x = chipmunk(a_scene([(1.0, 2.0)], attraction(0), []), 0.1, np.array([0.0, 0.3, 0.35, 1.0]))
    at = [1.0, 0.9**3, (0.9**3 + 0.9**4) / 2, 0.9**10]
    # t_end / dt steps end at 1, so 0.35 lies in the middle of the fourth.
    assert x[:, 0] == pytest.approx(np.array(at)[:, None] * (1.0, 2.0), rel=1e-12)


def test_chipmunk_lets_discs_rest_and_slide_without_friction():
    x = chipmunk(on_the_floor(), 0.01, np.array([0.5, 1.0]))
    assert x[:, 0, 0] == pytest.approx([0.15, 0.3], abs=1e-12)
    assert np.abs(x[:, 0, 1] - 0.5).max() <= 2.0 * 0.01


def test_chipmunk_converges_on_the_sliding_disc():
    errors = [error(chipmunk, dt) for dt in (1e-2, 1e-3)]
    assert errors[0] < 0.02
    assert errors[1] < errors[0] / 5


@pytest.mark.slow
def test_chipmunk_converges_with_pairs_and_walls():
    for scene in (dincl.scenes.ten_disks_corner(), dincl.scenes.stack()):
        t = np.array(scene.times)
        exact = dincl.solve(scene, dincl.LinearisedCatchUp(1e-3, dincl.Daqp(1e-10)), t=t).x
        coarse, fine = (np.linalg.norm(chipmunk(scene, dt, t) - exact, axis=-1).max() for dt in (1e-2, 1e-3))
        assert fine < 0.5 * coarse < 0.2


def test_discs_that_may_overlap_pass_each_other():
    scene = a_scene([(0.0, 0.6), (2.0, 0.6)], constant(np.array([[1.0, 0.0], [-1.0, 0.0]])), [FLOOR])
    assert chipmunk(scene, 0.1, np.array([2.0]))[0] == pytest.approx(np.array([(2.0, 0.6), (0.0, 0.6)]))


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
        chipmunk(problem, 0.1, np.array([1.0]))
