"""Measurements of a tissue at one time: heights, widths, positions on the apical-basal scale, and whether they mean
anything. Slices and sheets, frames and running tissues are measured by the same code.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from dincl.compiled import inner
from tissue.kernels import kernel
from tissue.kernels.curve import evaluate, foot_of
from tissue.model.apical_tree import ApicalTree, apical_tree, corner, crossings, nearest_point, winding
from tissue.model.extents import height_above
from tissue.model.scale import Point, beyond_apical, dot, minus
from tissue.network.neighbours import basal_points, fresh_triangles
from tissue.state.cells import Flags, Floats, Integers
from tissue.state.running import APICAL, BASAL, CELLS, IN_SPACE, ON_CURVE, ON_LINE, Kind, TissueState, kind_of
from tissue.state.space import FLAT
from tissue.state.surface import Surface, differences, normal

# Soft discs have the radius R_soft = 1.
SOFT_DIAMETER = 2.0
# Where height and positions lose their meaning. In 40 to 140 runs of each preset, measured each hour, loops are up to
# 3.6 R_soft long, 23 % run backwards, the layer is up to twice as long as the tissue, and 17 % of the control cells are
# outside; in slices of 180 cells 26 % run backwards.
# A loop moves the nearest apical point by half of its length, at most: by the width of a nucleus.
LONGEST_LOOP = 2.0 * SOFT_DIAMETER
# Where a third runs backwards, another third runs forwards above the same basal points: the height of two thirds is no
# function of the place.
MOST_BACKWARD = 1 / 3
# As long as a layer that lies three times above each place.
MOST_STRETCH = 3.0
# Control cells are what positions of EMT cells are compared with: they are in the tissue, but for few.
MOST_OUTSIDE = 0.25
# Where so little of a periodic sheet has an apical layer above it, its height is that of the rest.
LEAST_COVERED = 0.5


class Extents(NamedTuple):
    """Heights above the basal layer, and extents in x or, where the tissue is periodic in x, the period [R_soft].

    ``nuclear_layers`` counts the nuclei one above the other that make the epithelium look stratified (section 2.2.9 of
    chapter 3): 2 N/(max x - min x + 2) soft discs cross a vertical line, on average over all that cross one. Where the
    layer bends, these are lines along its normals; in space it is pi N over the area of the basal network.
    """

    height: float  # mean of the apical points of the apical layer
    nucleus_height: float  # mean of all nuclei
    apical_width: float  # of the apical layer
    basal_width: float  # of the basal layer
    nuclei_width: float  # of the centres of all nuclei
    nuclear_layers: float  # nuclei one above the other, on average


class Positions(NamedTuple):
    """Positions of all nuclei between the layers, (n,)."""

    y_ab: Floats  # position on the apical-basal scale (section 3.3.1 of chapter 4); not finite where it has no value
    apically: Flags  # beyond the apical layer: y_AB > 1; in a tube in its lumen, or outside of it
    basally: Flags  # y_AB < 0, and not beyond the apical layer
    looks: int  # boxes of the tree that were looked at


class Folds(NamedTuple):
    """How the apical layer lies above the basal layer: what y_AB and the height need to mean anything."""

    crossings: int  # pairs of junctions, or of triangles, of the apical layer that cross
    loop: float  # length of the longest loop that a crossing closes [R_soft]; inf between triangles
    backward: float  # part of its length, or area, that runs backwards above the basal layer
    stretch: float  # its length, or area, over the larger one of the basal layer and of its projection on that
    lowest: float  # lowest height of an apical point [R_soft]
    covered: float  # the part of a plane with two periods that the apical layer covers; 1 of other layers
    looks: int  # boxes of the tree that were looked at


class Measures(NamedTuple):
    """All measurements of a tissue at one time."""

    extents: Extents
    positions: Positions
    folds: Folds
    controls: Flags  # which cells are control cells, (n,): all but those of [emt] and their daughters

    @property
    def controls_outside(self) -> float:
        """The share of control cells that are outside of the tissue; 0 without any."""
        outside = (self.positions.apically | self.positions.basally)[self.controls]
        return float(outside.mean()) if len(outside) else 0.0

    @property
    def shape(self) -> tuple[float, ...]:
        """Nuclear layers, crossings, backward part and stretch, which studies store beside the extents."""
        return self.extents.nuclear_layers, self.folds.crossings, self.folds.backward, self.folds.stretch

    @property
    def fold(self) -> str:
        """Why height and positions mean nothing, in words; "" where they do."""
        folds, outside = self.folds, self.controls_outside
        if folds.lowest <= 0.0:
            return "the apical layer reaches the basal layer"
        if folds.loop > LONGEST_LOOP:
            return "the apical layer crosses itself"
        if folds.backward > MOST_BACKWARD:
            return f"{folds.backward:.0%} of the apical layer runs backwards"
        if folds.stretch > MOST_STRETCH:
            return f"the apical layer is {folds.stretch:.1f} times as long as the tissue"
        if folds.covered < LEAST_COVERED:
            return f"the apical layer covers {folds.covered:.0%} of the tissue"
        if outside > MOST_OUTSIDE:
            return f"{outside:.0%} of the control cells are outside of the layers"
        return ""


def measure(state: TissueState) -> Measures:
    """Measure a tissue; the apical layer must have a cell."""
    tree = apical_tree(state)
    controls: Flags = state.cells.emt[: state.sizes[CELLS]] < 0
    return Measures(measure_extents(state), measure_positions(state, tree), measure_folds(state, tree), controls)


def measure_extents(state: TissueState) -> Extents:
    """Measure heights and widths; the apical layer must have a cell."""
    found = np.empty(len(Extents._fields))
    _measure_extents(state, _basal_triangles(state), found, kind_of(state))
    return Extents._make(found.tolist())


@kernel
def _measure_extents(state: TissueState, basal: Integers, found: Floats, kind: Kind) -> None:
    cells, layers, n = state.cells, state.layers, state.sizes[CELLS]
    period = state.space.surface.period_x
    low, high, total = math.inf, -math.inf, 0.0
    for k in range(state.sizes[APICAL]):
        i = layers.apical[k]
        height = height_above(state, cells.ax[i], cells.ay[i], cells.az[i], kind)
        low, high, total = min(low, cells.ax[i]), max(high, cells.ax[i]), total + height
    found[0], found[2] = total / state.sizes[APICAL], _width(low, high, period)
    low, high = math.inf, -math.inf
    for k in range(state.sizes[BASAL]):
        i = layers.basal[k]
        low, high = min(low, cells.bx[i]), max(high, cells.bx[i])
    found[3] = _width(low, high, period)
    low, high, total = math.inf, -math.inf, 0.0
    for i in range(n):
        height = height_above(state, cells.x[i], cells.y[i], cells.z[i], kind)
        low, high, total = min(low, cells.x[i]), max(high, cells.x[i]), total + height
    found[1], found[4] = total / n, _width(low, high, period)
    found[5] = _nuclear_layers(state, basal, high - low, kind)


@inner
def _nuclear_layers(state: TissueState, basal: Integers, extent: float, kind: Kind) -> float:
    """2 N / (max s - min s + 2), s the arclength of the feet of the nuclei: x above a line, with the extent in x.

    In a tube it is 2 N over the length of the basal layer, in space pi N over the area of the basal triangles.
    """
    n, curve = float(state.sizes[CELLS]), state.curve
    layers: float
    if len(kind) == IN_SPACE:
        layers = math.pi * n / _basal_area(state, basal)
        return layers
    if curve.ring > 0.0:
        layers = SOFT_DIAMETER * n / curve.ring
        return layers
    if len(kind) == ON_CURVE:
        low, high, length = math.inf, -math.inf, curve.pieces / curve.per_length
        for i in range(state.sizes[CELLS]):
            s = foot_of(curve, state.cells.x[i], state.cells.y[i])
            s = s - length * np.rint(s / length) if curve.around else s
            low, high = min(low, s), max(high, s)
        extent = high - low
    layers = SOFT_DIAMETER * n / (extent + SOFT_DIAMETER)
    return layers


@inner
def _width(low: float, high: float, period: float) -> float:
    if period < math.inf:
        return period
    return high - low if high >= low else math.nan  # of a layer without cells


def measure_positions(state: TissueState, tree: ApicalTree) -> Positions:
    """Measure y_AB of all nuclei, and which of them are outside of the tissue; ``tree`` is that of the same state."""
    n, looks = int(state.sizes[CELLS]), int(tree.looks[0])
    y_ab, outside = np.empty(n), np.zeros((2, n), np.bool_)
    _measure_positions(state, tree, y_ab, outside, kind_of(state))
    return Positions(y_ab, outside[0], outside[1], int(tree.looks[0]) - looks)


@kernel
def _measure_positions(state: TissueState, tree: ApicalTree, y_ab: Floats, outside: Flags, kind: Kind) -> None:
    cells = state.cells
    for i in range(state.sizes[CELLS]):
        x, y, z = cells.x[i], cells.y[i], cells.z[i]
        nearest = nearest_point(tree, x, y, z, kind)
        height = height_above(state, x, y, z, kind)
        y_ab[i] = height / height_above(state, nearest[0], nearest[1], nearest[2], kind)
        outside[0, i], outside[1, i] = y_ab[i] > 1.0, y_ab[i] < 0.0
        if len(kind) == ON_CURVE and state.curve.ring > 0.0:
            outside[0, i] = beyond_apical(state, winding(tree, x, y))
            outside[1, i] = height < 0.0 and not outside[0, i]


def measure_folds(state: TissueState, tree: ApicalTree) -> Folds:
    """Measure how the apical layer lies above the basal layer; ``tree`` is that of the same state."""
    found, reach, looks = np.empty(6), np.zeros(len(tree.numbers) + 1), int(tree.looks[0])
    _measure_folds(state, tree, _basal_triangles(state), reach, found, kind_of(state))
    loop, backward, stretch, lowest, covered = found[1:].tolist()
    return Folds(int(found[0]), loop, backward, stretch, lowest, covered, int(tree.looks[0]) - looks)


@kernel
def _measure_folds(
    state: TissueState, tree: ApicalTree, triangles: Integers, reach: Floats, found: Floats, kind: Kind
) -> None:
    cells, lowest = state.cells, math.inf
    for k in range(state.sizes[APICAL]):
        i = state.layers.apical[k]
        lowest = min(lowest, height_above(state, cells.ax[i], cells.ay[i], cells.az[i], kind))
    found[0], found[1], found[4] = 0.0, 0.0, lowest
    if len(kind) != IN_SPACE:
        apical, backward, net = _apical_path(state, tree, reach, kind)
        basal = _basal_path(state)
    else:
        apical, backward, net = _apical_area(state.space.surface, tree)
        basal = _basal_area(state, triangles)
    # What runs forward alone, above a line, does not cross itself.
    if backward > 0.0 or (apical > 0.0 and len(kind) != ON_LINE):
        found[0], found[1] = crossings(tree, reach, kind)
    found[2] = backward / apical if apical > 0.0 else 0.0
    surface = state.space.surface
    period = surface.period_x * surface.period_z
    found[5] = net / period if period < math.inf else 1.0
    below = max(basal, net)
    # A single cell has no length, and is not stretched.
    found[3] = apical / below if below > 0.0 else math.inf if apical > 0.0 else 1.0


@inner
def _apical_path(state: TissueState, tree: ApicalTree, reach: Floats, kind: Kind) -> tuple[float, float, float]:
    """Return the length of the apical layer of a slice, that of its junctions that run backwards, and how far it goes
    along the basal layer.

    ``reach`` becomes the length up to each junction. A junction runs backwards if it goes against the tangent of the
    basal layer below its middle.
    """
    total, backward, net, p = 0.0, 0.0, 0.0, tree.points
    for k in range(len(tree.numbers)):
        along_x, along_y = p[k, 1, 0] - p[k, 0, 0], p[k, 1, 1] - p[k, 0, 1]
        length, forward = math.sqrt(along_x * along_x + along_y * along_y), along_x
        if len(kind) == ON_CURVE:
            s = foot_of(state.curve, 0.5 * (p[k, 0, 0] + p[k, 1, 0]), 0.5 * (p[k, 0, 1] + p[k, 1, 1]))
            _, _, tangent_x, tangent_y = evaluate(state.curve, s)
            forward = along_x * tangent_x + along_y * tangent_y
        total, net = total + length, net + forward
        reach[k + 1] = total
        backward += length if forward < 0.0 else 0.0
    return total, backward, net


@inner
def _basal_path(state: TissueState) -> float:
    """Return the length of the lines between neighbouring basal points, or of the closed basal layer."""
    cells, layer, total = state.cells, state.layers.basal, 0.0
    if state.curve.ring > 0.0:
        return state.curve.ring
    for k in range(state.sizes[BASAL] - 1):
        i, j = layer[k], layer[k + 1]
        total += math.hypot(cells.bx[j] - cells.bx[i], cells.by[j] - cells.by[i])
    return total


@inner
def _apical_area(surface: Surface, tree: ApicalTree) -> tuple[float, float, float]:
    """Return the area of the apical triangles, of those whose normal points towards the basal surface, and of the
    projection along the normals of the basal surface.
    """
    total, backward, net = 0.0, 0.0, 0.0
    for k in range(len(tree.numbers)):
        a, b, c = corner(tree, k, 0), corner(tree, k, 1), corner(tree, k, 2)
        across = _cross_product(minus(b, a), minus(c, a))
        n = normal(surface, (a[0] + b[0] + c[0]) / 3.0, (a[1] + b[1] + c[1]) / 3.0, (a[2] + b[2] + c[2]) / 3.0)
        area = 0.5 * math.sqrt(dot(across, across))
        total, net = total + area, net + 0.5 * dot(across, n)
        backward += area if dot(across, n) < 0.0 else 0.0
    return total, backward, net


def _basal_triangles(state: TissueState) -> Integers:
    """Return the triangles of the basal layer of a tissue in space, (p, 3); none in a slice."""
    if state.space.dimension == FLAT:
        return np.empty((0, 3), np.int64)
    return fresh_triangles(state, *basal_points(state), state.space.basal)


@inner
def _basal_area(state: TissueState, triangles: Integers) -> float:
    """Return the area of all triangles of the basal layer."""
    cells, surface, area = state.cells, state.space.surface, 0.0
    for t in range(len(triangles)):
        i, j, k = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        one = differences(surface, cells.bx[j] - cells.bx[i], cells.by[j] - cells.by[i], cells.bz[j] - cells.bz[i])
        two = differences(surface, cells.bx[k] - cells.bx[i], cells.by[k] - cells.by[i], cells.bz[k] - cells.bz[i])
        across = _cross_product(one, two)
        area += 0.5 * math.sqrt(dot(across, across))
    return area


@inner
def _cross_product(a: Point, b: Point) -> Point:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]
