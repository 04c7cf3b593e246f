"""A sheet of the report to draw on, in its one style. This is the one file that imports matplotlib."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PatchCollection
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Patch, PathPatch, Polygon
from matplotlib.path import Path as Outline
from numpy.typing import NDArray

from dincl.drawing import log_ticks
from dincl.files import replacing

MAKES_NO_NUMBERS = True

__all__ = [
    "GREY",
    "NOTE",
    "WIDTH",
    "Axes",
    "Figure",
    "discs",
    "hatch_cells",
    "legend_below",
    "own_axes",
    "patch",
    "polygon",
    "sheet",
]

Floats = NDArray[np.float64]
WIDTH = 9.2  # inches; the page shows figures at this width, with twice the dots
DPI = 200
NOTE = 7.5  # points; words inside of panels
GREY = "#8a8a8a"
STYLE: Any = {  # the names are those of matplotlib
    "font.family": "DejaVu Sans",
    "font.size": 8.5,
    "axes.titlesize": 9.5,
    "axes.titlelocation": "left",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#e6e6e6",
    "grid.linewidth": 0.6,
    "axes.edgecolor": "#555555",
    "lines.linewidth": 1.3,
    "lines.markersize": 4.5,
    "legend.frameon": False,
}


@contextmanager
def sheet(path: Path, height: float, width: float = WIDTH, **style: Any) -> Iterator[Figure]:
    """Yield a figure of ``width`` and ``height`` inches; write it to ``path`` at the end of the block."""
    with mpl.rc_context(STYLE | style):
        figure = Figure(figsize=(width, height), layout="constrained", dpi=DPI)
        FigureCanvasAgg(figure)
        yield figure
        for panel in figure.axes:
            log_ticks(panel)
        path.parent.mkdir(parents=True, exist_ok=True)
        with replacing(path) as partial:
            figure.savefig(partial, dpi=DPI)


def legend_below(figure: Figure, panels: Iterable[Axes], columns: int) -> None:
    """Draw one legend for all panels below them, each label once."""
    found = {
        label: handle for panel in panels for handle, label in zip(*panel.get_legend_handles_labels(), strict=True)
    }
    figure.legend(found.values(), found.keys(), loc="outside lower center", ncols=columns)


def own_axes(ax: Axes | None) -> Axes:
    """Return the axes given, or axes of a new figure in this style; no global state of matplotlib is touched."""
    if ax is not None:
        return ax
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(8.0, 4.4), layout="constrained", dpi=DPI)
        FigureCanvasAgg(figure)
        panel: Axes = figure.subplots()
        return panel


def discs(panel: Axes, centres: Floats, radius: Floats, **look: Any) -> None:
    """Draw discs to scale, centres (N, 2), radii (N,)."""
    shapes = [Circle(tuple(centre), r) for centre, r in zip(centres, radius, strict=True)]
    panel.add_collection(PatchCollection(shapes, **look))


def hatch_cells(panel: Axes, x: Floats, y: Floats, here: NDArray[np.bool_], **look: Any) -> None:
    """Hatch the cells between the edges x (n + 1,) and y (m + 1,) for which ``here``, (m, n), is true, as one patch.

    To hatch a patch for each cell would take more than half of the time of a map.
    """
    rows, columns = np.nonzero(here)
    corners = [np.column_stack((x[columns + i], y[rows + j])) for i, j in ((0, 0), (1, 0), (1, 1), (0, 1), (0, 0))]
    codes = np.tile([Outline.MOVETO, *[Outline.LINETO] * 3, Outline.CLOSEPOLY], len(rows))
    panel.add_patch(PathPatch(Outline(np.stack(corners, axis=1).reshape(-1, 2), codes), **look))


def patch(**look: Any) -> Patch:
    """Return a field of a legend."""
    return Patch(**look)


def polygon(panel: Axes, corners: Floats, **look: Any) -> None:
    """Draw a filled polygon with corners (K, 2)."""
    panel.add_patch(Polygon(corners, **look))
