"""The tissue to scale, in um, coloured by cycle phase: discs, springs, layers. Only here is matplotlib."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import matplotlib as mpl
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import EllipseCollection, LineCollection
from matplotlib.figure import Figure
from matplotlib.legend_handler import HandlerTuple
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from dincl.errors import InvalidProblem
from tissue.observables import PHASES, height, is_measurable, phases

if TYPE_CHECKING:
    from tissue.cells import Floats
    from tissue.parameters import Parameters
    from tissue.run import Frame

ENDINGS = (".png", ".svg", ".pdf")
# Told apart by their lightness, too, and with every kind of colour blindness.
COLOURS = dict(zip(PHASES, ("#4b82bb", "#f0a202", "#7a1f5c"), strict=True))
SPRING, APICAL, BASAL, BELOW, GREY = "#5d6670", "#c8232c", "#1d1d1d", "#f1efe9", "#8a8a8a"
STYLE: Any = {
    "font.family": "DejaVu Sans",
    "font.size": 8.5,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.edgecolor": "#555555",
    "legend.frameon": False,
    "svg.hashsalt": "tissue",  # the same file for the same picture
}
# Inches: a picture, its panels at most, and what stands around them.
WIDTH, TALLEST = 9.2, 7.0
LEFT, RIGHT, TOP, GAP, BOTTOM, LEGEND = 0.55, 0.12, 0.32, 0.3, 0.48, 0.34
COLUMNS = 3
DPI = 200
MOVIE_DPI = 100
DOT: dict[str, Any] = {"marker": "o", "markeredgewidth": 0}
DOT_SIZE = 3.0
MARGIN = 2.0  # um around the discs
FULL, THINNEST = 3.5, 0.25  # points per um from which on lines have their full width; what is left of it at least


class Box(NamedTuple):
    """What a panel shows [um]."""

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
    if Path(path).suffix.lower() not in ENDINGS:
        raise InvalidProblem(f"path = {str(path)!r}: must end in {', '.join(ENDINGS)}")
    with mpl.rc_context(STYLE):
        figure, panels = _sheet(len(frames), _box(frames, parameters), DPI)
        for panel, frame in zip(panels, frames, strict=True):
            _draw(panel, frame, parameters, _decimals(frames))
        dated = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}}
        figure.savefig(path, metadata=dated.get(Path(path).suffix.lower()))


def stills(frames: Sequence[Frame], parameters: Parameters) -> Iterator[NDArray[np.uint8]]:
    """Pictures of the frames one after the other, all of one scale and size: red, green, blue of shape (h, w, 3).

    Arguments and errors are those of ``picture``.
    """
    with mpl.rc_context(STYLE):
        figure, (panel,) = _sheet(1, _box(frames, parameters), MOVIE_DPI)
        canvas: Any = FigureCanvasAgg(figure)
        canvas.draw()
    background, decimals = canvas.copy_from_bbox(figure.bbox), _decimals(frames)
    for frame in frames:
        canvas.restore_region(background)
        with mpl.rc_context(STYLE):
            for artist in _draw(panel, frame, parameters, decimals):
                panel.draw_artist(artist)
                artist.remove()
        yield np.asarray(canvas.buffer_rgba())[:, :, :3].copy()


def _box(frames: Sequence[Frame], parameters: Parameters) -> Box:
    """Around the soft discs and all points of all frames."""
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


def _sheet(count: int, box: Box, dpi: int) -> tuple[Figure, list[Axes]]:
    """A figure with ``count`` panels of one scale, and the legend below."""
    rows = -(-count // COLUMNS)
    columns = -(-count // rows)
    slot = (WIDTH - LEFT - RIGHT - (columns - 1) * GAP) / columns
    inches = min(slot / (box.right - box.left), TALLEST / rows / (box.high - box.low))
    wide, tall = inches * (box.right - box.left), inches * (box.high - box.low)
    total = rows * (tall + TOP) + (rows - 1) * GAP + BOTTOM + LEGEND
    total = math.ceil(total * MOVIE_DPI) / MOVIE_DPI  # whole pixels
    figure = Figure(figsize=(WIDTH, total), dpi=dpi)
    panels = []
    for k in range(count):
        row, column = divmod(k, columns)
        left = LEFT + column * (slot + GAP)
        low = BOTTOM + LEGEND + (rows - 1 - row) * (tall + TOP + GAP)
        panels.append(figure.add_axes((left / WIDTH, low / total, wide / WIDTH, tall / total)))
        _axes(panels[-1], box, lowest=k + columns >= count, leftmost=column == 0)
    _legend(figure)
    return figure, panels


def _axes(panel: Axes, box: Box, *, lowest: bool, leftmost: bool) -> None:
    panel.set(xlim=(box.left, box.right), ylim=(box.low, box.high), aspect="equal")
    panel.tick_params(labelbottom=lowest, labelleft=leftmost)
    if lowest:
        panel.set_xlabel("x [µm]")
    if leftmost:
        panel.set_ylabel("y [µm]")
    panel.axhspan(box.low, 0.0, color=BELOW, linewidth=0, zorder=0)
    panel.axhline(0.0, color=BASAL, linewidth=1.2, zorder=1)


def _draw(panel: Axes, frame: Frame, parameters: Parameters, decimals: int) -> list[Artist]:
    """Everything that belongs to one state, from below to above."""
    um, cells = parameters.cell.soft_radius.value, frame.cells
    nuclei, apical, basal = (um * np.column_stack(xy) for xy in _points(frame))
    colours = np.array([COLOURS[name] for name in PHASES])[phases(frame, parameters.numbers())]
    soft, hard = np.full(len(nuclei), um), um * cells.radius
    thin = _thinner(panel)
    collections = (
        _discs(panel, nuclei, soft, facecolors=colours, alpha=0.25, linewidths=0, zorder=2),
        _discs(panel, nuclei, soft, facecolors="none", edgecolors=colours, linewidths=0.5 * thin, zorder=2),
        LineCollection(
            list(np.stack((apical, nuclei, basal), axis=1)), colors=SPRING, linewidths=0.7 * thin, alpha=0.55, zorder=3
        ),
        _discs(panel, nuclei, hard, facecolors=colours, edgecolors="white", linewidths=0.4 * thin, zorder=4),
    )
    for collection in collections:
        panel.add_collection(collection)
    dots = DOT | {"markersize": DOT_SIZE * thin, "zorder": 5}
    lines = panel.plot(*apical[frame.layers.apical].T, color=APICAL, linewidth=1.5 * thin, **dots)
    lines += panel.plot(*basal.T, color=BASAL, linestyle="none", **dots)
    count = f"{len(cells.x)} cell{'s' * (len(cells.x) != 1)}"
    title = f"t = {frame.t:.{decimals}f} h  ·  {count}  ·  height {um * height(frame):.3g} µm"
    return [*collections, *lines, panel.annotate(title, (0, 1), (0, 6), "axes fraction", "offset points", size=9.5)]


def _thinner(panel: Axes) -> float:
    """The factor of line widths in a small scale, so that lines do not hide what they join."""
    left, right = panel.get_xlim()
    points = 72 * WIDTH * panel.get_position().width
    return min(1.0, max(THINNEST, math.sqrt(points / (right - left) / FULL)))


def _decimals(frames: Sequence[Frame]) -> int:
    """How many the times need, at most two."""
    times = np.array([frame.t for frame in frames])
    return next((k for k in (0, 1) if np.allclose(times, np.round(times, k), rtol=0, atol=1e-6)), 2)


def _points(frame: Frame) -> tuple[tuple[Floats, Floats], ...]:
    c = frame.cells
    return (c.x, c.y), (c.ax, c.ay), (c.bx, c.by)


def _discs(panel: Axes, centres: Floats, radii: Floats, **look: Any) -> EllipseCollection:
    """Discs to scale, centres (n, 2), radii (n,)."""
    sizes = 2 * radii
    return EllipseCollection(
        sizes, sizes, np.zeros(len(sizes)), units="xy", offsets=centres, offset_transform=panel.transData, **look
    )


def _legend(figure: Figure) -> None:
    def dot(colour: str, size: float, alpha: float = 1.0) -> Line2D:
        return Line2D([], [], linestyle="none", color=colour, alpha=alpha, markersize=size, **DOT)

    def line(colour: str, width: float, **dots: Any) -> tuple[Line2D]:
        return (Line2D([], [], color=colour, linewidth=width, markersize=DOT_SIZE, **dots),)

    entries: Any = {name: (dot(colour, 12, 0.35), dot(colour, 6)) for name, colour in COLOURS.items()}
    entries["soft, hard disc"] = (dot(GREY, 12, 0.35), dot(GREY, 6))
    entries["springs"] = line(SPRING, 0.9)
    entries["apical layer"] = line(APICAL, 1.5, **DOT)
    entries["basal layer"] = line(BASAL, 1.2, **DOT)
    figure.legend(
        list(entries.values()),
        list(entries),
        handler_map={tuple: HandlerTuple(ndivide=1)},
        loc="lower left",
        bbox_to_anchor=(LEFT / WIDTH, 0.0),
        borderaxespad=0.5,
        borderpad=0.2,
        ncols=len(entries),
        handletextpad=0.5,
        columnspacing=1.6,
    )
