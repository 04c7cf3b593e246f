"""The verb ``project``: what it is given and what it refuses."""

import numpy as np
import pytest

import dincl

PROBLEM = dincl.Problem([[0.0, 0.0], [2.0, 0.0]], lambda t, x: 0 * x, [dincl.NonOverlap(0.5)])
Y = np.array([[0.5, 0.0], [1.0, 0.0]])


def test_the_nearest_point_of_a_pair():
    found = dincl.project(PROBLEM, Y, dincl.Daqp(1e-12))
    assert found.point == pytest.approx(np.array([[0.25, 0.0], [1.25, 0.0]]), abs=1e-12)
    assert found.multipliers == pytest.approx([0.25], abs=1e-12)


def test_the_tangent_plane_is_another_set():
    y = np.array([[0.5, 0.0], [0.5, 0.8]])
    tangent = dincl.project(PROBLEM, y, dincl.Daqp(1e-12), linearised_at=PROBLEM.x0)
    assert tangent.point == pytest.approx(np.array([[0.0, 0.0], [1.0, 0.8]]), abs=1e-12)
    assert dincl.project(PROBLEM, y, dincl.Daqp(1e-12)).point != pytest.approx(tangent.point, abs=0.1)


def test_a_far_point_is_projected_with_rows_that_reach_it():
    x0 = np.column_stack([1.001 * np.arange(8), np.zeros(8)])
    floor = dincl.HalfSpace((1, 0), radius=0.5, offset=-0.5)
    problem = dincl.Problem(x0, lambda t, x: 0 * x, [dincl.NonOverlap(0.5), floor])
    y = x0 - [3.0, 0.0]
    found = dincl.project(problem, y, dincl.Daqp(1e-12))
    assert problem.violation(0.0, found.point) <= 1e-12


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"problem": None}, "problem = None: must be"),
        ({"projection": "daqp"}, "projection = 'daqp': must be"),
        ({"projection": dincl.Daqp}, "projection = .*: must be"),
        ({"y": [0.0, 0.0]}, r"y of shape \(2,\): must have the shape of x0, \(2, 2\)"),
        ({"y": [[np.nan, 0.0], [1.0, 0.0]]}, r"y = nan at index \(0, 0\)"),
        ({"linearised_at": [[0.0, 0.0]]}, r"linearised_at of shape \(1, 2\)"),
        ({"t": np.inf}, "t = inf: must be"),
    ],
)
def test_bad_input_is_named(change, message):
    arguments = {"problem": PROBLEM, "y": Y, "projection": dincl.Daqp(1e-9)} | change
    with pytest.raises(dincl.InvalidProblem, match=message):
        dincl.project(**arguments)


def test_a_point_without_direction_fails_with_its_status():
    with pytest.raises(dincl.ProjectionFailed, match="Particle 1 lies on particle 0") as caught:
        dincl.project(PROBLEM, np.zeros((2, 2)), dincl.Daqp(1e-9))
    assert caught.value.status is dincl.Status.COINCIDENT_CENTRES
