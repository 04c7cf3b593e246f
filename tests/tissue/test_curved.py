"""Tissue on a curved basal layer: against circles by sine and cosine, the line as their limit, and symmetries."""

import math

import numpy as np
import pytest

from dincl.status import Status
from tests.tissue import states
from tests.twins.tissue import steps as twins
from tissue.files.parameters import preset
from tissue.frames.observables import ab_positions, areas, height, nucleus_height
from tissue.model.energy import forces
from tissue.model.extents import measure_extents
from tissue.model.scale import measure
from tissue.rules.slice import in_plane
from tissue.runs.group import Group
from tissue.runs.simulate import simulate
from tissue.state.basal_curve import curve_numbers, ellipse
from tissue.state.running import contents, new_state
from tissue.study.outcomes import EXTENTS

QUIET = {"tissue.diffusion": "0 um^2/h", "tissue.two_daughters": 0}
RING = {"layer.shape": "circle", "layer.closed": True, "layer.perimeter": "60 R_soft", "tissue.cells": 180}


def published(**changes):
    return preset("published").changed({"numerics.t_end": "6 h", "numerics.keep": "3 h", **changes})


class Circle:
    """The formulas of a circle with the tissue inside."""

    def __init__(self, perimeter):
        self.r, self.length = perimeter / (2 * math.pi), perimeter

    def at(self, s):
        return self.r * np.sin(s / self.r), self.r * (1 - np.cos(s / self.r))

    def tangents(self, s):
        return np.cos(s / self.r), np.sin(s / self.r)


def substep(cells, layers, numbers, circle, closed):
    """Z - (h/mu) grad W, basal points along the circle, then one sweep of projections; in plain NumPy."""
    step = numbers.dt / numbers.substeps / numbers.mu
    curve = ellipse(circle.length, 1.0, inside=True, ring=closed)
    force, b = forces(cells, layers, numbers, curve), layers.basal
    along = cells.along.copy()
    tx, ty = circle.tangents(along[b])
    along[b] += step * (force.bx[b] * tx + force.by[b] * ty)
    ordered = twins.limit(twins.order(along[b]), numbers.max_basal)
    if closed:
        gap = ordered[0] + circle.length - ordered[-1]
        push = max(-gap / 2, 0.0)
        pull = max((gap + 2 * push - numbers.max_basal) / 2, 0.0)
        ordered[0], ordered[-1] = ordered[0] + push - pull, ordered[-1] - push + pull
    along[b] = ordered
    bx, by = cells.bx.copy(), cells.by.copy()
    bx[b], by[b] = circle.at(ordered)
    x, y = twins.separate(cells.x + step * force.x, cells.y + step * force.y, cells.radius)
    return cells._replace(
        x=x, y=y, ax=cells.ax + step * force.ax, ay=cells.ay + step * force.ay, bx=bx, by=by, along=along
    )


def distance(a, b):
    return max(
        np.abs(getattr(a, name) - getattr(b, name)).max() for name in ("x", "y", "ax", "ay", "bx", "by", "along")
    )


@pytest.mark.parametrize("closed", [True, False])
@pytest.mark.parametrize("seed", [0, 1])
def test_substeps_on_a_circle(closed, seed):
    numbers = states.numbers(variance=0.0)
    parameters = published(**RING if closed else {**RING, "layer.closed": False, "tissue.cells": 60})
    run = simulate(parameters, seed)
    cells, layers = run.final.cells, run.final.layers
    circle, expected = Circle(60.0), cells
    for _ in range(numbers.substeps):
        expected = substep(expected, layers, numbers, circle, closed)
    held = new_state(cells, layers, capacity=len(cells.x), curve=curve_numbers(parameters.curve()), space=in_plane())
    group = Group([held], numbers)
    assert group.make_substeps()
    assert distance(contents(group.states[0])[0], expected) < 1e-10


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


def _symmetric(n, perimeter, turned=0.0):
    """A tube of n equal cells, the first one at the arclength ``turned``, and its numbers."""
    curve = ellipse(perimeter, 1.0, inside=True, ring=True)
    s = turned + perimeter / n * np.arange(n)
    points = [np.column_stack(curve.above(s, np.full(n, height))) for height in (4.0, 8.0, 0.0)]
    cells = states.tissue(*points, along=s)
    return new_state(cells, capacity=n, curve=curve_numbers(curve), space=in_plane()), states.numbers(
        variance=0.0, max_basal=2.0
    )


def _turned_back(cells, angle, radius):
    """The points, (3, 2, n), turned by the angle around the centre of a circle that touches (0, 0) from above."""
    c, s = math.cos(angle), math.sin(angle)
    points = np.array([[cells.x, cells.y - radius], [cells.ax, cells.ay - radius], [cells.bx, cells.by - radius]])
    return np.einsum("ij,kjn->kin", [[c, s], [-s, c]], points)


def test_a_symmetric_tube_stays_symmetric():
    n, perimeter = 60, 120.0
    held, numbers = _symmetric(n, perimeter)
    group = Group([held], numbers)
    for _ in range(50):
        assert group.make_substeps()
    cells = contents(group.states[0])[0]
    radius = perimeter / (2 * math.pi)
    for x, y in ((cells.x, cells.y), (cells.ax, cells.ay), (cells.bx, cells.by)):
        far = np.hypot(x, y - radius)
        assert np.ptp(far) < 1e-12
    assert np.ptp(np.diff(cells.along)) < 1e-12
    moved = np.hypot(cells.ax, cells.ay - radius)[0] - (radius - 8.0)
    assert abs(moved) > 0.1  # so the tube did not just stand still


def test_turning_the_tube_turns_the_run():
    n, perimeter, by = 60, 120.0, 17.3
    found = []
    for turned in (0.0, by):
        held, numbers = _symmetric(n, perimeter, turned)
        held.cells.stiff_ax[:n] *= np.random.default_rng(3).uniform(0.5, 2.0, n)
        held.cells.rest_aa[:n] *= np.random.default_rng(4).uniform(0.5, 2.0, n)
        group = Group([held], numbers)
        for _ in range(5):
            assert group.make_substeps()
        radius = perimeter / (2 * math.pi)
        found.append(_turned_back(contents(group.states[0])[0], turned / radius, radius))
    assert np.abs(found[0] - found[1]).max() < 1e-10


@pytest.mark.parametrize("side", ["inside", "outside"])
def test_sections_of_a_tube(side):
    """At the start the apical layer is a circle, too: areas by its radius, but for the polygon."""
    frame = simulate(
        published(**RING | {"layer.side": side, "layer.perimeter": "100 R_soft", "tissue.cells": 300})
    ).frames[0]
    r = 100 / (2 * math.pi)
    apical = r - 8 if side == "inside" else r + 8
    found = areas(frame)
    expected = math.pi * min(r, apical) ** 2, math.pi * abs(r**2 - apical**2)
    assert found == pytest.approx(expected, rel=2e-3)
    assert ab_positions(frame).min() > 0
    assert ab_positions(frame).max() < 1


@pytest.mark.parametrize("side", ["inside", "outside"])
def test_kernels_measure_what_tables_do(side):
    """y_AB of EMT cells, the lowest of the others and how many are outside; heights of the layers."""
    emt = {"emt.cells": 3, "emt.a": "1 h", "emt.b": "2 h"}
    run = simulate(published(**RING | emt | {"layer.side": side, "layer.perimeter": "100 R_soft", "tissue.cells": 300}))
    frame, past = run.final, run.final.past
    curve = curve_numbers(frame.curve)
    held = new_state(
        frame.cells, frame.layers, emt=past.emt, capacity=len(frame.cells.x), curve=curve, space=in_plane()
    )
    positions, controls, extents = np.zeros(3), np.zeros(4), np.zeros(len(EXTENTS))
    measure(held, positions, controls)
    measure_extents(held, extents)
    expected, mine = ab_positions(frame), frame.cells.emt >= 0
    np.testing.assert_allclose(positions, expected[mine], rtol=0, atol=1e-10)
    others = expected[~mine]
    np.testing.assert_allclose(
        controls, [len(others), (others > 1).sum(), (others < 0).sum(), others.min()], rtol=0, atol=1e-10
    )
    np.testing.assert_allclose(extents[:2], [height(frame), nucleus_height(frame)], rtol=0, atol=1e-10)


def test_a_lumen_that_closes_ends_the_run():
    run = simulate(published(**RING | {"numerics.t_end": "24 h"}), throw=False)
    assert run.status is Status.LUMEN_CLOSED
    assert "opposite parts of the apical layer" in run.detail
    assert 0 < run.final.t < 24
    outside = simulate(published(**RING, **{"layer.side": "outside"}), throw=False)
    assert outside.status is Status.SUCCESS
