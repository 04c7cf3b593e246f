"""Normal cones, tangent velocities and support functions against closed forms and independent solvers."""

import math

import numpy as np
import pytest
from scipy.optimize import nnls

import dincl
from dincl.geometry import normal_cone, support, tangent_velocity

TOL = 1e-9
TRIANGLE = np.array([[0.0, 0.0], [1.0, 0.0], [0.5, math.sqrt(0.75)]])


def still(t, x):
    return 0 * x


def discs(x, drift=still, *more):
    return dincl.Problem(x, drift, [dincl.NonOverlap(0.5), *more])


def length(u):
    return float(np.sqrt((u**2).sum()))


def test_cone_of_two_discs():
    """Outward means closer together: N = {c (1, -1)} for c >= 0 along the line of centres."""
    cone = normal_cone(discs([[0.0, 0.0], [1.0, 0.0]]), 0.0, [[0.0, 0.0], [1.0, 0.0]], TOL)
    assert cone.names == ((0, "particle 1 and 0"),)
    assert cone.generators.tolist() == [[[-1.0, 0.0], [1.0, 0.0]]]
    together = np.array([[3.0, 0.0], [-3.0, 0.0]])
    assert cone.contains(together)
    assert cone.multipliers(together) == pytest.approx([3.0])
    assert not cone.contains(-together)
    assert cone.distance(-together) == pytest.approx(3 * math.sqrt(2))
    assert cone.contains(0 * together)
    assert "1 active" in repr(cone)


def test_inside_the_cone_is_zero():
    x = [[0.0, 0.0], [2.0, 0.0]]
    cone = normal_cone(discs(x), 0.0, x, TOL)
    assert cone.generators.shape == (0, 2, 2)
    assert cone.distance([[3.0, 0.0], [0.0, 4.0]]) == pytest.approx(5.0)
    assert cone.inverse_triangle() == 1.0
    assert support(discs(x), 0.0, x, np.ones((2, 2)), TOL) == 0.0


def test_only_active_rows_of_several_families_are_named():
    x = [[0.0, 0.5], [1.0, 0.7], [4.0, 0.5]]
    walls = dincl.HalfSpace(normal=(0, 1), radius=0.5), dincl.MaxDistance([[0, 2], [1, 2]], [4.0, 9.0])
    cone = normal_cone(discs(x, still, *walls), 0.0, x, TOL)
    assert cone.names == ((1, "particle 0"), (1, "particle 2"), (2, "particle 0 and 2"))
    assert cone.generators[2].tolist() == [[1.0, 0.0], [0.0, 0.0], [-1.0, 0.0]]


def test_moreau_decomposition_against_non_negative_least_squares(rng):
    cone = normal_cone(discs(TRIANGLE), 0.0, TRIANGLE, TOL)
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


@pytest.mark.parametrize("count", [2, 3, 5, 9])
def test_inverse_triangle_of_a_row(count):
    """The dual v = x sqrt(2)/L gives gamma = sqrt(6/(N (N^2 - 1))); the best lambda is a parabola."""
    x = np.arange(count)[:, None] * np.array([0.6, 0.8])
    gamma = normal_cone(discs(x), 0.0, x, TOL).inverse_triangle()
    assert gamma == pytest.approx(math.sqrt(6 / (count * (count**2 - 1))), rel=1e-8)


def test_inverse_triangle_of_gradients_that_cancel():
    walls = [dincl.HalfSpace(normal=(1,)), dincl.HalfSpace(normal=(-1,))]
    assert normal_cone(dincl.Problem([[0.0]], still, walls), 0.0, [[0.0]], TOL).inverse_triangle() == 0.0


def test_support_is_the_supremum(rng):
    problem = discs(TRIANGLE)
    rows = normal_cone(problem, 0.0, TRIANGLE, TOL).generators
    reactions = np.tensordot(rng.exponential(size=(4000, 3)), rows, 1)
    reactions *= 2.0 / np.sqrt((reactions**2).sum(axis=(1, 2)))[:, None, None]
    for w in rng.normal(size=(20, 3, 2)):
        seen = max(0.0, float((reactions * w).sum(axis=(1, 2)).max()))
        exact = support(problem, 0.0, TRIANGLE, w, TOL, radius=2.0)
        assert seen <= exact + 1e-9
        assert exact <= seen + 0.05 * length(w)
        assert support(problem, 0.0, TRIANGLE, w, TOL) == (math.inf if exact > 1e-6 else 0.0)


def test_tangent_velocity_of_two_discs():
    """The closing speed is shared and vanishes; the rest of the drift stays."""
    x, drift = [[0.0, 0.0], [1.0, 0.0]], np.array([[2.0, 1.0], [-1.0, 3.0]])
    found = tangent_velocity(discs(x, lambda t, x: drift), 0.0, x, tol=TOL)
    assert found.velocity == pytest.approx(np.array([[0.5, 1.0], [0.5, 3.0]]))
    assert found.multipliers == pytest.approx([1.5])
    assert found.names == ((0, "particle 1 and 0"),)
    apart = tangent_velocity(discs(x), 0.0, x, -drift, tol=TOL)
    assert apart.velocity == pytest.approx(-drift)
    assert apart.multipliers == pytest.approx([0.0])


def test_tangent_velocity_belongs_to_the_inclusion(rng):
    """v in T, F - v in N, and (F - v).v = 0, with redundant contacts and more unknowns than the dense solver takes."""
    steps = np.arange(-3, 4)
    places = np.array([[i + j / 2, j * math.sqrt(0.75)] for i in steps for j in steps])
    problem = discs(places)
    cone = normal_cone(problem, 0.0, places, TOL)
    assert len(cone.names) > 98
    drift = -places + 0.3 * rng.normal(size=places.shape)
    found = tangent_velocity(problem, 0.0, places, drift, tol=TOL)
    assert float(np.tensordot(cone.generators, found.velocity, 2).min()) > -1e-8
    assert float(((drift - found.velocity) * found.velocity).sum()) == pytest.approx(0.0, abs=1e-7)
    reaction = np.tensordot(found.multipliers, cone.generators, 1)
    assert drift + reaction == pytest.approx(found.velocity, abs=1e-8)
    assert found.multipliers.min() >= 0
    assert found.residual < 1e-8


def test_tangent_velocity_follows_a_moving_wall():
    rising = dincl.Moving(dincl.HalfSpace(normal=(0, 2)), lambda t: (5 * t, math.sin(t)))
    problem = dincl.Problem([[0.0, 0.0]], lambda t, x: np.array([[1.0, -1.0]]), [rising])
    assert tangent_velocity(problem, 0.0, [[0.0, 0.0]], tol=TOL).velocity == pytest.approx(np.array([[1.0, 1.0]]))
    place = [[0.0, math.sin(0.5)]]
    found = tangent_velocity(problem, 0.5, place, tol=TOL)
    assert found.velocity == pytest.approx(np.array([[1.0, math.cos(0.5)]]))
    assert found.multipliers == pytest.approx([1 + math.cos(0.5)])
    resting = tangent_velocity(problem, 0.5, place, [[0.0, 0.0]], tol=TOL)
    assert resting.velocity == pytest.approx(np.array([[0.0, math.cos(0.5)]]))


def test_multipliers_belong_to_g_and_not_to_unit_gradients():
    steep = dincl.Smooth(lambda x: np.array([10 * x[0, 0]]), lambda x: np.array([[10.0]]))
    found = tangent_velocity(dincl.Problem([[0.0]], still, [steep]), 0.0, [[0.0]], [[-3.0]], tol=TOL)
    assert found.multipliers == pytest.approx([0.3])
    assert found.velocity == pytest.approx(0.0)


def test_tolerance_is_a_distance():
    steep = dincl.Smooth(lambda x: np.array([10 * x[0, 0]]), lambda x: np.array([[10.0]]))
    problem = dincl.Problem([[0.0]], still, [steep])
    assert len(normal_cone(problem, 0.0, [[0.9e-3]], 1e-3).names) == 1
    assert len(normal_cone(problem, 0.0, [[1.1e-3]], 1e-3).names) == 0
    with pytest.raises(dincl.InvalidProblem, match="outside of S"):
        normal_cone(problem, 0.0, [[-1.1e-3]], 1e-3)


@pytest.mark.parametrize(
    ("call", "match"),
    [
        (lambda p, x: normal_cone("p", 0.0, x, TOL), "problem = "),
        (lambda p, x: normal_cone(p, -1.0, x, TOL), "t = "),
        (lambda p, x: normal_cone(p, 0.0, x[:1], TOL), r"x = .*of shape \(3, 2\)"),
        (lambda p, x: normal_cone(p, 0.0, 0.9 * x, TOL), "outside of S"),
        (lambda p, x: normal_cone(p, 0.0, x, 0.0), "tol = "),
        (lambda p, x: normal_cone(p, 0.0, x, TOL).distance(x[0]), "u = "),
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


def test_failures_have_a_status():
    def drift(t, x):
        return x * math.sqrt(0.5 - t)

    problem = discs(TRIANGLE, drift)
    with pytest.raises(dincl.ProjectionFailed) as failed:
        tangent_velocity(problem, 1.0, TRIANGLE, tol=TOL)
    assert failed.value.status is dincl.Status.DRIFT_FAILED
    closing = [
        dincl.Moving(dincl.HalfSpace(normal=(1,)), lambda t: (t,)),
        dincl.Moving(dincl.HalfSpace(normal=(-1,)), lambda t: (-t,)),
    ]
    with pytest.raises(dincl.ProjectionFailed) as failed:
        tangent_velocity(dincl.Problem([[0.0]], still, closing), 0.0, [[0.0]], tol=TOL)
    assert failed.value.status is dincl.Status.INFEASIBLE
    with pytest.raises(dincl.ProjectionFailed) as failed:
        normal_cone(problem, 0.0, np.zeros((3, 2)), 2.0)
    assert failed.value.status is dincl.Status.COINCIDENT_CENTRES
