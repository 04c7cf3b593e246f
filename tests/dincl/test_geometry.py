"""Normal cones, tangent velocities and support functions against closed forms and independent solvers."""

import math

import numpy as np
import pytest
from scipy.optimize import nnls

import dincl
from dincl.geometry import normal_cone, support, tangent_velocity
from dincl.status import Status

TOL = 1e-9
TRIANGLE = np.array([[0.0, 0.0], [1.0, 0.0], [0.5, math.sqrt(0.75)]])
PAIR = np.array([[0.0, 0.0], [1.0, 0.0]])
STEEP = dincl.Smooth(lambda x: np.array([10 * x[0, 0]]), lambda x: np.array([[10.0]]))


def still(t, x):
    return 0 * x


def discs(x, drift=still, *more):
    return dincl.Problem(x, drift, [dincl.NonOverlap(0.5), *more])


def cone_of(x, *more):
    return normal_cone(discs(x, still, *more), 0.0, x, TOL)


def test_cone_of_two_discs_and_of_none():
    """Outward means closer together: N = {c (1, -1)} for c >= 0 along the line of centres."""
    cone, together = cone_of(PAIR), np.array([[3.0, 0.0], [-3.0, 0.0]])
    assert cone.names == ((0, "particle 1 and 0"),)
    assert cone.generators.tolist() == [[[-1.0, 0.0], [1.0, 0.0]]]
    assert cone.multipliers(together) == pytest.approx([3.0])
    assert [cone.contains(u) for u in (together, -together, 0 * together)] == [True, False, True]
    assert cone.distance(-together) == pytest.approx(3 * math.sqrt(2))
    inside = cone_of(2 * PAIR)
    assert inside.generators.shape == (0, 2, 2)
    assert inside.distance([[3.0, 0.0], [0.0, 4.0]]) == pytest.approx(5.0)
    assert inside.inverse_triangle() == 1.0
    assert support(discs(2 * PAIR), 0.0, 2 * PAIR, np.ones((2, 2)), TOL) == 0.0


def test_only_active_rows_of_several_families_are_named():
    walls = dincl.HalfSpace(normal=(0, 1), radius=0.5), dincl.MaxDistance([[0, 2], [1, 2]], [4.0, 9.0])
    cone = cone_of([[0.0, 0.5], [1.0, 0.7], [4.0, 0.5]], *walls)
    assert cone.names == ((1, "particle 0"), (1, "particle 2"), (2, "particle 0 and 2"))
    assert cone.generators[2].tolist() == [[1.0, 0.0], [0.0, 0.0], [-1.0, 0.0]]


def test_moreau_decomposition_against_non_negative_least_squares(rng):
    cone = cone_of(TRIANGLE)
    rows = cone.generators.reshape(3, 6)
    for u in rng.normal(size=(20, 3, 2)):
        weights, rest = nnls(-rows.T, u.ravel())
        assert cone.distance(u) == pytest.approx(rest, abs=1e-8)
        assert cone.multipliers(u) == pytest.approx(weights, abs=1e-8)
        normal, tangent = cone.normal_part(u), cone.tangent_part(u)
        assert normal + tangent == pytest.approx(u)
        assert float((normal * tangent).sum()) == pytest.approx(0.0, abs=1e-8)
        assert (rows @ tangent.ravel()).min() > -1e-8
        assert cone.contains(normal)


def test_inverse_triangle():
    """Of a row the dual v = x sqrt(2)/L gives gamma = sqrt(6/(N (N^2 - 1))); gradients that cancel give 0."""
    for count in (2, 3, 5, 9):
        gamma = cone_of(np.arange(count)[:, None] * np.array([0.6, 0.8])).inverse_triangle()
        assert gamma == pytest.approx(math.sqrt(6 / (count * (count**2 - 1))), rel=1e-8)
    walls = [dincl.HalfSpace(normal=(1,)), dincl.HalfSpace(normal=(-1,))]
    assert normal_cone(dincl.Problem([[0.0]], still, walls), 0.0, [[0.0]], TOL).inverse_triangle() == 0.0


def test_support_is_the_supremum(rng):
    problem = discs(TRIANGLE)
    reactions = np.tensordot(rng.exponential(size=(4000, 3)), cone_of(TRIANGLE).generators, 1)
    reactions *= 2.0 / np.sqrt((reactions**2).sum(axis=(1, 2)))[:, None, None]
    for w in rng.normal(size=(20, 3, 2)):
        seen = max(0.0, float((reactions * w).sum(axis=(1, 2)).max()))
        exact = support(problem, 0.0, TRIANGLE, w, TOL, radius=2.0)
        assert seen <= exact + 1e-9
        assert exact <= seen + 0.05 * np.linalg.norm(w)
        assert support(problem, 0.0, TRIANGLE, w, TOL) == (math.inf if exact > 1e-6 else 0.0)


RISING = dincl.Moving(dincl.HalfSpace(normal=(0, 2)), lambda t: (5 * t, math.sin(t)))
FALLING = dincl.Problem([[0.0, 0.0]], lambda t, x: np.array([[1.0, -1.0]]), [RISING])


@pytest.mark.parametrize(
    ("problem", "t", "x", "u", "velocity", "multipliers"),
    [
        # Of two discs the closing speed is shared and vanishes; the rest of the drift stays.
        (discs(PAIR), 0.0, PAIR, [[2.0, 1.0], [-1.0, 3.0]], [[0.5, 1.0], [0.5, 3.0]], [1.5]),
        (discs(PAIR), 0.0, PAIR, [[-2.0, -1.0], [1.0, -3.0]], [[-2.0, -1.0], [1.0, -3.0]], [0.0]),
        # A wall that rises lifts.
        (FALLING, 0.0, [[0.0, 0.0]], None, [[1.0, 1.0]], [2.0]),
        (FALLING, 0.5, [[0.0, math.sin(0.5)]], None, [[1.0, math.cos(0.5)]], [1 + math.cos(0.5)]),
        (FALLING, 0.5, [[0.0, math.sin(0.5)]], [[0.0, 0.0]], [[0.0, math.cos(0.5)]], [math.cos(0.5)]),
        # Multipliers belong to g and not to unit gradients.
        (dincl.Problem([[0.0]], still, [STEEP]), 0.0, [[0.0]], [[-3.0]], [[0.0]], [0.3]),
    ],
)
def test_tangent_velocities(problem, t, x, u, velocity, multipliers):
    found = tangent_velocity(problem, t, x, u, tol=TOL)
    assert found.velocity == pytest.approx(np.array(velocity))
    assert found.multipliers == pytest.approx(multipliers)


def test_tangent_velocity_belongs_to_the_inclusion(rng):
    """v in T, F - v in N, and (F - v).v = 0, with redundant contacts and more unknowns than the dense solver takes."""
    steps = np.arange(-3, 4)
    places = np.array([[i + j / 2, j * math.sqrt(0.75)] for i in steps for j in steps])
    cone = cone_of(places)
    assert len(cone.names) > 98
    drift = -places + 0.3 * rng.normal(size=places.shape)
    found = tangent_velocity(discs(places), 0.0, places, drift, tol=TOL)
    assert float(np.tensordot(cone.generators, found.velocity, 2).min()) > -1e-8
    assert float(((drift - found.velocity) * found.velocity).sum()) == pytest.approx(0.0, abs=1e-7)
    assert drift + np.tensordot(found.multipliers, cone.generators, 1) == pytest.approx(found.velocity, abs=1e-8)
    assert found.multipliers.min() >= 0
    assert found.residual < 1e-8


def test_tolerance_is_a_distance():
    problem = dincl.Problem([[0.0]], still, [STEEP])
    assert [len(normal_cone(problem, 0.0, [[x]], 1e-3).names) for x in (0.9e-3, 1.1e-3)] == [1, 0]
    with pytest.raises(dincl.InvalidProblem, match="outside of S"):
        normal_cone(problem, 0.0, [[-1.1e-3]], 1e-3)


@pytest.mark.parametrize(
    ("call", "match"),
    [
        (lambda p, x: normal_cone("p", 0.0, x, TOL), "problem = "),
        (lambda p, x: normal_cone(p, -1.0, x, TOL), "t = "),
        (lambda p, x: normal_cone(p, 0.0, x[:1], TOL), r"x = .*of shape \(3, 2\)"),
        (lambda p, x: normal_cone(p, 0.0, x, 0.0), "tol = "),
        (lambda p, x: normal_cone(p, 0.0, x, TOL).contains(np.full_like(x, np.inf)), "u = "),
        (lambda p, x: support(p, 0.0, x, x[0], TOL), "direction = .*of shape"),
        (lambda p, x: support(p, 0.0, x, x, TOL, radius=0.0), "radius = "),
        (lambda p, x: tangent_velocity(p, 0.0, 0.9 * x, tol=TOL), "outside of S"),
        (lambda p, x: tangent_velocity(p, 0.0, x, x[0], tol=TOL), "u = .*of shape"),
        (lambda p, x: tangent_velocity(p, 0.0, x, tol=TOL, spacing=0.0), "spacing = "),
    ],
)
def test_bad_input(call, match):
    with pytest.raises(dincl.InvalidProblem, match=match):
        call(discs(TRIANGLE), TRIANGLE)


CLOSING = [dincl.Moving(dincl.HalfSpace(normal=(s,)), lambda t, s=s: (s * t,)) for s in (1, -1)]


@pytest.mark.parametrize(
    ("call", "status"),
    [
        (lambda p: tangent_velocity(p, 1.0, TRIANGLE, tol=TOL), Status.DRIFT_FAILED),
        (lambda p: tangent_velocity(dincl.Problem([[0.0]], still, CLOSING), 0.0, [[0.0]], tol=TOL), Status.INFEASIBLE),
        (lambda p: normal_cone(p, 0.0, np.zeros((3, 2)), 2.0), Status.COINCIDENT_CENTRES),
    ],
)
def test_failures_have_a_status(call, status):
    with pytest.raises(dincl.ProjectionFailed) as failed:
        call(discs(TRIANGLE, lambda t, x: x * math.sqrt(0.5 - t)))
    assert failed.value.status is status


def test_tangent_velocities_are_those_of_the_metric_of_the_inverse_mobility():
    """Two discs that touch move as one, with sum F / sum 1 / b; one of mobility 0 holds the other up."""
    for mobility, velocity, force in (((1.0, 3.0), 0.75, 0.25), ((1.0, 0.0), 0.0, 1.0), (None, 0.5, 0.5)):
        drift = dincl.drifts.constant([[1.0], [0.0]])
        problem = dincl.Problem([[0.0], [1.0]], drift, [dincl.NonOverlap(0.5)], mobility=mobility)
        found = tangent_velocity(problem, 0.0, problem.x0, tol=1e-9)
        assert found.velocity.ravel() == pytest.approx([velocity, velocity], abs=1e-9)
        assert found.multipliers == pytest.approx([force], abs=1e-9)
