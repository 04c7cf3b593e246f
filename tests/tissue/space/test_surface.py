"""Surfaces in space: heights, normals and nearest points, one by one as in arrays, and what is refused."""

import math

import numpy as np
import pytest

from dincl import InvalidProblem
from tissue.kernels import kernel
from tissue.state import surface as s

SURFACES = {
    "plane": s.plane(),
    "periodic plane": s.plane(period_x=5.0, period_z=7.0),
    "cylinder outside": s.cylinder(3.0, inside=False),
    "cylinder inside": s.cylinder(3.0, inside=True, period_z=4.0),
    "sphere outside": s.sphere(2.0, inside=False),
    "sphere inside": s.sphere(2.0, inside=True),
}
every = pytest.mark.parametrize("surface", SURFACES.values(), ids=SURFACES)


@kernel
def measure(surface, points, heights, normals, feet):
    for i in range(len(points)):
        x, y, z = points[i]
        heights[i] = s.height(surface, x, y, z)
        normals[i, 0], normals[i, 1], normals[i, 2] = s.normal(surface, x, y, z)
        feet[i, 0], feet[i, 1], feet[i, 2] = s.onto(surface, x, y, z)


@every
def test_kernels_and_arrays_agree(surface, rng):
    points = rng.normal(size=(50, 3)) * 3
    heights, normals, feet = np.empty(50), np.empty((50, 3)), np.empty((50, 3))
    measure(surface, points, heights, normals, feet)
    np.testing.assert_allclose(heights, s.heights(surface, points), rtol=1e-14, atol=1e-14)
    np.testing.assert_allclose(normals, s.normals(surface, points), rtol=1e-14)
    np.testing.assert_allclose(feet, s.laid(surface, points), rtol=1e-13, atol=1e-14)


@every
def test_a_point_is_its_foot_and_its_height_along_the_normal(surface, rng):
    points = rng.normal(size=(50, 3)) * 3
    feet, heights, normals = s.laid(surface, points), s.heights(surface, points), s.normals(surface, points)
    np.testing.assert_allclose(s.heights(surface, feet), 0.0, atol=1e-14)
    np.testing.assert_allclose(feet + heights[:, None] * normals, points, rtol=1e-13, atol=1e-13)
    step = 1e-6 * normals
    np.testing.assert_allclose(s.heights(surface, points + step) - heights, 1e-6, rtol=1e-6)


@pytest.mark.parametrize(("d", "period", "nearest"), [(2.6, 5.0, -2.4), (-12.6, 5.0, 2.4), (1e9, math.inf, 1e9)])
def test_differences_are_to_the_nearest_image(d, period, nearest):
    assert s.nearest_image(d, period) == pytest.approx(nearest)
    surface = s.plane(period_x=period, period_z=2 * period)
    assert s.differences(surface, d, d, d)[:2] == (s.nearest_image(d, period), d)


def test_the_middle_has_no_normal():
    with pytest.raises(InvalidProblem, match="middle"):
        s.normals(s.sphere(1.0, inside=False), np.zeros((1, 3)))
    with pytest.raises(InvalidProblem, match="middle"):
        s.laid(s.cylinder(1.0, inside=False), [[0.0, 0.0, 3.0]])
