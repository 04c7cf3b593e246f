"""The tissue to scale, in um: discs, springs, layers; control cells in the colour of their cycle phase, EMT cells in
that of their events; named types by their edges.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from dincl.errors import InvalidProblem
from tissue.files.parameters import Parameters
from tissue.frames.frame import Frame
from tissue.frames.observables import is_measurable
from tissue.frames.section import section
from tissue.pictures.emt import event_colours
from tissue.pictures.sheet import (
    ENTRY,
    LINE,
    TYPE_COLOURS,
    Axes,
    Figure,
    FigureCanvasAgg,
    add_legend,
    legend_entries,
    style,
)
from tissue.pictures.state import draw_basal_layer, draw_state
from tissue.state.cells import NAMED

if TYPE_CHECKING:
    from tissue.state.basal_curve import BasalCurve


# Inches: a picture, its panels at most, one of many, and what stands around them.
WIDTH, TALLEST, LEAST = 9.2, 7.0, 2.3
BESIDE, ABOVE, BELOW = 0.75, 0.35, 0.55
TITLE, PANEL = 3.4, 2.8  # inches, of the title of a panel, and of a panel beside others at least
COLUMNS = 3
DPI = 200
MOVIE_DPI = 100
MARGIN = 2.0  # um around the discs


class Box(NamedTuple):
    """Extent of a panel [um]."""

    left: float
    right: float
    low: float
    high: float


def drawing(frames: Sequence[Frame], parameters: Parameters, width: float = WIDTH) -> Figure:
    """Draw one or several states in one scale, side by side, three in a row.

    Parameters
    ----------
    frames
        At least one, of one run, or of several with the same basal layer and types.
    parameters
        Of the run: the soft radius and the lengths of the phases.
    width
        Of the figure at most [in].

    Raises
    ------
    InvalidProblem
        For no frame at all, or one with coordinates that are not finite.
    """
    with style():
        figure, panels = _sheet(frames, len(frames), parameters, width)
        for panel, state in zip(panels, frames, strict=True):
            draw_state(panel, state, parameters, _decimals(frames), event_colours(frames))
    return figure


def draw_frame(panel: Axes, frame: Frame, parameters: Parameters) -> None:
    """Draw one state into axes of your own, without a legend; errors are those of ``drawing``."""
    shown = section(frame)
    with style():
        _set_axes(panel, box_of([shown], parameters), shown.curve, parameters)
        panel.set(xlabel="x [µm]", ylabel="y [µm]")
        draw_state(panel, frame, parameters, _decimals([frame]), event_colours([frame]))


def stills(
    frames: Sequence[Frame], parameters: Parameters, width: float = WIDTH, *, with_legend: bool = True
) -> Iterator[NDArray[np.uint8]]:
    """Give pictures of the frames one after the other, all of one scale and size: red, green, blue of shape (h, w, 3).

    Arguments and errors are those of ``drawing``.
    """
    with style():
        figure, (panel,) = _sheet(frames, 1, parameters, width, with_legend=with_legend)
        figure.set_dpi(MOVIE_DPI)
        canvas: Any = FigureCanvasAgg(figure)
        canvas.draw()
        figure.set_layout_engine("none")  # nothing moves from here on
    background, decimals, events = canvas.copy_from_bbox(figure.bbox), _decimals(frames), event_colours(frames)
    for state in frames:
        canvas.restore_region(background)
        with style():
            for artist in draw_state(panel, state, parameters, decimals, events):
                panel.draw_artist(artist)
                artist.remove()
        yield np.asarray(canvas.buffer_rgba())[:, :, :3].copy()


def box_of(frames: Sequence[Frame], parameters: Parameters) -> Box:
    """Find the box around the soft discs and all points of all frames."""
    if not frames:
        raise InvalidProblem("frames is empty: must have one, to be drawn")
    lows, highs = [], []
    for frame in frames:
        if not is_measurable(frame):
            raise InvalidProblem(f"frame of t = {frame.t:g} h: must have finite coordinates, to be drawn")
        cells = frame.cells
        for x, y, r in ((cells.x, cells.y, 1.0), (cells.ax, cells.ay, 0.0), (cells.bx, cells.by, 0.0)):
            lows.append((x.min() - r, y.min() - r))
            highs.append((x.max() + r, y.max() + r))
    um = parameters.cell.soft_radius.value
    left, low = um * np.min(lows, axis=0) - MARGIN
    right, high = um * np.max(highs, axis=0) + MARGIN
    return Box(left, right, low, high)


def _sheet(
    frames: Sequence[Frame],
    count: int,
    parameters: Parameters,
    most: float,
    *,
    with_legend: bool = True,
) -> tuple[Figure, list[Axes]]:
    """Make a figure with ``count`` panels of one scale, as large as fit into ``most`` inches, and the legend below."""
    shown = [section(frame) for frame in frames]
    box = box_of(shown, parameters)
    across = min(COLUMNS, count, max(1, int(most / PANEL)))
    rows = -(-count // across)
    columns = -(-count // rows)
    ratio = (box.high - box.low) / (box.right - box.left)
    wide = min((most - BESIDE) / columns, max(LEAST, TALLEST / rows) / ratio)
    width = _whole_pixels(min(most, BESIDE + columns * max(wide, TITLE)))
    kinds = sorted({k for frame in frames for k in frame.cells.kind.tolist() if k >= NAMED})
    types = {parameters.type_names[k]: TYPE_COLOURS[k - NAMED] for k in kinds}
    entries = legend_entries(event_colours(frames), types) if with_legend else {}
    legend_columns = max(1, min(len(entries), int(width / ENTRY)))
    lines = -(-len(entries) // legend_columns)
    height = _whole_pixels(rows * (wide * ratio + ABOVE) + BELOW + LINE * lines)
    figure = Figure(figsize=(width, height), dpi=DPI, layout="compressed")
    grid = figure.subplots(rows, columns, squeeze=False, sharex=True, sharey=True)
    for row in grid:
        row[0].set_ylabel("y [µm]")
    for column in grid.T:
        column[-1].set_xlabel("x [µm]")
    panels = grid.ravel().tolist()
    for k in range(count, len(panels)):
        panels[k].remove()
        panels[k - columns].set_xlabel("x [µm]")
        panels[k - columns].tick_params(labelbottom=True)
    for panel in panels[:count]:
        _set_axes(panel, box, shown[0].curve, parameters)
        panel.set_title(" ", fontsize=9.5)  # room for that of the state
    if entries:
        add_legend(figure, entries, legend_columns)
    return figure, panels[:count]


def _set_axes(panel: Axes, box: Box, curve: BasalCurve, parameters: Parameters) -> None:
    panel.set(xlim=(box.left, box.right), ylim=(box.low, box.high), aspect="equal")
    draw_basal_layer(panel, curve, parameters.cell.soft_radius.value)


def _whole_pixels(inches: float) -> float:
    return round(inches * MOVIE_DPI) / MOVIE_DPI


def _decimals(frames: Sequence[Frame]) -> int:
    """Count the decimals that the times need, at most two."""
    times = np.array([frame.t for frame in frames])
    return next((k for k in (0, 1) if np.allclose(times, np.round(times, k), rtol=0, atol=1e-6)), 2)
