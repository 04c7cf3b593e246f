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
from matplotlib.figure import Figure
from matplotlib.patches import Patch, PathPatch, Polygon
from matplotlib.path import Path as Outline
from matplotlib.rcsetup import cycler
from numpy.typing import NDArray

from dincl.files import replacing
from dincl.plotting import log_ticks

__all__ = [
    "GREY",
    "NOTE",
    "WIDTH",
    "Axes",
    "Figure",
    "hatch_cells",
    "legend_below",
    "own_axes",
    "own_figure",
    "patch",
    "polygon",
    "sheet",
]

Floats = NDArray[np.float64]
WIDTH = 9.2  # inches; the page shows figures at most at this width
DPI = 150
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
    # Okabe and Ito's, apart from yellow, which is too light for lines.
    "axes.prop_cycle": cycler(color=("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000")),
    "lines.linewidth": 1.3,
    "lines.markersize": 4.5,
    "legend.frameon": False,
}


@contextmanager
def sheet(path: Path, height: float, **style: Any) -> Iterator[Figure]:
    """Yield a figure of this height in inches; write it to ``path`` at the end of the block."""
    with mpl.rc_context(STYLE | style):
        figure = Figure(figsize=(WIDTH, height), layout="constrained", dpi=DPI)
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
    with own_figure((8.0, 4.4)) as figure:
        panel: Axes = figure.subplots()
        return panel


@contextmanager
def own_figure(size: tuple[float, float]) -> Iterator[Figure]:
    """Yield a new figure of a width and height in inches, to be drawn on in this style."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=size, layout="constrained", dpi=DPI)
        FigureCanvasAgg(figure)
        yield figure


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
