"""One scenario against time: the ratios of extruded cells with their bands."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd

from tissue.pictures.sheet import GREY, Axes, Line2D, Patch, style
from tissue.study.categories import in_time, kept_times, time_column, timed
from tissue.study.figures.style import CAP, LOOK, OUTCOMES, band, legend, outcome_lines, page, percent_axis
from tissue.study.ratios import COLUMNS, ratios

MAKES_NO_NUMBERS = True

STEPS = (0.1, 0.25, 0.5, 1.0, 2.0, 3.0, 6.0, 12.0, 24.0, 48.0)  # [h] between two ticks
MOST_TICKS = 5
CONTROLS = "control cells, apical extrusion"
COMPLETE = "complete studies"
TIME = "time [h]"
RATIO = "ratio of EMT cells [%]"
END_MARK: Any = {"marker": "D", "markersize": 3.0, "linestyle": "none", "clip_on": False, "zorder": 4}
BEYOND = 0.015  # of the time, by which marks stand behind the end, and the time that they take


def ratios_in_time(cells: pd.DataFrame) -> pd.DataFrame:
    """What ``over_time`` gives of these cells, of which there is one at least; all kept times at once."""
    times, parts = kept_times(cells), []
    replicate = pd.Series(np.tile(cells["replicate"], len(times)))
    category = pd.Series(np.repeat(times, len(cells)))
    for what, hits in in_time(cells).items():
        found = ratios(pd.Series(hits.ravel()), replicate, category)
        parts.append(found.rename_axis("time_h").reset_index().assign(what=what))
    return pd.concat(parts, ignore_index=True)[["what", "time_h", *COLUMNS]]


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
    table = ratios_in_time(cells)
    for what, (colour, line, name) in OUTCOMES.items():
        mine = table[table["what"] == what]
        band(panel, mine["time_h"], mine, color=colour, linestyle=line, label=name)
    times = kept_times(cells)
    panel.plot(times, _of_controls(runs, times), color=GREY, linewidth=0.8, label=CONTROLS)
    mark_events(panel, cells)
    time_axis(panel, times[-1])
    percent_axis(panel, RATIO)
    return table


def draw_ends(panel: Axes, rows: pd.DataFrame, end: float) -> None:
    """Beside the end of a course the ratios of complete studies then, with their intervals."""
    for k, row in enumerate(rows.itertuples()):
        colour, _, _ = OUTCOMES[row.outcome]
        value, low, high = (100 * number for number in (row.value, row.low, row.high))
        at = end * (1 + (k + 1) * BEYOND)
        panel.errorbar(at, value, yerr=[[value - low], [high - value]], color=colour, **END_MARK, **CAP)
    panel.set_xlim(right=end * (1 + (len(rows) + 1) * BEYOND))


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


def time_axis(panel: Axes, end: float) -> None:
    """From the start to the end [h], with few ticks."""
    step = next((one for one in STEPS if end / one <= MOST_TICKS), end / MOST_TICKS)
    panel.set(xlim=(0.0, end), xticks=np.arange(0.0, end + step / 100, step))


def mark_events(panel: Axes, cells: pd.DataFrame) -> None:
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


def _alone() -> Axes:
    figure = page(4.0)
    legend(figure, course_lines())
    return figure.subplots()


def _of_controls(runs: pd.DataFrame, times: Sequence[float]) -> list[float]:
    """Control cells that are extruded apically, of all [%]."""
    counts = [(runs[f"controls_apical_{t:g}h"].sum(), runs[f"controls_{t:g}h"].sum()) for t in times]
    return [100 * float(apical) / float(every) for apical, every in counts]
