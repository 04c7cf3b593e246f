"""A sheet of the report to draw on, in its one style. This is the one file that imports matplotlib."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from textwrap import fill
from typing import Any, Literal

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
    "narrow",
    "own_axes",
    "patch",
    "polygon",
    "sheet",
    "stack",
]

Floats = NDArray[np.float64]
WIDTH = 9.2  # inches; the page shows figures at this width, with twice the dots
# Of the form for telephones: its width, the least and largest height of a panel, the height of a line [inches].
NARROW, HEIGHTS, LINE = 4.4, (1.8, 2.8), 0.19
LETTER = 0.08  # inches; of the labels of axes
# Panels of more columns than this stand in two there, others in one; a legend of names of so many letters in two.
MANY, LETTERS = 3, 26
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
    """Yield a figure of ``width`` and ``height`` inches; write it to ``path`` at the end of the block.

    A figure as wide as the page is also written to ``narrow(path)``, with its panels below each other.
    """
    with mpl.rc_context(STYLE | style):
        figure = Figure(figsize=(width, height), layout="constrained", dpi=DPI)
        FigureCanvasAgg(figure)
        yield figure
        for panel in figure.axes:
            log_ticks(panel)
        path.parent.mkdir(parents=True, exist_ok=True)
        _write(figure, path)
        if width == WIDTH and figure.axes:
            entries = sum(len(legend.get_texts()) for legend in figure.legends)
            stack(figure, LINE * -(-entries // 3), HEIGHTS)
            _write(figure, narrow(path))


def narrow(path: Path) -> Path:
    """Return where the form of a figure for telephones is."""
    return path.with_suffix(f".narrow{path.suffix}")


def _write(figure: Figure, path: Path) -> None:
    with replacing(path) as partial:
        figure.savefig(partial, dpi=DPI)


def stack(
    figure: Figure,
    around: float,
    heights: tuple[float, float] = (0.0, float("inf")),
    place: Literal["outside lower center", "outside upper left"] = "outside lower center",
) -> None:
    """Put the panels of a figure below each other, two side by side if there are many.

    Parameters
    ----------
    figure
        With panels of one grid, one legend and perhaps a caption, its label below.
    around
        Height of all but the panels before [inches]; panels keep their height.
    heights
        The least and the largest height of a panel.
    place
        Of the legend, in one or two columns.
    """
    for panel in [panel for panel in figure.axes if not panel.axison]:
        panel.remove()
    places = {panel: spec for panel in figure.axes if (spec := panel.get_subplotspec()) is not None}
    grid = next(iter(places.values())).get_gridspec()
    tall = float(np.clip((figure.get_figheight() - around) / grid.nrows, *heights))
    _repeat_labels({(spec.rowspan.start, spec.colspan.start): panel for panel, spec in places.items()}, tall)
    across = 2 if grid.ncols > MANY else 1
    rows = -(-len(places) // across)
    cells = figure.add_gridspec(rows, across)
    for k, panel in enumerate(places):
        panel.set_subplotspec(cells[divmod(k, across)])
    handles = [handle for legend in figure.legends for handle in legend.legend_handles if handle is not None]
    labels = [text.get_text() for legend in figure.legends for text in legend.get_texts()]
    for legend in list(figure.legends):
        legend.remove()
    columns = 2 if labels and max(map(len, labels)) <= LETTERS else 1
    lines = 1 - (-len(labels) // columns) + len(figure.get_supxlabel().splitlines())
    figure.set_size_inches(NARROW, rows * tall + LINE * lines)
    if labels:
        figure.legend(handles, labels, loc=place, ncols=columns)


def _repeat_labels(at: Mapping[tuple[int, int], Axes], tall: float) -> None:
    """Give each panel, by its row and column, the labels and ticks that it shared with others; ``tall`` in inches."""
    names = {place: (at[place].get_xlabel(), at[place].get_ylabel()) for place in sorted(at)}
    for (row, column), panel in at.items():
        below = [x for (r, c), (x, _) in names.items() if c == column and r >= row and x]
        left = [y for (r, c), (_, y) in names.items() if r == row and c <= column and y]
        panel.set_xlabel("".join(below[:1]))
        panel.set_ylabel(fill("".join(left[-1:]), int(tall / LETTER)))
        panel.tick_params(labelleft=True, labelbottom=True)


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
