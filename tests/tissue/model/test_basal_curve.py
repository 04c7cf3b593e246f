"""The basal layer as a curve against formulas of circles and ellipses, and quadrature of another library."""

import numpy as np
import pytest
from scipy.integrate import quad

from tissue.state.basal_curve import LINE, ellipse, through

R = 60 / (2 * np.pi)
PLACES = np.linspace(-70.0, 70.0, 401)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_circle(side):
    """gamma = (R sin(s/R), +-R (1 - cos(s/R))), the tissue on the left: towards the centre, or away from it."""
    curve = ellipse(60.0, 1.0, inside=side > 0, ring=True)
    position, tangent, bend = curve.evaluate(PLACES)
    angle = PLACES / R
    np.testing.assert_allclose(position, [R * np.sin(angle), side * R * (1 - np.cos(angle))], rtol=0, atol=1e-12)
    np.testing.assert_allclose(tangent, [np.cos(angle), side * np.sin(angle)], rtol=0, atol=1e-11)
    np.testing.assert_allclose(bend, np.array([-np.sin(angle), side * np.cos(angle)]) / R, rtol=0, atol=1e-9)
    assert curve.area == pytest.approx(side * np.pi * R**2, rel=1e-13)
    assert curve.largest_curvature == pytest.approx(1 / R if side > 0 else 0.0, rel=1e-9, abs=1e-15)


@pytest.mark.parametrize("aspect", [0.4, 2.5])
@pytest.mark.parametrize("inside", [True, False])
def test_ellipse(aspect, inside):
    curve = ellipse(80.0, aspect, inside=inside, ring=True)
    (x, y), tangent, _ = curve.evaluate(PLACES)
    a = np.abs(x).max()
    a = 80.0 / quad(lambda t: np.hypot(np.cos(t), aspect * np.sin(t)), 0, 2 * np.pi, epsabs=1e-13, limit=200)[0]
    b = a * aspect
    centre = b if inside else -b
    np.testing.assert_allclose((x / a) ** 2 + ((y - centre) / b) ** 2, 1.0, rtol=0, atol=1e-11)
    np.testing.assert_allclose(np.hypot(*tangent), 1.0, rtol=0, atol=1e-10)
    assert curve.area == pytest.approx((1 if inside else -1) * np.pi * a * b, rel=1e-11)
    if inside:
        assert curve.largest_curvature == pytest.approx(max(a / b**2, b / a**2), rel=1e-4)


@pytest.mark.parametrize("height", [-2.0, 0.0, 5.0])
@pytest.mark.parametrize(
    "curve", [LINE, ellipse(60.0, 1.0, inside=True, ring=True), ellipse(90.0, 1.5, inside=False, ring=False)]
)
def test_heights_are_along_the_normal(curve, height):
    s = np.linspace(-20.0, 20.0, 101)
    x, y = curve.above(s, np.full(101, height))
    np.testing.assert_allclose(curve.heights(x, y), height, rtol=0, atol=1e-10)
    np.testing.assert_allclose(curve.feet(x, y), s, rtol=0, atol=1e-10)


def test_a_curve_through_points_passes_them_and_goes_on_straight():
    points = np.array([[-10.0, 0.0], [-5.0, 1.0], [0.0, 0.0], [5.0, -1.0], [10.0, 0.0]])
    curve = through(points, around=False)
    assert np.abs(curve.heights(*points.T)).max() < 1e-6
    position, tangent, bend = curve.evaluate(np.array([0.0, curve.length / 2, curve.length / 2 + 7.0]))
    np.testing.assert_allclose(position[:, :2], [[0.0, 10.0], [0.0, 0.0]], rtol=0, atol=1e-6)
    np.testing.assert_allclose(position[:, 2] - position[:, 1], 7.0 * tangent[:, 1], rtol=0, atol=1e-12)
    assert not bend[:, 2].any()


def test_a_closed_curve_through_points_of_a_circle_is_nearly_one():
    errors = []
    for m in (12, 24, 48):
        angle = np.linspace(0.0, 2 * np.pi, m + 1)
        points = R * np.column_stack((np.sin(angle), 1 - np.cos(angle)))
        points[-1] = points[0]
        errors.append(through(points, around=True).length - 60.0)
    assert np.abs(errors[0]) < 0.02
    assert np.abs(errors[0] / errors[1]) > 12  # order four
    assert np.abs(errors[1] / errors[2]) > 12
