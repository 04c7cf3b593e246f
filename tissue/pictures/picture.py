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


# Inches: a picture, its panel at most, its title, and what stands around them.
WIDTH, TALLEST, TITLE = 9.2, 7.0, 3.4
BESIDE, ABOVE, BELOW = 0.75, 0.35, 0.55
DPI = 200
MOVIE_DPI = 100
MARGIN = 2.0  # um around the discs


class Box(NamedTuple):
    """Extent of a panel [um]."""

    left: float
    right: float
    low: float
    high: float


def drawing(frame: Frame, parameters: Parameters) -> Figure:
    """Draw one state of a run with these parameters; raises InvalidProblem for coordinates that are not finite."""
    with style():
        figure, panel = _sheet([frame], parameters, WIDTH)
        draw_state(panel, frame, parameters, _decimals([frame]), event_colours([frame]))
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

    The frames are at least one, of one run; ``width`` of the figure at most [in]. Raises InvalidProblem for no frame at
    all, or one with coordinates that are not finite.
    """
    with style():
        figure, panel = _sheet(frames, parameters, width, with_legend=with_legend)
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
    frames: Sequence[Frame], parameters: Parameters, most: float, *, with_legend: bool = True
) -> tuple[Figure, Axes]:
    """Make a figure for states of one scale, as large as fits into ``most`` inches, with the legend below."""
    shown = [section(frame) for frame in frames]
    box = box_of(shown, parameters)
    ratio = (box.high - box.low) / (box.right - box.left)
    wide = min(most - BESIDE, TALLEST / ratio)
    width = _whole_pixels(min(most, BESIDE + max(wide, TITLE)))
    kinds = sorted({k for frame in frames for k in frame.cells.kind.tolist() if k >= NAMED})
    types = {parameters.type_names[k]: TYPE_COLOURS[k - NAMED] for k in kinds}
    entries = legend_entries(event_colours(frames), types) if with_legend else {}
    legend_columns = max(1, min(len(entries), int(width / ENTRY)))
    lines = -(-len(entries) // legend_columns)
    height = _whole_pixels(wide * ratio + ABOVE + BELOW + LINE * lines)
    figure = Figure(figsize=(width, height), dpi=DPI, layout="compressed")
    panel = figure.subplots()
    panel.set(xlabel="x [µm]", ylabel="y [µm]")
    _set_axes(panel, box, shown[0].curve, parameters)
    panel.set_title(" ", fontsize=9.5)  # room for that of the state
    if entries:
        add_legend(figure, entries, legend_columns)
    return figure, panel


def _set_axes(panel: Axes, box: Box, curve: BasalCurve, parameters: Parameters) -> None:
    panel.set(xlim=(box.left, box.right), ylim=(box.low, box.high), aspect="equal")
    draw_basal_layer(panel, curve, parameters.cell.soft_radius.value)


def _whole_pixels(inches: float) -> float:
    return round(inches * MOVIE_DPI) / MOVIE_DPI


def _decimals(frames: Sequence[Frame]) -> int:
    """Count the decimals that the times need, at most two."""
    times = np.array([frame.t for frame in frames])
    return next((k for k in (0, 1) if np.allclose(times, np.round(times, k), rtol=0, atol=1e-6)), 2)
