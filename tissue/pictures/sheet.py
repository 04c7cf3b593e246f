"""Colours, lines and legend of the pictures of the tissue, and how figures are written. Only here is matplotlib."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
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
from tissue.pictures.emt import EmtLook

MAKES_NO_NUMBERS = True

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
DOT: dict[str, Any] = {"marker": "o", "markeredgewidth": 0}
DOT_SIZE = 3.0
SOFT = 0.25  # opacity of soft discs
CROSS: dict[str, Any] = {"marker": "x", "markersize": 4.5, "markeredgewidth": 1.2, "linestyle": "none"}
CHAIN: dict[str, Any] = {"linewidth": 1.0, "linestyle": (0, (3.0, 1.5))}


# Inches of an entry and of a line of a legend.
ENTRY, LINE = 1.18, 0.34


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


def png(figure: Figure) -> bytes:
    """Write a figure as the bytes of a PNG file, for a page."""
    file = BytesIO()
    with style():
        figure.savefig(file, format="png", dpi=100)
    return file.getvalue()


def shades(colours: Sequence[str]) -> NDArray[np.uint8]:
    """Return red, green, blue of hard discs of these colours and of soft ones on paper, (2 n, 3)."""
    hard = 255 * np.array([to_rgb(colour) for colour in colours])
    return np.round(np.vstack((hard, 255 + SOFT * (hard - 255)))).astype(np.uint8)


def _dot(colour: str, size: float, **look: Any) -> Line2D:
    return Line2D([], [], linestyle="none", color=colour, markersize=size, **(DOT | look))


def control_entries() -> dict[str, Any]:
    """Return the legend of what every picture has."""

    def line(colour: str, width: float, **dots: Any) -> tuple[Line2D]:
        return (Line2D([], [], color=colour, linewidth=width, markersize=DOT_SIZE, **dots),)

    phases = {name: (_dot(colour, 12, alpha=0.35), _dot(colour, 6)) for name, colour in COLOURS.items()}
    return phases | {
        "soft, hard disc": (_dot(GREY, 12, alpha=0.35), _dot(GREY, 6)),
        "springs": line(SPRING, 0.9),
        "apical layer": line(APICAL, 1.5, **DOT),
        "basal layer": line(BASAL, 1.2, **DOT),
    }


def emt_entries(look: EmtLook) -> dict[str, Any]:
    """Return the legend of EMT cells that look so; empty if there are none."""
    edge = {"markeredgecolor": "black", "markeredgewidth": 0.6}
    found: dict[str, Any] = {}
    for name, colour in look.colours.items():
        text = f"[{name}]" if name else "before any event"
        found[text if found else f"EMT cell: {text}"] = (_dot(colour, 12, alpha=0.35), _dot(colour, 6, **edge))
    for is_there, layer, colour in ((look.apical, "apical", APICAL), (look.basal, "basal", BASAL)):
        if is_there:
            found[f"free {layer} point"] = (Line2D([], [], color=colour, **CROSS),)
    if look.chained:
        found["joined apart from the layer"] = (Line2D([], [], color=APICAL, **CHAIN),)
    return found


def type_entries(colours: Mapping[str, str]) -> dict[str, Any]:
    """Return the legend of named types, by their edges."""
    return {
        f"type {name}": (_dot(GREY, 6, markeredgecolor=colour, markeredgewidth=1.2),)
        for name, colour in colours.items()
    }


def legend_lines(groups: Sequence[dict[str, Any]], width: float) -> list[dict[str, Any]]:
    """Break the entries of a legend into lines that fit into a width [inches], from below to above."""
    most, lines = max(1, int(width / ENTRY)), []
    for group in groups:
        entries = list(group.items())
        lines += [dict(entries[k : k + most]) for k in reversed(range(0, len(entries), most))]
    return lines


def legend(figure: Figure, lines: Sequence[dict[str, Any]], left: float, low: float) -> None:
    """Add the lines of a legend; ``left``, ``low``: the corner of the lowest one [inches]."""
    wide, tall = figure.get_size_inches()
    for k, entries in enumerate(lines):
        figure.legend(
            list(entries.values()),
            list(entries),
            handler_map={tuple: HandlerTuple(ndivide=1)},
            loc="lower left",
            bbox_to_anchor=(left / wide, (low + k * LINE) / tall),
            borderaxespad=0.5,
            borderpad=0.2,
            ncols=len(entries),
            handletextpad=0.5,
            columnspacing=1.6,
        )


def colours_of_cells(frame: Frame, parameters: Parameters, look: EmtLook) -> tuple[NDArray[np.str_], NDArray[np.str_]]:
    """Return the colours of the disc or ball of each cell, and of the edge of its hard disc."""
    cells, is_emt = frame.cells, frame.cells.emt >= 0
    phase = phases(frame, parameters.numbers(), parameters.named_numbers())
    of_phase = np.array([COLOURS[name] for name in PHASES])[phase]
    of_events = np.array([look.colours[EVENTS[k]] if own else "" for k, own in zip(cells.events, is_emt, strict=True)])
    of_type = np.array(("", "", *TYPE_COLOURS))[cells.kind]
    return np.where(is_emt, of_events, of_phase), np.where(of_type == "", np.where(is_emt, "black", "white"), of_type)
