"""XPBD of first order: its limit of many sweeps, its compliance, and the method typed from its formula."""

import numpy as np
import pytest

import dincl
from tests.dincl.catalog import SCENES

DT = 0.02
WALLS = [dincl.HalfSpace(normal=(0, 1), radius=0.5), dincl.HalfSpace(normal=(1, 0), radius=0.5)]


def literal_step(problem, dt, sweeps, compliance):
    """Make one step with the formula of the docstring, over all rows of the problem in their order."""
    x = problem.x0 + dt * problem.velocity(0.0, problem.x0)
    multiplier = np.zeros(problem.rows_within(dt, x, np.inf).values(x).size)
    for _ in range(sweeps):
        for r in range(len(multiplier)):
            rows = problem.rows_within(dt, x, np.inf)
            gradient = rows.jacobian(x).toarray()[r]
            change = -(rows.values(x)[r] + compliance / dt * multiplier[r]) / (gradient @ gradient + compliance / dt)
            change = max(change, -multiplier[r])
            multiplier[r] += change
            x = x + change * gradient.reshape(x.shape)
    return x


@pytest.mark.parametrize("compliance", [0.0, 0.05])
@pytest.mark.parametrize("sweeps", [1, 3])
def test_it_is_the_formula(rng, sweeps, compliance):
    lattice = np.stack(np.unravel_index(np.arange(9), (3, 3)), axis=1)
    x0 = 1.06 * lattice + rng.uniform(-0.02, 0.02, (9, 2)) + 0.53
    rope = dincl.MaxDistance([(0, 8), (2, 6)], 3.1)
    problem = dincl.Problem(x0, lambda t, x: 3 * (1 - x), [dincl.NonOverlap(0.5), *WALLS, rope])
    found = dincl.solve(problem, dincl.XPBD(DT, sweeps, compliance), t=DT).final
    expected = literal_step(problem, DT, sweeps, compliance)
    assert np.abs(expected - problem.x0).max() > 0.02
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-14)


@pytest.mark.parametrize("scene", SCENES, ids=lambda scene: scene.name)
@pytest.mark.parametrize("dt", [0.1, 0.02])
def test_one_sweep_is_a_step_of_pbd(scene, dt):
    """Also where sets turn, close and grow, and push particles that no drift moves."""
    one, other = (dincl.solve(scene, make(dt), t=scene.times).x for make in (dincl.XPBD, dincl.PBD))
    np.testing.assert_allclose(one, other, rtol=0, atol=1e-12)


def test_many_sweeps_find_the_nearest_point_where_those_of_pbd_find_another():
    """(0.5, -2) violates x + y >= 0 and y >= 0; PBD moves it to (1.25, -1.25) and stops at (1.25, 0)."""
    walls = [dincl.HalfSpace(normal=(1, 1)), dincl.HalfSpace(normal=(0, 1))]
    problem = dincl.Problem([[1.0, 0.0]], dincl.drifts.constant((-0.5, -2.0)), walls)
    found = {one: dincl.solve(problem, one(1.0, sweeps=200), t=1.0).final for one in (dincl.XPBD, dincl.PBD)}
    np.testing.assert_allclose(found[dincl.XPBD], [[0.5, 0.0]], rtol=0, atol=1e-12)
    np.testing.assert_allclose(found[dincl.PBD], [[1.25, 0.0]], rtol=0, atol=1e-12)


@pytest.mark.parametrize("compliance", [0.01, 0.3])
def test_compliance_is_the_implicit_euler_method_for_a_spring(compliance):
    """x' = -1 + max(0, -x) / c: with s = dt/c each step takes x < 0 to (x - dt) / (1 + s)."""
    fall = dincl.Problem([[0.0]], dincl.drifts.constant((-1.0,)), [dincl.HalfSpace(normal=(1,))])
    path = dincl.solve(fall, dincl.XPBD(DT, compliance=compliance), t=[DT, 2 * DT, 50.0])
    s = DT / compliance
    first = -DT / (1 + s)
    np.testing.assert_allclose(path.x[:, 0, 0], [first, (first - DT) / (1 + s), -compliance], rtol=0, atol=1e-12)


def test_a_stiff_spring_is_stable_where_the_explicit_penalty_is_not():
    problem = dincl.scenes.pile(10)
    soft = dincl.solve(problem, dincl.XPBD(DT, sweeps=20, compliance=1e-4), t=1.0)
    stiff = dincl.solve(problem, dincl.Penalty(DT, strength=1e4), t=1.0, throw=False)
    assert soft.violation().max() < 0.01
    assert not stiff.status or stiff.violation().max() > 0.5 or np.abs(stiff.final).max() > 100


def test_many_discs_are_as_few(rng):
    """The rows near 300 discs come from a search; the same discs five times, far apart, move alike."""
    few = dincl.scenes.pile(60)
    x0 = np.vstack([few.x0 + np.array([k * 1e3, 0.0]) for k in range(5)])
    drift = few.velocity(0.0, few.x0)
    alone = dincl.Problem(few.x0, dincl.drifts.constant(drift), [dincl.NonOverlap(few.radius)])
    together = dincl.Problem(
        x0, dincl.drifts.constant(np.vstack([drift] * 5)), [dincl.NonOverlap(np.tile(few.radius, 5))]
    )
    one, five = (dincl.solve(p, dincl.XPBD(DT, sweeps=3), t=0.2).final for p in (alone, together))
    assert np.abs(one - few.x0).max() > 0.05
    for k in range(5):
        np.testing.assert_allclose(five[60 * k : 60 * (k + 1)] - np.array([k * 1e3, 0.0]), one, rtol=0, atol=1e-9)


@pytest.mark.slow
def test_sets_that_move_and_rows_that_only_python_knows():
    ellipse = dincl.Smooth(lambda x: 1 - (x[:, 0] / 2) ** 2 - x[:, 1] ** 2)
    wall = dincl.Moving(dincl.HalfSpace(normal=(1, 0)), lambda t: np.array([t, 0.0]))
    problem = dincl.Problem([[0.0, 0.0]], dincl.drifts.constant((0.0, 2.0)), [ellipse, wall])
    found = dincl.solve(problem, dincl.XPBD(1e-2, sweeps=40), t=[1.0])
    nearest = dincl.solve(problem, dincl.CatchUp(1e-2, dincl.ActiveSet(1e-10)), t=[1.0])
    assert found.violation()[0] < 1e-6
    assert np.abs(found.final - nearest.final).max() < 1e-3


def test_coincident_centres_have_no_direction():
    problem = dincl.Problem(
        [[0.0, 0.0], [1.0, 0.0]], lambda t, x: np.array([[0.5, 0.0], [-0.5, 0.0]]), [dincl.NonOverlap(0.4)]
    )
    path = dincl.solve(problem, dincl.XPBD(1.0), t=1.0, throw=False)
    assert path.status is dincl.Status.COINCIDENT_CENTRES
