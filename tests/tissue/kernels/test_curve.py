"""The basal layer as kernels read it is the basal layer as Python does, open or closed, also beyond the ends."""

import numpy as np
import pytest

from tissue.kernels import kernel
from tissue.kernels.curve import evaluate, foot_of, height_of
from tissue.state.basal_curve import curve_numbers, ellipse, through

WAVE = np.array([[-10.0, 0.0], [-5.0, 1.0], [0.0, 0.0], [5.0, -1.0], [10.0, 0.0]])
CURVES = {
    "open": through(WAVE, around=False),
    "closed": through(np.array([[-4.0, 0.0], [0.0, -5.0], [6.0, 0.0], [0.0, 4.0], [-4.0, 0.0]]), around=True),
    "ring": ellipse(60.0, 1.5, inside=True, ring=True),
    "arc": ellipse(90.0, 1.0, inside=False, ring=False),
}


@kernel
def courses(curve, places, found):
    """The points and tangents at some arclengths, into ``found`` (K, 4)."""
    for k in range(len(places)):
        found[k, 0], found[k, 1], found[k, 2], found[k, 3] = evaluate(curve, places[k])


@kernel
def feet(curve, x, y, found):
    """The feet and heights of some points, into ``found`` (2, K)."""
    for k in range(len(x)):
        found[0, k], found[1, k] = foot_of(curve, x[k], y[k]), height_of(curve, x[k], y[k])


def assert_same_course(curve, places):
    position, tangent, _ = curve.evaluate(places)
    found = np.empty((len(places), 4))
    courses(curve_numbers(curve), places, found)
    np.testing.assert_allclose(found[:, :2].T, position, rtol=0, atol=1e-10)
    np.testing.assert_allclose(found[:, 2:].T, tangent, rtol=0, atol=1e-10)


@pytest.mark.parametrize("name", CURVES)
def test_points_and_tangents_are_those_of_the_curve(name):
    curve = CURVES[name]
    last = 1.3 if curve.around else 0.499
    assert_same_course(curve, np.linspace(-1.3 * curve.length, last * curve.length, 101))


def test_an_open_curve_goes_on_straight_at_its_right_end():
    curve = CURVES["open"]
    assert_same_course(curve, np.linspace(0.5, 1.3, 11) * curve.length)


@pytest.mark.parametrize("name", CURVES)
@pytest.mark.parametrize("height", [-0.5, 0.0, 0.7])
def test_feet_and_heights_come_back(name, height):
    curve = CURVES[name]
    s = np.linspace(-0.45, 0.45, 21) * curve.length
    x, y = curve.above(s, np.full(21, height))
    found = np.empty((2, 21))
    feet(curve_numbers(curve), x, y, found)
    off = found[0] - s
    if curve.around:
        off -= curve.length * np.round(off / curve.length)
    np.testing.assert_allclose(off, 0.0, rtol=0, atol=1e-8)
    np.testing.assert_allclose(found[1], height, rtol=0, atol=1e-8)
