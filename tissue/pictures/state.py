"""One state of a tissue and its basal layer, drawn into axes whose scale is set [um]."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from tissue.files.parameters import Parameters
from tissue.frames.frame import Frame
from tissue.frames.observables import state_of
from tissue.frames.section import cut_of, section
from tissue.model.measures import measure
from tissue.pictures.emt import chains, free_points
from tissue.pictures.sheet import (
    APICAL,
    BASAL,
    BELOW,
    CHAIN,
    CROSS,
    DOT,
    SOFT,
    SPRING,
    Artist,
    Axes,
    EllipseCollection,
    LineCollection,
    colours_of_cells,
)
from tissue.state.cells import NAMED

if TYPE_CHECKING:
    from tissue.state.basal_curve import BasalCurve
    from tissue.state.cells import Floats


POINTS = 721  # of a basal layer that bends
FULL, THINNEST = 3.5, 0.25  # points per um from which on lines have their full width; what is left of it at least
LEAST_CROSS = 0.6  # of the size of the crosses


def draw_basal_layer(panel: Axes, curve: BasalCurve, um: float) -> None:
    """Draw the curve, and in grey the side without tissue; of an open curve that bends the curve alone."""
    low, high = panel.get_ylim()
    if curve.pieces == 0:
        panel.axhspan(low, 0.0, color=BELOW, linewidth=0, zorder=0)
        panel.axhline(0.0, color=BASAL, linewidth=1.2, zorder=1)
        return
    x, y = um * curve.evaluate(np.linspace(0.0, curve.length, POINTS) - curve.origin)[0]
    panel.plot(x, y, color=BASAL, linewidth=1.2, zorder=1)
    if curve.around:
        inside = curve.area > 0
        panel.axhspan(low, high, color=BELOW if inside else "white", linewidth=0, zorder=0)
        panel.fill(x, y, color="white" if inside else BELOW, linewidth=0, zorder=0.5)


def draw_state(
    panel: Axes, state: Frame, parameters: Parameters, decimals: int, events: Mapping[str, str]
) -> list[Artist]:
    """Draw one state, from below to above; of a tissue in space its section, and the apical layer where it is cut.

    ``decimals`` of the time; ``events``: colours of the sets of events.
    """
    frame, cut = section(state), cut_of(state)
    um, cells = parameters.cell.soft_radius.value, frame.cells
    nuclei, apical, basal = (
        um * np.column_stack(xy) for xy in ((cells.x, cells.y), (cells.ax, cells.ay), (cells.bx, cells.by))
    )
    colours, edges = colours_of_cells(frame, parameters, events)
    thin = _thinner(panel)
    soft, widths = np.full(len(nuclei), um), np.where(cells.kind < NAMED, 0.4, 1.2)
    springs = np.stack((apical, nuclei, basal), axis=1)
    collections = [
        _discs(panel, nuclei, soft, facecolors=colours, alpha=SOFT, linewidths=0, zorder=2),
        _discs(panel, nuclei, soft, facecolors="none", edgecolors=colours, linewidths=0.5 * thin, zorder=2),
        LineCollection(list(springs), colors=SPRING, linewidths=0.7 * thin, alpha=0.55, zorder=3),
        _discs(
            panel, nuclei, um * cells.radius, facecolors=colours, edgecolors=edges, linewidths=thin * widths, zorder=4
        ),
    ]
    if joined := [apical[members] for members in chains(frame)]:
        collections.append(LineCollection(joined, colors=APICAL, zorder=5, **CHAIN))
    if cut is not None:
        collections.append(LineCollection(list(um * cut), colors=APICAL, linewidths=1.5 * thin, zorder=5))
    for collection in collections:
        panel.add_collection(collection)
    dots = DOT | {"markersize": DOT["markersize"] * thin, "zorder": 5}
    crosses = CROSS | {"markersize": CROSS["markersize"] * max(thin, LEAST_CROSS), "zorder": 6}
    free_apical, free_basal = free_points(frame)
    layer = frame.layers.apical
    path = apical[np.append(layer, layer[: frame.curve.ring])]
    line = {"linewidth": 1.5 * thin} if cut is None else {"linestyle": "none"}
    lines = panel.plot(*path.T, color=APICAL, **line, **dots)
    lines += panel.plot(*basal[~free_basal].T, color=BASAL, linestyle="none", **dots)
    lines += panel.plot(*apical[free_apical].T, color=APICAL, **crosses)
    lines += panel.plot(*basal[free_basal].T, color=BASAL, **crosses)
    part = "" if cut is None else f"{len(cells.x)} of "
    title = title_of(state, parameters, decimals, part)
    return [*collections, *lines, panel.annotate(title, (0, 1), (0, 6), "axes fraction", "offset points", size=9.5)]


def title_of(state: Frame, parameters: Parameters, decimals: int, part: str = "") -> str:
    """Return time, cells, and the height, or that the apical layer is folded; ``part`` stands before the cells."""
    number, found = len(state.cells.x), measure(state_of(state))
    height = parameters.cell.soft_radius.value * found.extents.height
    last = f"folded: {found.fold}" if found.fold else f"height {height:.3g} µm"
    return f"t = {state.t:.{decimals}f} h · {part}{number} cell{'s' * (number != 1)} · {last}"


def _thinner(panel: Axes) -> float:
    """Return the factor of line widths in a small scale, so that lines do not hide what they join."""
    figure, (left, right) = panel.get_figure(root=True), panel.get_xlim()
    if figure is None:  # axes that were removed
        return 1.0
    points = 72 * float(figure.get_size_inches()[0]) * panel.get_position().width
    return min(1.0, max(THINNEST, math.sqrt(points / (right - left) / FULL)))


def _discs(panel: Axes, centres: Floats, radii: Floats, **look: Any) -> EllipseCollection:
    """Make discs to scale, centres (n, 2), radii (n,)."""
    sizes = 2 * radii
    return EllipseCollection(
        sizes, sizes, np.zeros(len(sizes)), units="xy", offsets=centres, offset_transform=panel.transData, **look
    )
