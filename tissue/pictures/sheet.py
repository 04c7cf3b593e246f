"""Colours, styles and legend of the pictures of the tissue, and how figures are written. Only here is matplotlib."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from io import BytesIO
from os import PathLike
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import EllipseCollection, LineCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.legend_handler import HandlerTuple
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import NDArray

from dincl.files import replacing
from tissue.events.known import EVENTS
from tissue.files.parameters import Parameters
from tissue.frames.frame import Frame
from tissue.frames.observables import PHASES, phases
from tissue.pictures.emt import label_of

__all__ = ["Artist", "Axes", "EllipseCollection", "Figure", "FigureCanvasAgg", "Line2D", "LineCollection", "Patch"]

# Told apart by their lightness, too, and with every kind of colour blindness.
COLOURS = dict(zip(PHASES, ("#4b82bb", "#f0a202", "#7a1f5c"), strict=True))
# Of the edges of cells of named types, in their order.
TYPE_COLOURS = ("#00c2a8", "#e6194b", "#7b2ff7", "#9acd32", "#8c564b", "#ff6ec7", "#3d3dcc", "#c0c0c0")
SPRING, APICAL, BASAL, BELOW, GREY = "#5d6670", "#c8232c", "#1d1d1d", "#f1efe9", "#8a8a8a"
STYLE: Any = {
    "font.family": "DejaVu Sans",
    "font.size": 8.5,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.edgecolor": "#555555",
    "axes.grid": False,
    "legend.frameon": False,
    "svg.hashsalt": "tissue",  # the same file for the same picture
}
DOT: dict[str, Any] = {"marker": "o", "markeredgewidth": 0, "markersize": 3.0}
SOFT = 0.25  # opacity of soft discs
CROSS: dict[str, Any] = {"marker": "x", "markersize": 4.5, "markeredgewidth": 1.2, "linestyle": "none"}
CHAIN: dict[str, Any] = {"linewidth": 1.0, "linestyle": (0, (3.0, 1.5))}
# Inches of a column and of a line of the legend.
ENTRY, LINE = 1.5, 0.22


@contextmanager
def style(**more: Any) -> Iterator[None]:
    """Draw in the one style, and leave that of others alone."""
    with mpl.rc_context(STYLE | more):
        yield


def write(figure: Figure, path: str | PathLike[str]) -> None:
    """Write a figure; the same bytes for the same figure."""
    dated = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}}
    with style(), replacing(path) as partial:
        figure.savefig(partial, metadata=dated.get(Path(path).suffix.lower()))


def webp(figure: Figure, dpi: int = 100) -> bytes:
    """Return the bytes of a WebP image of a figure, for a page: a quarter of those of a PNG."""
    file = BytesIO()
    with style():
        figure.savefig(file, format="webp", dpi=dpi, pil_kwargs={"quality": 85})
    return file.getvalue()


def shades(colours: list[str]) -> NDArray[np.uint8]:
    """Return red, green, blue of hard discs of these colours and of soft ones on paper, (2 n, 3)."""
    hard = 255 * np.array([to_rgb(colour) for colour in colours])
    return np.round(np.vstack((hard, 255 + SOFT * (hard - 255)))).astype(np.uint8)


def legend_entries(events: Mapping[str, str], types: Mapping[str, str]) -> dict[str, Any]:
    """Return the marks of the legend by name.

    Parameters
    ----------
    events
        Colours of the sets of events that EMT cells have.
    types
        Colours of the edges of named types.
    """

    def dot(colour: str, size: float, **look: Any) -> Line2D:
        return Line2D([], [], linestyle="none", color=colour, **DOT | {"markersize": size} | look)

    def disc(colour: str, **edge: Any) -> tuple[Line2D, Line2D]:
        return dot(colour, 12, alpha=0.35), dot(colour, 6, **edge)

    found: dict[str, Any] = {name: disc(colour) for name, colour in COLOURS.items()}
    found["soft, hard disc"] = disc(GREY)
    found["springs"] = Line2D([], [], color=SPRING, linewidth=0.9)
    found["apical layer"] = Line2D([], [], color=APICAL, linewidth=1.5, **DOT)
    found["basal layer"] = Line2D([], [], color=BASAL, linewidth=1.2, **DOT)
    for name, colour in events.items():
        found[label_of(name)] = disc(colour, markeredgecolor="black", markeredgewidth=0.6)
    if events:
        crosses = (Line2D([], [], color=colour, **CROSS) for colour in (APICAL, BASAL))
        found |= zip(("free apical point", "free basal point"), crosses, strict=True)
    if any("AC" in name for name in events):
        found["joined, left layer"] = Line2D([], [], color=APICAL, **CHAIN)
    for name, colour in types.items():
        found[f"type {name}"] = dot(GREY, 6, markeredgecolor=colour, markeredgewidth=1.2)
    return found


def add_legend(figure: Figure, entries: Mapping[str, Any], columns: int) -> None:
    """Add a legend below all panels."""
    handlers: Any = {tuple: HandlerTuple(ndivide=1)}
    marks, names = list(entries.values()), list(entries)
    figure.legend(marks, names, loc="outside lower left", ncols=columns, handler_map=handlers)


def colours_of_cells(
    frame: Frame, parameters: Parameters, events: Mapping[str, str]
) -> tuple[NDArray[np.str_], NDArray[np.str_]]:
    """Return the colours of the disc or ball of each cell, and of the edge of its hard disc."""
    cells, is_emt = frame.cells, frame.cells.emt >= 0
    phase = phases(frame, parameters.numbers(), parameters.named_numbers())
    of_phase = np.array([COLOURS[name] for name in PHASES])[phase]
    of_events = np.array([events[EVENTS[k]] if own else "" for k, own in zip(cells.events, is_emt, strict=True)])
    of_type = np.array(("", "", *TYPE_COLOURS))[cells.kind]
    return np.where(is_emt, of_events, of_phase), np.where(of_type == "", np.where(is_emt, "black", "white"), of_type)
