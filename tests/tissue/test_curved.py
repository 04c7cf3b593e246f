"""Tissue on a curved basal layer: the curve itself, then runs against circles by sine and cosine, and their limit."""

import numpy as np
import pytest
from scipy.integrate import quad

from dincl.status import Status
from tests.tissue import kernel_calls as kernels
from tests.tissue import states
from tests.twins import tissue as twins
from tissue.files.parameters import preset
from tissue.model.energy import forces
from tissue.runs.group import Group
from tissue.runs.simulate import simulate
from tissue.state.basal_curve import LINE, curve_numbers, ellipse, through
from tissue.state.running import BASAL_CORRECTIONS

QUIET = {"tissue.diffusion": "0 um^2/h", "tissue.two_daughters": 0}
RING = {"layer.shape": "circle", "layer.closed": True, "layer.perimeter": "60 R_soft", "tissue.cells": 180}
R = 60 / (2 * np.pi)
PLACES = np.linspace(-70.0, 70.0, 401)
WAVE = np.array([[-10.0, 0.0], [-5.0, 1.0], [0.0, 0.0], [5.0, -1.0], [10.0, 0.0]])
CURVES = {
    "line": LINE,
    "open": through(WAVE, around=False),
    "closed": through(np.array([[-4.0, 0.0], [0.0, -5.0], [6.0, 0.0], [0.0, 4.0], [-4.0, 0.0]]), around=True),
    "ring": ellipse(60.0, 1.5, inside=True, ring=True),
    "arc": ellipse(90.0, 1.0, inside=False, ring=False),
}


def published(**changes):
    return preset("published").changed({"numerics.t_end": "6 h", "numerics.keep": "3 h", **changes})


# The curve against formulas of circles and ellipses, and quadrature of another library


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_circle(side):
    """gamma = (R sin(s/R), +-R (1 - cos(s/R))), the tissue on the left: towards the centre, or away from it."""
    curve, angle = ellipse(60.0, 1.0, inside=side > 0, ring=True), PLACES / R
    position, tangent, bend = curve.evaluate(PLACES)
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
    a = 80.0 / quad(lambda t: np.hypot(np.cos(t), aspect * np.sin(t)), 0, 2 * np.pi, epsabs=1e-13, limit=200)[0]
    b = a * aspect
    centre = b if inside else -b
    np.testing.assert_allclose((x / a) ** 2 + ((y - centre) / b) ** 2, 1.0, rtol=0, atol=1e-11)
    np.testing.assert_allclose(np.hypot(*tangent), 1.0, rtol=0, atol=1e-10)
    assert curve.area == pytest.approx((1 if inside else -1) * np.pi * a * b, rel=1e-11)
    if inside:
        assert curve.largest_curvature == pytest.approx(max(a / b**2, b / a**2), rel=1e-4)


@pytest.mark.parametrize("name", CURVES)
def test_kernels_and_python_agree_along_the_curve_and_its_normals(name):
    """Open or closed, also beyond the ends; feet and heights are those that points were made from."""
    curve, places = CURVES[name], np.linspace(-1.3, 1.3, 101) * (CURVES[name].length or 20.0)
    if curve.pieces:
        position, tangent, _ = curve.evaluate(places)
        found = kernels.on_curve(curve, places, *position)[:4]
        np.testing.assert_allclose(found, (*position, *tangent), rtol=0, atol=1e-10)
    s = np.linspace(-0.45, 0.45, 41) * (curve.length or 40.0)
    for height in (-0.5, 0.0, 0.7):
        x, y = curve.above(s, np.full(41, height))
        np.testing.assert_allclose(curve.heights(x, y), height, rtol=0, atol=1e-10)
        np.testing.assert_allclose(curve.feet(x, y), s, rtol=0, atol=1e-10)
        feet, heights = kernels.on_curve(curve, s, x, y)[4:]
        away = feet - s
        if curve.around:
            away -= curve.length * np.round(away / curve.length)
        np.testing.assert_allclose(away, 0.0, rtol=0, atol=1e-8)
        np.testing.assert_allclose(heights, height, rtol=0, atol=1e-8)


def test_a_curve_through_points_passes_them_and_goes_on_straight():
    curve = CURVES["open"]
    assert np.abs(curve.heights(*WAVE.T)).max() < 1e-6
    position, tangent, bend = curve.evaluate(np.array([0.0, curve.length / 2, curve.length / 2 + 7.0]))
    np.testing.assert_allclose(position[:, :2], [[0.0, 10.0], [0.0, 0.0]], rtol=0, atol=1e-6)
    np.testing.assert_allclose(position[:, 2] - position[:, 1], 7.0 * tangent[:, 1], rtol=0, atol=1e-12)
    assert not bend[:, 2].any()


@pytest.mark.parametrize("name", ["open", "closed"])
def test_a_curve_through_points_is_measured_along_itself(name):
    curve, h = CURVES[name], 1e-4
    s = (np.linspace(0.01, 0.99, 400) - (0.0 if curve.around else 0.5)) * curve.length
    (before, turned_before, _), (_, tangent, bend), (behind, turned, _) = map(curve.evaluate, (s - h, s, s + h))
    np.testing.assert_allclose(np.hypot(*tangent), 1.0, rtol=0, atol=1e-5)
    np.testing.assert_allclose((behind - before) / (2 * h), tangent, rtol=0, atol=1e-5)
    np.testing.assert_allclose((turned - turned_before) / (2 * h), bend, rtol=0, atol=1e-3)


# Runs


def substep(cells, layers, numbers, closed):
    """Z - (h/mu) grad W, basal points along the circle, then one sweep of projections; in plain NumPy."""
    step, b, along = numbers.dt / numbers.substeps / numbers.mu, layers.basal, cells.along.copy()
    force = forces(cells, layers, numbers, ellipse(60.0, 1.0, inside=True, ring=closed))
    along[b] += step * (force.bx[b] * np.cos(along[b] / R) + force.by[b] * np.sin(along[b] / R))
    ordered = twins.limit(twins.order(along[b]), numbers.max_basal_distance)
    if closed:
        gap = ordered[0] + 60.0 - ordered[-1]
        push = max(-gap / 2, 0.0)
        pull = max((gap + 2 * push - numbers.max_basal_distance) / 2, 0.0)
        ordered[0], ordered[-1] = ordered[0] + push - pull, ordered[-1] - push + pull
    along[b] = ordered
    bx, by = cells.bx.copy(), cells.by.copy()
    bx[b], by[b] = R * np.sin(ordered / R), R * (1 - np.cos(ordered / R))
    x, y, _ = twins.separate(np.array([cells.x + step * force.x, cells.y + step * force.y, cells.z]), cells.radius)
    ax, ay = cells.ax + step * force.ax, cells.ay + step * force.ay
    return cells._replace(x=x, y=y, ax=ax, ay=ay, bx=bx, by=by, along=along)


def distance(a, b):
    names = ("x", "y", "ax", "ay", "bx", "by", "along")
    return max(np.abs(getattr(a, name) - getattr(b, name)).max() for name in names)


@pytest.mark.parametrize("closed", [True, False])
def test_substeps_on_a_circle(closed):
    numbers = states.numbers(variance=0.0)
    parameters = published(**RING if closed else {**RING, "layer.closed": False, "tissue.cells": 60})
    cells, layers = simulate(parameters, 0).final[1:3]
    expected = cells
    for _ in range(numbers.substeps):
        expected = substep(expected, layers, numbers, closed)
    held = kernels.held(kernels.Tissue(cells, layers, 0), curve=curve_numbers(parameters.curve()))
    group = Group([held], numbers)
    assert group.make_substeps()
    assert distance(kernels.taken(group.states[0]).cells, expected) < 1e-10


@pytest.mark.parametrize("gap", [24.0, -0.5])
def test_what_closes_a_ring_is_counted(gap):
    """Its first and last basal points are drawn together, or pushed apart; the others stay."""
    numbers, curve = states.numbers(variance=0.0, substeps=1, max_basal_distance=9.0, mu=1e12), CURVES["ring"]
    cells, layers = states.cells(40, 0), states.layers(40)
    cells = cells._replace(along=np.linspace(0.0, 60.0 - gap, 40))
    group = Group([kernels.held(kernels.Tissue(cells, layers, 0), curve=curve_numbers(curve))], numbers)
    assert group.make_substeps()
    assert group.states[0].counts[BASAL_CORRECTIONS] == 1


def test_a_large_circle_is_nearly_a_line():
    """Without noise, an arc of radius R differs from the line by O(1/R)."""
    line = simulate(published(**QUIET), 0).final.cells
    away = []
    for perimeter in (1e5, 1e6, 1e7):
        bent = {"layer.shape": "circle", "layer.perimeter": f"{perimeter} R_soft"}
        away.append(distance(simulate(published(**QUIET, **bent), 0).final.cells._replace(along=line.along), line))
    assert away[2] < 1e-4
    assert 8 < away[0] / away[1] < 12.5
    assert 8 < away[1] / away[2] < 12.5


def test_a_lumen_that_closes_ends_the_run():
    run = simulate(published(**RING | {"numerics.t_end": "24 h", "numerics.keep": "24 h"}), throw=False)
    assert run.status is Status.LUMEN_CLOSED
    assert "opposite parts of the apical layer" in run.detail
    assert 0 < run.final.t < 24
    assert run.folded == f"t = {run.final.t:g} h: {run.summary()['folded'].iloc[-1]}" != ""
    outside = simulate(published(**RING, **{"layer.side": "outside"}), throw=False)
    assert outside.status is Status.SUCCESS
