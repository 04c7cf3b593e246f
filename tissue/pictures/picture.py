"""The tissue to scale, in um: discs, springs, layers; control cells in the colour of their cycle phase, EMT cells in
that of their events; named types by their edges.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from os import PathLike
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from dincl.checks import instance, items
from dincl.checks import path as checked_path
from dincl.errors import InvalidProblem
from tissue.files.parameters import Parameters
from tissue.frames.frame import Frame
from tissue.frames.observables import is_measurable
from tissue.frames.section import section
from tissue.pictures.emt import EmtLook, look_of
from tissue.pictures.sheet import (
    LINE,
    TYPE_COLOURS,
    Axes,
    Figure,
    FigureCanvasAgg,
    control_entries,
    emt_entries,
    legend,
    legend_lines,
    style,
    type_entries,
    write,
)
from tissue.pictures.state import draw_basal_layer, draw_state
from tissue.state.cells import NAMED

if TYPE_CHECKING:
    from tissue.state.basal_curve import BasalCurve

MAKES_NO_NUMBERS = True

ENDINGS = (".png", ".svg", ".pdf")
# Inches: a picture, its panels at most, one of many, and what stands around them.
WIDTH, TALLEST, LEAST = 9.2, 7.0, 2.3
LEFT, RIGHT, TOP, GAP, BOTTOM = 0.7, 0.12, 0.32, 0.3, 0.48
COLUMNS = 3
TITLE = 3.2  # inches, of the title of a panel
DPI = 200
MOVIE_DPI = 100
MARGIN = 2.0  # um around the discs


class Box(NamedTuple):
    """Extent of a panel [um]."""

    left: float
    right: float
    low: float
    high: float


def picture(frames: Sequence[Frame], parameters: Parameters, path: str | PathLike[str]) -> None:
    """Draw one or several states in one scale, side by side, three in a row.

    Parameters
    ----------
    frames
        At least one, of one run.
    parameters
        Of the run: the soft radius and the lengths of the phases.
    path
        Where to write; the ending .png, .svg or .pdf says what.

    Raises
    ------
    InvalidProblem
        For another ending, no frame at all, or one with coordinates that are not finite.
    """
    frames = items("frames", frames, Frame, "a list of saved states")
    instance("parameters", parameters, Parameters, "those of the run")
    if checked_path("path", path).suffix.lower() not in ENDINGS:
        raise InvalidProblem(f"path = {str(path)!r}: must end in {', '.join(ENDINGS)}")
    write(drawing(frames, parameters), path)


def drawing(
    frames: Sequence[Frame], parameters: Parameters | Sequence[Parameters], box: Box | None = None, room: float = 0.0
) -> Figure:
    """Draw the figure that ``picture`` writes.

    Parameters
    ----------
    frames, parameters
        As in ``picture``; the frames may be of several runs on one basal layer, with the parameters of each.
    box
        What each panel shows; everything if it is None.
    room
        Inches that stay free below the legend.
    """
    states, frames = frames, [section(frame) for frame in frames]
    of = parameters if isinstance(parameters, Sequence) else [parameters] * max(1, len(frames))
    box, look = box or box_of(frames, of[0]), look_of(frames)
    with style():
        figure, panels = _sheet(len(frames), box, frames[0].curve, of[0], DPI, _second(frames, of[0], look), room)
        for panel, state, own in zip(panels, states, of, strict=False):
            draw_state(panel, state, own, _decimals(frames), look)
    return figure


def draw_frame(panel: Axes, frame: Frame, parameters: Parameters, box: Box | None = None) -> None:
    """Draw one state into axes of your own, without a legend; arguments and errors are those of ``drawing``."""
    shown = section(frame)
    with style():
        _axes(panel, box or box_of([shown], parameters), shown.curve, parameters, lowest=True, leftmost=True)
        draw_state(panel, frame, parameters, _decimals([frame]), look_of([shown]))


def stills(frames: Sequence[Frame], parameters: Parameters) -> Iterator[NDArray[np.uint8]]:
    """Give pictures of the frames one after the other, all of one scale and size: red, green, blue of shape (h, w, 3).

    Arguments and errors are those of ``picture``.
    """
    states, frames = frames, [section(frame) for frame in frames]
    box, look = box_of(frames, parameters), look_of(frames)
    with style():
        figure, (panel,) = _sheet(1, box, frames[0].curve, parameters, MOVIE_DPI, _second(frames, parameters, look))
        canvas: Any = FigureCanvasAgg(figure)
        canvas.draw()
    background, decimals = canvas.copy_from_bbox(figure.bbox), _decimals(frames)
    for state in states:
        canvas.restore_region(background)
        with style():
            for artist in draw_state(panel, state, parameters, decimals, look):
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


def _second(frames: Sequence[Frame], parameters: Parameters, look: EmtLook) -> dict[str, Any]:
    """Return the further entries of the legend, which may be none: EMT cells and named types."""
    kinds = sorted({k for frame in frames for k in frame.cells.kind.tolist() if k >= NAMED})
    return emt_entries(look) | type_entries({parameters.type_names[k]: TYPE_COLOURS[k - NAMED] for k in kinds})


def _sheet(
    count: int,
    box: Box,
    curve: BasalCurve,
    parameters: Parameters,
    dpi: int,
    second: dict[str, Any],
    room: float = 0.0,
) -> tuple[Figure, list[Axes]]:
    """Make a figure with ``count`` panels of one scale, and the legend below, further entries above the usual ones.

    It is no wider than its panels and their titles; with a caption in ``room`` it has the whole width.
    """
    rows = -(-count // COLUMNS)
    columns = -(-count // rows)
    most = (WIDTH - LEFT - RIGHT - (columns - 1) * GAP) / columns
    inches = min(most / (box.right - box.left), max(LEAST, TALLEST / rows) / (box.high - box.low))
    wide, tall = inches * (box.right - box.left), inches * (box.high - box.low)
    slot = most if room else min(most, max(wide, TITLE))
    width = _whole_pixels(LEFT + RIGHT + columns * slot + (columns - 1) * GAP)
    lines = legend_lines([control_entries(), second], width - LEFT)
    below = BOTTOM + LINE * len(lines) + room
    total = _whole_pixels(rows * (tall + TOP) + (rows - 1) * GAP + below)
    figure = Figure(figsize=(width, total), dpi=dpi)
    panels = []
    for k in range(count):
        row, column = divmod(k, columns)
        left = LEFT + column * (slot + GAP)
        low = below + (rows - 1 - row) * (tall + TOP + GAP)
        panels.append(figure.add_axes((left / width, low / total, wide / width, tall / total)))
        _axes(panels[-1], box, curve, parameters, lowest=k + columns >= count, leftmost=column == 0)
    legend(figure, lines, LEFT, room)
    return figure, panels


def _whole_pixels(inches: float) -> float:
    return math.ceil(inches * MOVIE_DPI) / MOVIE_DPI


def _axes(panel: Axes, box: Box, curve: BasalCurve, parameters: Parameters, *, lowest: bool, leftmost: bool) -> None:
    panel.set(xlim=(box.left, box.right), ylim=(box.low, box.high), aspect="equal")
    panel.tick_params(labelbottom=lowest, labelleft=leftmost)
    if lowest:
        panel.set_xlabel("x [µm]")
    if leftmost:
        panel.set_ylabel("y [µm]")
    draw_basal_layer(panel, curve, parameters.cell.soft_radius.value)


def _decimals(frames: Sequence[Frame]) -> int:
    """Count the decimals that the times need, at most two."""
    times = np.array([frame.t for frame in frames])
    return next((k for k in (0, 1) if np.allclose(times, np.round(times, k), rtol=0, atol=1e-6)), 2)
