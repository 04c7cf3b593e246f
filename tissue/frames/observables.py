"""Measurements of a tissue at one time: height, widths, the apical-basal scale, phases; lengths in R_soft."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np

from dincl.checks import bounded
from dincl.errors import InvalidProblem
from tissue.model.apical_tree import apical_tree
from tissue.model.measures import Extents, Positions, measure_extents, measure_positions
from tissue.network.triangulation import triangulate
from tissue.state.basal_curve import curve_numbers
from tissue.state.cells import COORDINATES, DEPTHS, Floats, Integers
from tissue.state.running import TissueState, new_state
from tissue.state.space import SPATIAL, Space, network_of, no_space

if TYPE_CHECKING:
    from tissue.frames.frame import Frame
    from tissue.state.numbers import Numbers


def state_of(frame: Frame) -> TissueState:
    """Return a state with the cells, layers and networks of a frame, for kernels that measure it.

    Raises InvalidProblem if the apical layer is empty.
    """
    cells, sheets, n = frame.cells, frame.sheets, len(frame.cells.x)
    if not frame.layers.apical.size:
        raise InvalidProblem("layers.apical is empty: must have a cell, to be measured")
    space = no_space()
    if sheets is not None:
        apical, basal = network_of(sheets.apical, n), network_of(sheets.basal, n)
        space = Space(SPATIAL, sheets.surface, apical, basal, space.rules, sheets.longest)
    return new_state(cells, frame.layers, capacity=n, curve=curve_numbers(frame.curve), space=space)


def layer_area(frame: Frame, layer: Literal["apical", "basal"]) -> float:
    """Return the area of a layer in space: of all triangles of its points [R_soft^2].

    Raises InvalidProblem in a slice, or if the points have no triangulation.
    """
    if frame.sheets is None:
        raise InvalidProblem("frame.sheets = None: must be of a run in three dimensions, to have areas")
    surface, cells = frame.sheets.surface, getattr(frame.layers, layer)
    points = np.column_stack([getattr(frame.cells, layer[0] + axis)[cells] for axis in "xyz"])
    corners = points[triangulate(surface, points, frame.sheets.longest)[1]]
    sides = corners[:, 1:] - corners[:, :1]
    for axis, period in ((0, surface.period_x), (2, surface.period_z)):
        if np.isfinite(period):
            sides[..., axis] -= period * np.round(sides[..., axis] / period)
    return float(np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1).sum() / 2)


PHASES = ("G1/S", "G2", "mitosis")


class Areas(NamedTuple):
    """Measurements of the cross-section of a tube."""

    lumen: float  # what it encloses
    tissue: float


def is_measurable(frame: Frame) -> bool:
    """Return whether all coordinates are finite, and small enough for their squares to be so, too."""
    cells = frame.cells
    return all(bounded(getattr(cells, name)) for name in (*COORDINATES, *DEPTHS))


def measurable(frames: Iterable[Frame]) -> list[Frame]:
    """Return the frames that are: all but the last one of a run that left the finite numbers."""
    return [frame for frame in frames if is_measurable(frame)]


def extents(frame: Frame) -> Extents:
    """Measure heights above the basal layer, widths and nuclear layers; see ``Extents``.

    Raises InvalidProblem if the apical layer is empty.
    """
    return measure_extents(state_of(frame))


def height(frame: Frame) -> float:
    """Compute mean of h(A_i) over the cells of the apical layer, h the height above the basal layer: y above a line.

    The thesis plots the height (Figure 16 of chapter 3) without a definition; by this one it begins with the 8 R_soft
    of the figure.
    Raises InvalidProblem if the layer is empty.
    """
    return extents(frame).height


def areas(frame: Frame) -> Areas:
    """Return the cross-sections of a tube: what the inner one of its two layers encloses, and what is between both.

    The basal layer is the curve, the apical layer the polygon of its points. Raises InvalidProblem if the tissue is not
    closed.
    """
    curve, cells, apical = frame.curve, frame.cells, frame.layers.apical
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

    A_i^ref is the point of the apical layer that is nearest to X_i, the first one of several: the layer is a path of
    lines through the apical points, in space the triangles of the apical network.

    Raises
    ------
    InvalidProblem
        If the apical layer is empty, or its point nearest to a nucleus lies on the basal layer.
    """
    return positions(frame).y_ab


def positions(frame: Frame) -> Positions:
    """Return y_AB of all cells, and which of them are outside of the tissue (4.3); raises InvalidProblem likewise."""
    state = state_of(frame)
    found = measure_positions(state, apical_tree(state))
    level = np.flatnonzero(~np.isfinite(found.y_ab))
    if level.size:
        raise InvalidProblem(
            f"cell {frame.cells.id[level[0]]}: the point of the apical layer nearest to its nucleus is at height 0: "
            "must be off the basal layer, to measure positions between the two"
        )
    return found
