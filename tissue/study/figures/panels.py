"""The panels of a figure, the presets beside each other, and marks with intervals in them."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from tissue.pictures.charts import CAP, CHECK, CHECKED, page, verbatim
from tissue.pictures.sheet import Axes, Figure, Line2D, Patch

MAKES_NO_NUMBERS = True

MOST_COLUMNS = 4
AROUND, TITLE_LINE = 1.0, 0.16  # inches for legend and caption; for a further line of titles
TITLE_LETTERS, NAME_LETTERS = 108, 42  # of all titles in a row; of a line of a name beside an axis
APART = 0.34  # of the marks of one line


class RatioSeries(NamedTuple):
    """One series of ratios."""

    label: str
    rows: pd.DataFrame  # value, low, high; by the name of their line
    checked: pd.DataFrame | None  # the same of fewer runs, to lay over
    look: dict[str, Any]


def grid(
    parts: Sequence[str], presets: Sequence[str], height: float, columns: int = MOST_COLUMNS, **shared: Any
) -> tuple[Figure, dict[tuple[str, str], Axes]]:
    """Make a panel for each part and preset; with two presets each part is a row, and the presets are its columns.

    Parameters
    ----------
    parts
        Titles.
    presets
        Their names, which are told if there are two.
    height
        Of a row [in].
    columns
        Into which parts of one preset are put, at most.
    shared
        Of axes, as matplotlib has it.
    """
    names = [(part, preset) for part in parts for preset in presets]
    wide = len(presets) if len(presets) > 1 else min(columns, len(parts))
    tall = -(-len(names) // wide)
    told = [f"{part}, {preset}" if len(presets) > 1 else part for part, preset in names]
    titles = [textwrap.fill(verbatim(name), round(TITLE_LETTERS / wide)) for name in told]
    figure = page(tall * (height + TITLE_LINE * max(title.count("\n") for title in titles)) + AROUND)
    each = figure.subplots(tall, wide, squeeze=False, **shared).ravel()
    for k, panel in enumerate(each):
        if k >= len(names):
            panel.remove()
        elif k + wide >= len(names):  # of the last row, or with nothing beneath it
            panel.tick_params(labelbottom=True)
    for title, panel in zip(titles, each, strict=False):
        panel.set_title(title)
    return figure, dict(zip(names, each, strict=False))


def name_axes(panels: Mapping[Any, Axes], x: str, y: str) -> None:
    """Name the axes, at the left and below."""
    places = [(place.colspan.start, place.rowspan.start) for place in map(_place, panels.values())]
    lowest = {column: max(row for at, row in places if at == column) for column, _ in places}
    for (column, row), panel in zip(places, panels.values(), strict=True):
        panel.set(xlabel=x if row == lowest[column] else "", ylabel="" if column else y)


def _place(panel: Axes) -> Any:
    return panel.get_subplotspec()


def draw_series(panel: Axes, names: Sequence[str], series: Sequence[RatioSeries]) -> None:
    """Draw ratios [%] with their intervals: a line for each name from above to below, with a mark for each series."""
    step = min(APART, 0.7 / len(series))
    for k, (label, rows, checked, look) in enumerate(series):
        shift = step * (k - (len(series) - 1) / 2)
        for table, marks in ((checked, CHECK), (rows, {"label": label, "markersize": 4.5} | look)):
            if table is not None and len(table):
                value, low, high = (100 * table[name].to_numpy(float) for name in ("value", "low", "high"))
                at = np.array([names.index(name) for name in table.index]) + shift
                panel.errorbar(value, at, xerr=(value - low, high - value), linestyle="none", **CAP, **marks)
    panel.set(yticks=range(len(names)), ylim=(len(names) - 0.5, -0.5), xlim=(-2, 102))
    panel.set_yticklabels([textwrap.fill(verbatim(name), NAME_LETTERS) for name in names])
    panel.grid(visible=False, axis="y")


def checked_entry() -> dict[str, Line2D | Patch]:
    """Return the legend of fewer runs that are laid over."""
    return {CHECKED: Line2D([], [], linestyle="none", **CHECK)}
