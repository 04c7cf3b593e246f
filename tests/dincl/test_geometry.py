"""Normal cones and support functions against closed forms and independent solvers."""

import math

import numpy as np
import pytest
from scipy.optimize import nnls

import dincl
from dincl.geometry import normal_cone, support
from dincl.status import Status

TOL = 1e-9
TRIANGLE = np.array([[0.0, 0.0], [1.0, 0.0], [0.5, math.sqrt(0.75)]])
PAIR = np.array([[0.0, 0.0], [1.0, 0.0]])
STEEP = dincl.Smooth(lambda x: np.array([10 * x[0, 0]]), lambda x: np.array([[10.0]]))


def still(t, x):
    return 0 * x


def discs(x, *more):
    return dincl.Problem(x, still, [dincl.NonOverlap(0.5), *more])


def cone_of(x, *more):
    return normal_cone(discs(x, *more), 0.0, x, TOL)


def test_cone_of_two_discs_and_of_none():
    """Outward means closer together: N = {c (1, -1)} for c >= 0 along the line of centres."""
    cone, together = cone_of(PAIR), np.array([[3.0, 0.0], [-3.0, 0.0]])
    assert cone.names == ((0, "particle 1 and 0"),)
    assert cone.generators.tolist() == [[[-1.0, 0.0], [1.0, 0.0]]]
    assert cone.multipliers(together) == pytest.approx([3.0])
    assert [cone.distance(u) for u in (together, 0 * together)] == pytest.approx([0.0, 0.0], abs=1e-9)
    assert cone.distance(-together) == pytest.approx(3 * math.sqrt(2))
    inside = cone_of(2 * PAIR)
    assert inside.generators.shape == (0, 2, 2)
    assert inside.distance([[3.0, 0.0], [0.0, 4.0]]) == pytest.approx(5.0)
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
        assert cone.distance(normal) == pytest.approx(0.0, abs=1e-8)


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
        (lambda p, x: normal_cone(p, 0.0, x, TOL).distance(np.full_like(x, np.inf)), "u = "),
        (lambda p, x: support(p, 0.0, x, x[0], TOL), "direction = .*of shape"),
        (lambda p, x: support(p, 0.0, x, x, TOL, radius=0.0), "radius = "),
    ],
)
def test_bad_input(call, match):
    with pytest.raises(dincl.InvalidProblem, match=match):
        call(discs(TRIANGLE), TRIANGLE)


def test_centres_that_coincide_have_no_cone():
    with pytest.raises(dincl.ProjectionFailed) as failed:
        normal_cone(discs(TRIANGLE), 0.0, np.zeros((3, 2)), 2.0)
    assert failed.value.status is Status.COINCIDENT_CENTRES
