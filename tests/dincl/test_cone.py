"""The distance to the cone of gradients, against non-negative least squares."""

import numpy as np
import pytest
from scipy.optimize import nnls

from dincl.matrices import from_equal_rows
from dincl.projection.cone import DENSE, distance_to_cone


def gradients(rows):
    m, n = rows.shape
    return from_equal_rows(np.tile(np.arange(n), (m, 1)), rows, n)


@pytest.mark.parametrize(("m", "n"), [(1, 2), (5, 8), (12, 8), (40, 2 * DENSE)])
def test_against_non_negative_least_squares(m, n, rng):
    for _ in range(10):
        rows, u = rng.normal(size=(m, n)), rng.normal(size=n)
        assert distance_to_cone(u, gradients(rows)) == pytest.approx(nnls(rows.T, u)[1], rel=1e-8)


def test_inside_polar_and_empty(rng):
    rows = rng.normal(size=(3, 6))
    inside = rows.T @ [0.5, 0.0, 2.0]
    assert distance_to_cone(inside, gradients(rows)) < 1e-9
    corner = np.eye(3)
    assert distance_to_cone(np.array([-1.0, -2.0, -2.0]), gradients(corner)) == pytest.approx(3.0)
    assert distance_to_cone(np.array([3.0, 4.0]), gradients(np.zeros((0, 2)))) == pytest.approx(5.0)
    assert distance_to_cone(np.zeros(3), gradients(corner)) == 0.0
