"""Nearest points of sets that are curved on the scale of the step: each back end of programs finds them."""

import numpy as np
import pytest

import dincl

BACK_ENDS = [
    dincl.ActiveSet(1e-9),
    dincl.Daqp(1e-9),
    dincl.Piqp(1e-9),
    dincl.Clarabel(1e-9),
    dincl.CvxpyQP(1e-8),
    dincl.ProjectedCG(1e-9),
    dincl.ProjectedNewton(1e-9),
]


def chain(grip):
    """Four beads on links, the first one held by a ball of radius 0.05 that moves by a fifth of it in each step."""
    x0 = [[0.27 * k, 1.6 - 0.05 * k] for k in range(4)]
    hand = dincl.Moving(grip, lambda t: (0.3 * np.sin(2 * t), -0.5 * t))
    links = dincl.MaxDistance([(k, k + 1) for k in range(3)], length=0.3)
    return dincl.Problem(x0, dincl.drifts.constant((0.0, -1.0)), [links, dincl.NonOverlap(radius=0.13), hand])


BALL = dincl.InsideBall(centre=(0.0, 1.6), distance=np.array([0.05, 50.0, 50.0, 50.0]))
SQUARE = dincl.Smooth(lambda x: np.array([0.05**2 - ((x[0] - np.array([0.0, 1.6])) ** 2).sum()]))


@pytest.mark.parametrize("projection", BACK_ENDS, ids=lambda one: type(one).__name__)
@pytest.mark.parametrize("grip", [BALL, SQUARE], ids=["ball", "function"])
def test_catch_up_holds_a_chain_by_a_small_moving_ball(grip, projection):
    problem = chain(grip)
    path = dincl.solve(problem, dincl.CatchUp(0.02, projection), [0.1])
    exact = dincl.solve(chain(BALL), dincl.EventDriven(1e-6), [0.1])
    assert np.abs(path.final - exact.final).max() <= 0.01
    assert path.violation().max() <= 1e-8


@pytest.mark.parametrize("d", [2, 3])
def test_points_many_radii_outside_of_a_ball(d):
    random = np.random.default_rng(d)
    for distance in (1e-3, 0.5, 1.9, 2.1, 30.0, 1e4):
        toward = random.normal(size=(3, d))
        toward /= np.linalg.norm(toward, axis=1)[:, None]
        problem = dincl.Problem(np.zeros((3, d)), lambda t, x: 0 * x, [dincl.InsideBall(np.zeros(d), 0.5)])
        found = dincl.project(problem, 0.5 * (1 + distance) * toward, dincl.ActiveSet(1e-9))
        assert np.abs(found.point - 0.5 * toward).max() <= 1e-8


def ellipse(axes):
    return dincl.Smooth(lambda x: 1 - ((x / axes) ** 2).sum(axis=1))


def test_ellipses_joined_by_cords():
    """The programs find a nearest point, by its certificate, in each of twelve random sets."""
    random = np.random.default_rng(7)
    for _ in range(12):
        axes = 10 ** random.uniform(-1, 0.5, (3, 2))
        start = 0.3 * axes * random.uniform(-1, 1, (3, 2))
        cords = [dincl.MaxDistance([(k, k + 1)], 1.1 * np.linalg.norm(start[k] - start[k + 1])) for k in range(2)]
        problem = dincl.Problem(start, lambda t, x: 0 * x, [ellipse(axes), *cords])
        y = start + random.uniform(0.1, 1.0) * random.normal(size=(3, 2))
        assert dincl.project(problem, y, dincl.ActiveSet(1e-9)).residual <= 1e-9


def test_a_failure_names_the_curvature():
    """The tip of an ellipse, whose radius of curvature is 0.002, seen from a distance of 15."""
    problem = dincl.Problem([[0.0, 0.0]], lambda t, x: 0 * x, [ellipse(np.array([0.67, 0.034]))])
    with pytest.raises(dincl.ProjectionFailed, match=r"strongly curved on the scale of a step: .* smaller dt"):
        dincl.project(problem, [[5.9, -14.7]], dincl.ActiveSet(1e-9))
