"""Charts of studies: their one style, panels, and ratios with intervals against time and beside each other."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Mapping, Sequence
from typing import Any, Literal, NamedTuple

import numpy as np
import pandas as pd

from tissue.pictures.sheet import GREY, Axes, Figure, Line2D, Patch
from tissue.study.categories import EXTREME, What, control_shares, kept_times, run_shares_in_time, time_column, timed
from tissue.study.estimates import estimate

WIDTH = 9.2  # inches
DPI = 200
CHART_STYLE: Any = {
    "axes.titlesize": 9.5,
    "axes.titlelocation": "left",
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#e6e6e6",
    "grid.linewidth": 0.6,
    "lines.linewidth": 1.4,
}
LineStyle = Literal["-", "--", "-."]
# What becomes of a cell: colour, line, name. Told apart by lightness and line, too.
OUTCOMES: dict[What, tuple[str, LineStyle, str]] = {
    "basal": ("#a31621", "-", "basal extrusion"),
    "apical": ("#3f7fc1", "--", "apical extrusion"),
    "below": ("#e0a100", "-.", "below all control cells"),
}
TIME, RATIO = "time [h]", "share of EMT cells [%]"
CONTROLS = "control cells, apical extrusion"
CAP: dict[str, Any] = {"capsize": 2.5, "elinewidth": 1.0, "capthick": 1.0}
# Inches: of a column of panels at least, what stands around them, of a further line of titles, of a column of a legend.
COLUMN, AROUND, TITLE_LINE, ENTRY = 2.1, 0.8, 0.16, 2.1
LETTERS = 12  # of a title in an inch
NAME_LETTERS = 42  # of a line of a name beside an axis
APART = 0.34  # of the marks of one line
STEPS = (0.1, 0.25, 0.5, 1.0, 2.0, 3.0, 6.0, 12.0, 24.0, 48.0)  # [h] between two ticks
MOST_TICKS = 5


def page(height: float, width: float = WIDTH) -> Figure:
    """Make an empty figure, sizes in inches."""
    return Figure(figsize=(width, height), layout="constrained", dpi=DPI)


def verbatim(name: str) -> str:
    """Return a name from a file for a text of matplotlib, in which $ begins a formula."""
    return name.replace("$", r"\$")


def legend(figure: Figure, handles: Mapping[str, Line2D | Patch]) -> None:
    """Add one legend for all panels, above them."""
    columns = max(1, min(len(handles), int(figure.get_figwidth() / ENTRY)))
    figure.legend(list(handles.values()), list(handles), loc="outside upper left", ncols=columns)


def grid(
    titles: Sequence[str],
    height: float,
    *,
    x: str = "",
    y: str = "",
    columns: int | None = None,
    width: float = WIDTH,
    **shared: Any,
) -> tuple[Figure, list[Axes]]:
    """Make a panel for each title, in rows.

    Parameters
    ----------
    titles
        Of the panels.
    height
        Of a row [in].
    x, y
        Names of the axes, once for all panels.
    columns
        Panels in a row; None: as many as fit.
    width
        Of the figure [in].
    shared
        Of axes, as matplotlib has it.
    """
    columns = columns or min(len(titles), int(width / COLUMN))
    rows = -(-len(titles) // columns)
    wrapped = [textwrap.fill(verbatim(title), round(LETTERS * width / columns)) for title in titles]
    lines = max(title.count("\n") for title in wrapped)
    figure = page(rows * (height + TITLE_LINE * lines) + AROUND, width)
    panels = figure.subplots(rows, columns, squeeze=False, **shared).ravel().tolist()
    for k in range(len(titles), len(panels)):  # nothing is beneath the panel above
        panels[k].remove()
        panels[k - columns].tick_params(labelbottom=True)
    for title, panel in zip(wrapped, panels, strict=False):
        panel.set_title(title)
    figure.supxlabel(x, fontsize="medium")
    figure.supylabel(y, fontsize="medium")
    return figure, panels[: len(titles)]


class RatioSeries(NamedTuple):
    """One series of ratios."""

    label: str
    rows: pd.DataFrame  # value, low, high; by the name of their line
    look: dict[str, Any]


def draw_series(panel: Axes, names: Sequence[str], series: Sequence[RatioSeries]) -> None:
    """Draw ratios [%] with their intervals: a line for each name from above to below, with a mark for each series."""
    step = min(APART, 0.7 / len(series))
    for k, (label, rows, look) in enumerate(series):
        value, low, high = (100 * rows[name].to_numpy(float) for name in ("value", "low", "high"))
        at = np.array([names.index(name) for name in rows.index]) + step * (k - (len(series) - 1) / 2)
        marks: dict[str, Any] = {"label": label, "markersize": 4.5, "linestyle": "none"} | CAP | look
        panel.errorbar(value, at, xerr=(value - low, high - value), **marks)
    panel.set(yticks=range(len(names)), ylim=(len(names) - 0.5, -0.5), xlim=(-2, 102))
    panel.set_yticklabels([textwrap.fill(verbatim(name), NAME_LETTERS) for name in names])
    panel.grid(visible=False, axis="y")


def band(panel: Axes, x: pd.Series, table: pd.DataFrame, **look: Any) -> None:
    """Draw a line of ratios [%] with their intervals; ``table`` has value, low and high."""
    low, value, high = (100 * table[name] for name in ("low", "value", "high"))
    panel.fill_between(x, low, high, color=look["color"], alpha=0.18, linewidth=0)
    panel.plot(x, value, **look)


def ratios_in_time(cells: pd.DataFrame) -> pd.DataFrame:
    """Compute r(t) of (4.7), the mean over runs of the share of a run, with its interval at each output time alone.

    A row for each outcome and output time: ``what`` (the keys of ``OUTCOMES``), ``time_h``, value, low, high.
    """
    parts = []
    for what, shares in run_shares_in_time(cells).items():
        mean = estimate([1.0], [shares], EXTREME[what])
        low, high = mean.interval()
        columns = {"what": what, "time_h": kept_times(cells), "value": mean.effect, "low": low, "high": high}
        parts.append(pd.DataFrame(columns))
    return pd.concat(parts, ignore_index=True)


def draw_time_series(panel: Axes, cells: pd.DataFrame, runs: pd.DataFrame) -> None:
    """Draw r(t) of (4.7) for the three outcomes, and apical extrusion of the control cells.

    ``cells``, ``runs``: tables of one scenario, see ``Results``; there is at least one cell.
    """
    table, times = ratios_in_time(cells), kept_times(cells)
    for what, (colour, line, name) in OUTCOMES.items():
        mine = table[table["what"] == what]
        band(panel, mine["time_h"], mine, color=colour, linestyle=line, label=name)
    controls = [100 * float(control_shares(runs, "apical", t).mean()) for t in times]
    panel.plot(times, controls, color=GREY, linewidth=0.8, label=CONTROLS)
    mark_events(panel, cells)
    time_axis(panel, times[-1])
    panel.set_ylim(-2, 102)


def time_series_entries() -> dict[str, Line2D | Patch]:
    """Return the legend of ratios against time."""
    lines: dict[str, Line2D | Patch] = {
        name: Line2D([], [], color=colour, linestyle=line) for colour, line, name in OUTCOMES.values()
    }
    return lines | {CONTROLS: Line2D([], [], color=GREY, linewidth=0.8)}


def time_axis(panel: Axes, end: float) -> None:
    """Set the time axis from the start to the end [h], with few ticks."""
    step = next((one for one in STEPS if end / one <= MOST_TICKS), end / MOST_TICKS)
    panel.set(xlim=(0.0, end), xticks=np.arange(0.0, end + step / 100, step))


def mark_events(panel: Axes, cells: pd.DataFrame) -> None:
    """Mark each time of events that is the same for all cells, and not never."""
    found: dict[float, str] = {}
    for event in timed(cells):
        times = cells[time_column(event)]
        first = float(times.iloc[0])
        if math.isfinite(first) and (times == first).all():
            found[first] = found.get(first, "") + event
    for t, events in found.items():
        panel.axvline(t, color=GREY, linestyle=":", linewidth=1.0)
        panel.annotate(f"[{events}]", (t, 1), (2, -1), ("data", "axes fraction"), "offset points", va="top")
