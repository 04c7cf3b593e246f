"""One scenario against time: the ratios of extruded cells with their bands."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pandas as pd

from tissue.pictures.sheet import GREY, Axes, Line2D, Patch, style
from tissue.study.categories import kept_times, time_column, timed
from tissue.study.curves import over_time
from tissue.study.figures.style import LOOK, OUTCOMES, band, legend, outcome_lines, page, percent_axis

MAKES_NO_NUMBERS = True

HOURS = 12.0  # between two ticks
CONTROLS = "control cells, apical extrusion"
TIME = "time [h]"
RATIO = "ratio of EMT cells [%]"


def draw_course(panel: Axes, cells: pd.DataFrame, runs: pd.DataFrame) -> pd.DataFrame:
    """Draw r(t) of (4.7) for the three outcomes, and apical extrusion of the control cells.

    Parameters
    ----------
    panel
        Where to draw.
    cells, runs
        Tables of one scenario, see ``Results``; there is at least one cell.

    Returns
    -------
    pd.DataFrame
        The ratios of the EMT cells, as ``over_time`` gives them.
    """
    table = over_time(cells)
    for what, (colour, line, name) in OUTCOMES.items():
        mine = table[table["what"] == what]
        band(panel, mine["time_h"], mine, color=colour, linestyle=line, label=name)
    times = kept_times(cells)
    panel.plot(times, _of_controls(runs, times), color=GREY, linewidth=0.8, label=CONTROLS)
    _mark(panel, cells)
    panel.set(xlim=(times[0], times[-1]))
    if times[-1] >= HOURS:
        panel.set_xticks(np.arange(0.0, times[-1] + 1.0, HOURS))
    percent_axis(panel, RATIO)
    return table


def plot_course(ax: Axes | None, scenario: str, cells: pd.DataFrame, runs: pd.DataFrame) -> Axes:
    """``draw_course`` with a title, into ``ax`` or, if it is None, into a figure of its own with a legend."""
    with style(**LOOK):
        panel = _alone() if ax is None else ax
        draw_course(panel, cells, runs)
        panel.set(title=f"{scenario}, {len(runs)} run{'s' * (len(runs) != 1)}", xlabel=TIME)
    return panel


def course_lines() -> dict[str, Line2D | Patch]:
    """The legend of courses."""
    return outcome_lines() | {CONTROLS: Line2D([], [], color=GREY, linewidth=0.8)}


def _alone() -> Axes:
    figure = page(4.0)
    legend(figure, course_lines())
    return figure.subplots()


def _of_controls(runs: pd.DataFrame, times: Sequence[float]) -> list[float]:
    """Control cells that are extruded apically, of all [%]."""
    counts = [(runs[f"controls_apical_{t:g}h"].sum(), runs[f"controls_{t:g}h"].sum()) for t in times]
    return [100 * float(apical) / float(every) for apical, every in counts]


def _mark(panel: Axes, cells: pd.DataFrame) -> None:
    """A line at each time of events that is the same for all cells, and not never."""
    found: dict[float, str] = {}
    for event in timed(cells):
        times = cells[time_column(event)]
        first = float(times.iloc[0])
        if math.isfinite(first) and (times == first).all():
            found[first] = found.get(first, "") + event
    for t, events in found.items():
        panel.axvline(t, color=GREY, linestyle=":", linewidth=1.0)
        panel.annotate(f"[{events}]", (t, 1), (2, -1), ("data", "axes fraction"), "offset points", va="top")
