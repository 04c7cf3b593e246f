"""Measurements of a tissue at one time: height, widths, the apical-basal scale, phases; lengths in R_soft."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dincl.checks import bounded
from dincl.errors import InvalidProblem
from tissue.kernels import kernel
from tissue.model.scale import position_in_space
from tissue.state.cells import COORDINATES, DEPTHS, CellLayers, Cells, Floats, Integers
from tissue.state.mesh import Sheets, network_of
from tissue.state.running import CELLS, TissueState, new_state
from tissue.state.space import SPATIAL, no_space

if TYPE_CHECKING:
    from tissue.frames.frame import Frame
    from tissue.state.numbers import Numbers


def positions_in_space(cells: Cells, sheets: Sheets) -> Floats:
    """Compute y_AB of all cells, (n,); see ``tissue.model.scale``."""
    n = len(cells.x)
    space = no_space()._replace(dimension=SPATIAL, surface=sheets.surface, apical=network_of(sheets.apical, n))
    found = np.empty(n)
    _measure_all(new_state(cells, capacity=n, space=space), found)
    return found


@kernel
def _measure_all(state: TissueState, found: Floats) -> None:
    for i in range(state.sizes[CELLS]):
        found[i] = position_in_space(state, i)


def basal_area(cells: Cells, sheets: Sheets) -> float:
    """Return the area of all triangles of the basal network [R_soft^2]."""
    points = np.column_stack((cells.bx, cells.by, cells.bz))[sheets.basal.triangles]
    sides = points[:, 1:] - points[:, :1]
    for axis, period in ((0, sheets.surface.period_x), (2, sheets.surface.period_z)):
        if np.isfinite(period):
            sides[..., axis] -= period * np.round(sides[..., axis] / period)
    return float(np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1).sum() / 2)


def basal_length(cells: Cells, sheets: Sheets) -> float:
    """Return the length of all edges of the basal network of a strip, which has no periods [R_soft]."""
    i, j = sheets.basal.edges.T
    points = np.column_stack((cells.bx, cells.by, cells.bz))
    return float(np.linalg.norm(points[j] - points[i], axis=1).sum())


PHASES = ("G1/S", "G2", "mitosis")
# Soft discs have the radius R_soft = 1.
SOFT_DIAMETER = 2.0
# Distances between nuclei and junctions that are computed at once: 2 MB for each array of them.
BLOCK = 1 << 18


class Widths(NamedTuple):
    """Extents in x, from the leftmost to the rightmost point."""

    apical: float  # of the apical layer
    basal: float  # of the basal layer
    nuclei: float  # of the centres of all nuclei


class Areas(NamedTuple):
    """Measurements of the cross-section of a tube."""

    lumen: float  # what it encloses
    tissue: float


class Extruded(NamedTuple):
    """Numbers of cells outside of the tissue (4.3), counted over all cells."""

    apically: int  # y_AB > 1
    basally: int  # y_AB < 0


def is_measurable(frame: Frame) -> bool:
    """Return whether all coordinates are finite, and small enough for their squares to be so, too."""
    cells = frame.cells
    return all(bounded(getattr(cells, name)) for name in (*COORDINATES, *DEPTHS))


def measurable(frames: Iterable[Frame]) -> list[Frame]:
    """Return the frames that are: all but the last one of a run that left the finite numbers."""
    return [frame for frame in frames if is_measurable(frame)]


def height(frame: Frame) -> float:
    """Compute mean of h(A_i) over the cells of the apical layer, h the height above the basal layer: y above a line.

    The thesis plots the height (Figure 16 of chapter 3) without a definition; by this one it begins with the 8 R_soft
    of the figure.
    Raises InvalidProblem if the layer is empty.
    """
    cells, apical = frame.cells, _inhabited("apical", frame.layers)
    return float(frame.heights(cells.ax[apical], cells.ay[apical], cells.az[apical]).mean())


def nucleus_height(frame: Frame) -> float:
    """Compute mean of h(X_i) over all cells."""
    return float(frame.heights(frame.cells.x, frame.cells.y, frame.cells.z).mean())


def widths(frame: Frame) -> Widths:
    """Compute max x - min x of the apical layer, of the basal layer and of the nuclei.

    Raises InvalidProblem if a layer is empty.
    """
    cells = frame.cells
    apical, basal = (_inhabited(name, frame.layers) for name in CellLayers._fields)
    return Widths(*(float(np.ptp(x)) for x in (cells.ax[apical], cells.bx[basal], cells.x)))


def nuclear_layers(frame: Frame) -> float:
    """2 N / (max x - min x + 2): how many soft discs a vertical line crosses, on average over all that cross one.

    This counts the layers of nuclei, one above the other, that make the epithelium look stratified
    (section 2.2.9 of chapter 3). Where the layer bends: how many a normal crosses, by the feet of the nuclei. In space
    it is pi N over the area of the basal network, in a strip 2 N over its length.
    """
    n, curve = len(frame.cells.x), frame.curve
    if frame.sheets is not None:
        if not len(frame.sheets.basal.triangles):
            return SOFT_DIAMETER * n / basal_length(frame.cells, frame.sheets)
        return float(math.pi * n / basal_area(frame.cells, frame.sheets))
    if curve.ring:
        return SOFT_DIAMETER * n / curve.length
    feet = curve.feet(frame.cells.x, frame.cells.y)
    return float(SOFT_DIAMETER * n / (np.ptp(feet) + SOFT_DIAMETER))


def areas(frame: Frame) -> Areas:
    """Return the cross-sections of a tube: what the inner one of its two layers encloses, and what is between both.

    The basal layer is the curve, the apical layer the polygon of its points. Raises InvalidProblem if the tissue is not
    closed.
    """
    curve, cells, apical = frame.curve, frame.cells, _inhabited("apical", frame.layers)
    if not curve.ring:
        raise InvalidProblem("the tissue is open: must be a ring, to enclose an area")
    x, y = cells.ax[apical], cells.ay[apical]
    within = float((x * np.roll(y, -1) - np.roll(x, -1) * y).sum() / 2)
    return Areas(within, curve.area - within) if curve.area > 0 else Areas(-curve.area, curve.area - within)


def phases(frame: Frame, numbers: Numbers, named: Sequence[Numbers] = ()) -> Integers:
    """Compute the index into PHASES for each cell, (n,), from its age t - t_birth (section 2.2.1 of chapter 3).

    G2 stands for its active part: t_age >= t_cycle - T_G2 - T_mitosis; mitosis begins at t_cycle - T_mitosis.
    ``named``: the numbers of the named types of cells.
    """
    age, cycle = frame.t - frame.cells.birth, frame.cells.cycle
    g2, mitosis = np.array([(one.g2, one.mitosis) for one in (numbers, numbers, *named)])[frame.cells.kind].T
    late = age >= cycle - g2 - mitosis
    found: Integers = late.astype(np.int64) + (age >= cycle - mitosis)
    return found


def ab_positions(frame: Frame) -> Floats:
    r"""y_AB(X_i) = h(X_i) / h(A_i^ref): 0 at the basal, 1 at the apical layer, shape (n,).

    h is the height above the basal layer along its normal, y above a line. Source: section 3.3.1 of chapter 4.

    A_i^ref is the point of the apical layer, a path of lines through the apical points, that is nearest to X_i.

    Raises
    ------
    InvalidProblem
        If the apical layer is empty, or its point nearest to a nucleus lies on the basal line.
    """
    cells, apical = frame.cells, _inhabited("apical", frame.layers)
    if frame.sheets is not None:
        return positions_in_space(cells, frame.sheets)
    if frame.curve.ring:
        apical = np.append(apical, apical[0])
    path_x, path_y = cells.ax[apical], cells.ay[apical]
    blocks = range(0, len(cells.x), max(1, BLOCK // len(apical)))
    step = blocks.step
    parts = [_nearest(cells.x[k : k + step], cells.y[k : k + step], path_x, path_y) for k in blocks]
    reference = frame.curve.heights(*np.concatenate(parts, axis=1))
    level = np.flatnonzero(reference == 0)
    if level.size:
        raise InvalidProblem(
            f"cell {cells.id[level[0]]}: the point of the apical layer nearest to its nucleus is at height 0: must be "
            "off the basal layer, to measure positions between the two"
        )
    positions: Floats = frame.curve.heights(cells.x, cells.y) / reference
    return positions


def extruded(positions: Floats) -> Extruded:
    """Count the positions y_AB (n,) above 1 and below 0  (4.3)."""
    return Extruded(int((positions > 1).sum()), int((positions < 0).sum()))


def _inhabited(name: str, layers: CellLayers) -> Integers:
    layer: Integers = getattr(layers, name)
    if not layer.size:
        raise InvalidProblem(f"layers.{name} is empty: must have a cell, to be measured")
    return layer


def _nearest(x: Floats, y: Floats, path_x: Floats, path_y: Floats) -> Floats:
    """Return the point of the path (m,) that is nearest to each point x, y (n,), the first one of several: (2, n)."""
    if len(path_x) == 1:
        return np.stack((np.full(len(x), path_x[0]), np.full(len(x), path_y[0])))
    along_x, along_y = np.diff(path_x), np.diff(path_y)
    square = along_x**2 + along_y**2
    away_x, away_y = x[:, None] - path_x[:-1], y[:, None] - path_y[:-1]
    part = away_x * along_x + away_y * along_y
    part = np.divide(part, square, out=np.zeros_like(part), where=square > 0).clip(0.0, 1.0)  # two points in one place
    nearest = np.argmin((away_x - part * along_x) ** 2 + (away_y - part * along_y) ** 2, axis=1)
    part = part[np.arange(len(x)), nearest]
    return np.stack((path_x[nearest] + part * along_x[nearest], path_y[nearest] + part * along_y[nearest]))
