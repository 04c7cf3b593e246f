"""Catch-up with the linearisation in the middle of the step: one step by hand, order 2, what costs it."""

import math

import numpy as np
import pytest

import dincl
from dincl import MidpointCatchUp, ProjectedCG, scenes

DAQP = dincl.Daqp(1e-12)
# Not a divisor of any event time.
STEPS = [1.37 * 2.0**-k for k in range(3, 9)]


def distance(x, y):
    return float(np.sqrt(((x - y) ** 2).sum(axis=-1)).max())


def order(errors):
    return np.polyfit(np.log(STEPS), np.log(errors), 1)[0]


def errors_of(problem, exact, t_end):
    return [distance(dincl.solve(problem, MidpointCatchUp(dt, DAQP), t=[t_end]).final, exact) for dt in STEPS]


def test_one_step_on_an_obstacle_is_the_formula():
    h, drift = 0.3, np.array([1.0, -1.0])
    problem = dincl.Problem([[0.0, 1.0]], lambda t, x: drift[None], [dincl.OutsideBall((0, 0), 1.0)])
    middle = np.array([h / 2, 1.0])  # of the start and of (h, 1), where the tangent at the start stops the fall
    normal = middle / math.hypot(*middle)
    target = np.array([0.0, 1.0]) + h * drift
    expected = target + (1.0 - normal @ target) * normal
    final = dincl.solve(problem, MidpointCatchUp(h, DAQP), t=[h]).final
    assert distance(final, expected) < 1e-12


def test_without_contacts_it_is_the_midpoint_rule():
    problem = dincl.Problem([[2.0, 1.0]], lambda t, x: t - 3 * x)
    h, x, t = 0.25, np.array([2.0, 1.0]), 0.0
    for _ in range(4):
        middle = x + h / 2 * (t - 3 * x)
        x, t = x + h * (t + h / 2 - 3 * middle), t + h
    run = dincl.solve(problem, MidpointCatchUp(h, DAQP), t=[1.0])
    assert distance(run.final, x) < 1e-14
    assert run.stats.solver_calls == 0
    assert run.stats.drift_evaluations == 2 * run.stats.steps


@pytest.mark.parametrize("scene", [scenes.sliding_disc(), scenes.two_disks()], ids=lambda scene: scene.name)
def test_order_two_through_contact_and_release(scene):
    t_end = scene.times[-1]
    errors = errors_of(scene, scene.exact(t_end), t_end)
    assert 1.8 < order(errors) < 2.3
    assert errors[-1] < 2e-5


def test_order_two_on_ten_discs_against_the_events():
    scene = scenes.ten_disks_corner()
    errors = errors_of(scene, dincl.solve(scene, dincl.EventDriven(1e-8), t=[1.0]).final, 1.0)
    assert 1.8 < order(errors) < 2.3
    assert errors[-1] < 2e-6


def test_order_two_in_a_set_that_moves():
    """In the frame of the container the same motion has the drift less its velocity, and nothing moves."""

    def path(t):
        return math.sin(2 * t), 0.5 * t * t

    def wind(t):
        return np.array([[-2 * math.cos(2 * t), -1.0 - t]])

    start, container = np.array([[0.3, -0.2]]), dincl.InsideBall((0, 0), 1.0)
    moving = dincl.Problem(start, lambda t, x: np.array([[0.0, -1.0]]), [dincl.Moving(container, path)])
    resting = dincl.Problem(start, lambda t, x: wind(t), [container])
    exact = dincl.solve(resting, dincl.EventDriven(1e-9), t=[1.5]).final + path(1.5)
    errors = errors_of(moving, exact, 1.5)
    assert 1.8 < order(errors) < 2.3
    run = dincl.solve(moving, MidpointCatchUp(STEPS[0], DAQP), t=[0.5, 1.0, 1.5])
    assert run.violation()[-1] > 0  # a container is not convex in g: the linearisation lies outside ...
    assert run.violation()[-1] < STEPS[0] ** 2  # ... by the square of the step


def test_a_wall_that_comes_from_afar_within_a_step_is_seen():
    wall = dincl.Moving(dincl.HalfSpace((1,)), lambda t: (t - 1.0,))
    problem = dincl.Problem([[0.0]], lambda t, x: 0 * x, [wall])
    final = dincl.solve(problem, MidpointCatchUp(1.1, DAQP), t=[1.1]).final
    assert final[0, 0] == pytest.approx(0.1, abs=1e-12)


@pytest.mark.parametrize("x", [0.6, 0.95, 0.999])
def test_a_wall_that_comes_after_the_middle_of_a_step_is_seen(x):
    wall = dincl.Moving(dincl.HalfSpace((1,)), lambda t: (t,))
    problem = dincl.Problem([[x]], lambda t, x: 0 * x, [wall])
    final = dincl.solve(problem, MidpointCatchUp(1.0, DAQP), t=[1.0]).final
    assert final[0, 0] == pytest.approx(1.0, abs=1e-12)


def test_a_contact_that_ends_another_one_costs_order_one():
    """A point slides on the floor onto a ramp: a step across the foot forgets the floor's push before it.

    That is delta * 0.2 upwards, for the time delta of the step before the foot; the ramp lets 1/sqrt(5) of it count.
    """
    foot, slope, press = 0.7371, np.array([-2.0, 1.0]) / math.sqrt(5), 0.2
    walls = [dincl.HalfSpace((0, 1)), dincl.HalfSpace((1, 2))]
    problem = dincl.Problem([[foot, 0.0]], lambda t, x: np.array([[-1.0, -press]]), walls)
    exact = (1.5 - foot) * (slope @ [-1.0, -press]) * slope
    for dt in (0.1, 0.05, 0.025):
        delta = foot - math.floor(foot / dt) * dt
        final = dincl.solve(problem, MidpointCatchUp(dt, DAQP), t=[1.5]).final
        assert distance(final, exact) == pytest.approx(delta * press / math.sqrt(5), rel=1e-6)


@pytest.mark.parametrize("dt", [0.1, 0.5, 2.0])
def test_long_steps_stay_feasible(dt):
    scene = scenes.pile(30)
    run = dincl.solve(scene, MidpointCatchUp(dt, DAQP), t=[2.0, 10.0])
    assert run.violation().max() <= 1e-11
    assert np.abs(run.x).max() < 12


def test_the_coarse_prediction_costs_no_accuracy():
    scene = scenes.ten_disks_corner()
    exact = dincl.solve(scene, MidpointCatchUp(0.02, DAQP), t=[2.0]).final
    coarse = dincl.solve(scene, MidpointCatchUp(0.02, ProjectedCG(1e-8)), t=[2.0]).final
    assert 0 < distance(coarse, exact) < 1e-6


def test_every_family_is_served():
    chain = [[0.0, 0.0], [0.9, 0.1], [1.8, -0.1]]
    families = [
        dincl.NonOverlap(0.4),
        dincl.MaxDistance([(0, 1), (1, 2)], 1.1),
        dincl.Ordered([0, 1, 2], axis=0),
        dincl.InsideBall((0, 0), 3.0),
        dincl.Smooth(lambda x: [x[0, 1] + 1.0], lambda x: np.array([[0, 1, 0, 0, 0, 0]])),
    ]
    problem = dincl.Problem(chain, lambda t, x: np.array([[-0.5, -1.0], [1.0, 0.0], [1.0, -0.3]]), families)
    fine = dincl.solve(problem, MidpointCatchUp(0.005, DAQP), t=[1.5]).final
    errors = [
        distance(dincl.solve(problem, MidpointCatchUp(dt, ProjectedCG(1e-10)), t=[1.5]).final, fine)
        for dt in (0.08, 0.02)
    ]
    assert errors[1] < errors[0] / 10
    assert errors[1] < 1e-5


def test_projection_must_be_one():
    with pytest.raises(dincl.InvalidProblem, match="projection = 'daqp'"):
        MidpointCatchUp(0.1, "daqp")
