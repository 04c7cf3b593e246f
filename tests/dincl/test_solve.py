"""The run: times, steps, output, and the residuals of its result."""

import numpy as np
import pytest

import dincl
from dincl.steps.grid import TimeGrid, divide_time


def decay(x0=((1.0, -2.0),), constraints=()):
    return dincl.Problem(x0, lambda t, x: -x, constraints)


def test_euler_without_constraints():
    path = dincl.solve(decay(), dincl.PBD(0.1), t=[0.5, 1.0])
    assert path.t.tolist() == [0.5, 1.0]
    assert path.x.shape == (2, 1, 2)
    assert path.final.tolist() == path.x[-1].tolist()
    assert path.x[:, 0, 0] == pytest.approx([0.9**5, 0.9**10])
    assert path.status is dincl.Status.SUCCESS
    assert path.detail == ""
    assert path.violation().tolist() == [0.0, 0.0]
    assert path.stats.degrees_of_freedom == 2
    assert path.stats.drift_evaluations == path.stats.steps == 10


def test_kept_times_do_not_change_the_steps():
    few = dincl.solve(decay(), dincl.PBD(0.1), t=[1.0])
    many = dincl.solve(decay(), dincl.PBD(0.1), t=[0.0, 0.123, 0.3, 0.777, 1.0])
    assert many.final.tolist() == few.final.tolist()
    assert many.stats.steps == few.stats.steps


def test_between_two_steps_on_the_straight_line():
    path = dincl.solve(decay(), dincl.PBD(0.1), t=[0.0, 0.25, 0.3, 1.0])
    ends = 0.9 ** np.array([2, 3])
    assert path.x[:, 0, 0] == pytest.approx([1.0, ends.mean(), ends[1], 0.9**10])
    assert path(0.25) == pytest.approx(path.x[1], abs=1e-15)


def test_the_path_is_piecewise_linear_between_steps_that_were_not_kept():
    every = dincl.solve(decay(), dincl.PBD(0.1), t=np.arange(0, 11) / 10)
    last = dincl.solve(decay(), dincl.PBD(0.1), t=[0.7, 1.0])
    times = np.array([[0.0, 0.05, 1.0], [0.61, 0.7, 0.33]])
    assert last(times).shape == (2, 3, 1, 2)
    linear = np.interp(times, every.t, every.x[:, 0, 1])
    assert last(times)[..., 0, 1] == pytest.approx(linear, abs=1e-15)
    assert last(0.4).shape == (1, 2)


def test_the_path_of_a_second_order_run_knows_its_velocity():
    fall = dincl.Problem([[0.0]], lambda t, x: np.full_like(x, -1.0))
    path = dincl.solve(fall, dincl.SecondOrderPBD(0.1), t=[0.5, 1.0])
    assert path(0.7)[0, 0] == pytest.approx(-0.01 * 7 * 8 / 2)


@pytest.mark.parametrize(
    ("t_end", "dt", "steps"),
    [(1.0, 0.1, 10), (1.0, 0.3, 4), (3.0, 1e-3, 3000), (0.7, 0.1, 7), (1.0, 5.0, 1), (0.0, 0.1, 0)],
)
def test_equal_steps_no_longer_than_dt(t_end, dt, steps):
    made = divide_time(t_end, dt)
    assert made.steps == steps
    assert made.h <= dt * (1 + 1e-12)
    assert made.time(steps) == t_end


def test_grid_times_come_from_their_number():
    made = TimeGrid(0.7, 7)
    assert [int(k) for k in made.before(np.array([made.time(k) for k in range(1, 8)]))] == list(range(7))
    assert made.before(0.0) == 0
    assert made.before(0.05) == 0
    assert made.before(0.15) == 1


def test_only_the_start():
    path = dincl.solve(decay(), dincl.PBD(0.1), t=[0.0])
    assert path.x.tolist() == [[[1.0, -2.0]]]
    assert path(0.0).tolist() == [[1.0, -2.0]]


def test_a_start_in_contact_up_to_decimal_digits_is_accepted():
    discs = dincl.Problem([[0.1 + 0.2], [1.3]], lambda t, x: -x, [dincl.NonOverlap(0.5)])
    assert dincl.solve(discs, dincl.PBD(0.1), t=[1.0]).status


@pytest.mark.parametrize(("overlap", "accepted"), [(1e-10, True), (3e-9, False), (1e-6, False)])
def test_what_a_start_may_miss(overlap, accepted):
    """Up to 1e-9 of the largest coordinate, here 1."""
    x0 = [[0.0], [1.0 - overlap]]
    if accepted:
        dincl.Problem(x0, lambda t, x: -x, [dincl.NonOverlap(0.5)])
        return
    with pytest.raises(dincl.InvalidProblem, match="x0 violates NonOverlap"):
        dincl.Problem(x0, lambda t, x: -x, [dincl.NonOverlap(0.5)])


def test_catch_up_proves_its_velocity():
    """Two discs pressed together on a wall: the velocity differs from the drift by a normal vector only."""
    problem = dincl.Problem(
        [[0.0, 0.5], [0.7, 1.4]],
        lambda t, x: np.array([[0.0, -1.0], [-0.3, -1.0]]),
        [dincl.NonOverlap(0.5), dincl.HalfSpace((0, 1), radius=0.5)],
    )
    times = [0.0, 0.2, 0.4]
    catch_up = dincl.solve(problem, dincl.CatchUp(0.01, dincl.Daqp(1e-12)), t=times)
    pbd = dincl.solve(problem, dincl.PBD(0.01), t=times)
    assert catch_up.normal_cone_residual()[0] == np.inf
    assert (catch_up.normal_cone_residual()[1:] < 1e-9).all()
    assert (pbd.normal_cone_residual()[1:] > 1e-4).all()
    assert (catch_up.violation() < 1e-12).all()


def test_a_failed_run_says_when_and_what_to_try():
    blow_up = dincl.Problem([[1.0]], lambda t, x: x**3)
    with pytest.raises(dincl.StepFailed, match=r"smaller dt.*step from t = ") as caught:
        dincl.solve(blow_up, dincl.PBD(1.0), t=[100.0])
    path = caught.value.trajectory
    assert path.status is dincl.Status.DRIFT_FAILED
    assert np.isfinite(path.x).all()
    assert path.t[-1] == path.stats.steps


def test_what_is_not_defined_is_infinite():
    fall = dincl.Problem([[0.0]], lambda t, x: np.full_like(x, -1.0))
    assert dincl.solve(fall, dincl.SecondOrderPBD(0.1), t=[0.5]).normal_cone_residual().tolist() == [np.inf]
    late = dincl.Smooth(lambda x: np.array([1.0 if x[0, 0] > -0.95 else np.nan]), lambda x: np.zeros((1, 1)))
    path = dincl.solve(dincl.Problem([[0.0]], fall.drift, [late]), dincl.PBD(0.1), t=[0.9, 1.0], throw=False)
    assert path.status is dincl.Status.CONSTRAINT_FAILED
    assert fall.violation(0.0, fall.x0) == 0.0
    assert path.problem.violation(1.0, np.array([[-1.0]])) == np.inf


def test_reprs_are_short():
    scene = dincl.scenes.pile(500)
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
