"""Charts of studies: their one style, and the ratios of one scenario against time with their bands."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Literal

import numpy as np
import pandas as pd

from tissue.pictures.sheet import GREY, Axes, Figure, Line2D, Patch, style
from tissue.statistics.categories import What, in_time, kept_times, time_column, timed
from tissue.statistics.proportions import LEVEL
from tissue.statistics.ratios import COLUMNS, ratios

MAKES_NO_NUMBERS = True

WIDTH = 9.2  # inches, as the pictures and the page of the report
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
# Around a cell; the populations of Table 5 of chapter 4 by the study that makes them.
ENVIRONMENTS = {
    "individual": ("#808080", "individual"),
    "homogeneous": ("#8c6bb1", "homogeneous group"),
    "table5_63": ("#00796b", "heterogeneous, 63 % [P]"),
    "table5_35": ("#2fa89a", "heterogeneous, 35 % [P]"),
    "table5_7": ("#7fcabf", "heterogeneous, 7 % [P]"),
}
POSITION = "$y_{AB}$"
PERCENT = f"{100 * LEVEL:g} %"
INTERVALS = f"{PERCENT} Wilson intervals on the effective number of cells"
CAPTION_SIZE, CAPTION_LETTERS = 8.0, 155  # points; in a line
MOST_ENTRIES = 4  # of a legend in a line
CAP: dict[str, Any] = {"capsize": 2.5, "elinewidth": 1.0, "capthick": 1.0}
# Fewer runs laid over complete studies.
CHECKED = "the runs of this page"
CHECK: dict[str, Any] = {"marker": "o", "markersize": 7.5, "markerfacecolor": "none", "color": "#9a9a9a", "zorder": 1.5}


def page(height: float) -> Figure:
    """Draw an empty figure, ``height`` in inches."""
    return Figure(figsize=(WIDTH, height), layout="constrained", dpi=DPI)


def verbatim(name: str) -> str:
    """Return a name from a file for a text of matplotlib, in which $ begins a formula."""
    return name.replace("$", r"\$")


def caption(figure: Figure, text: str, letters: int = CAPTION_LETTERS) -> None:
    """Write below the figure what it shows, of how many cells, and what the intervals are; ``letters`` in a line."""
    whole = text.replace("\n", " ").replace(" %", "\N{NO-BREAK SPACE}%")
    lines = textwrap.fill(whole, letters)
    figure.supxlabel(lines, x=0.01, ha="left", fontsize=CAPTION_SIZE, color="#333333")


def legend(figure: Figure, handles: Mapping[str, Line2D | Patch]) -> None:
    """Add one legend for all panels, above them."""
    columns = min(MOST_ENTRIES, len(handles))
    figure.legend(list(handles.values()), list(handles), loc="outside upper left", ncols=columns)


def outcome_lines() -> dict[str, Line2D | Patch]:
    """Return the legend of lines over time."""
    return {name: Line2D([], [], color=colour, linestyle=line) for colour, line, name in OUTCOMES.values()}


def band(panel: Axes, x: pd.Series, table: pd.DataFrame, **look: Any) -> None:
    """Draw a line of ratios [%] with their intervals; ``table`` as that of ``ratios``."""
    low, value, high = (100 * table[name] for name in ("low", "value", "high"))
    panel.fill_between(x, low, high, color=look["color"], alpha=0.18, linewidth=0)
    panel.plot(x, value, **look)


def percent_axis(panel: Axes, text: str) -> None:
    """Set an axis to the whole range of ratios."""
    panel.set(ylim=(-2, 102), ylabel=text)


def counted(numbers: Iterable[int], what: str) -> str:
    """Write how many there were: "n = 400 runs", or "n = 398 to 400 runs"."""
    found = sorted(set(numbers))
    span = f"{found[0]}" if len(found) == 1 else f"{found[0]} to {found[-1]}"
    return f"n = {span} {what}"


STEPS = (0.1, 0.25, 0.5, 1.0, 2.0, 3.0, 6.0, 12.0, 24.0, 48.0)  # [h] between two ticks
MOST_TICKS = 5
CONTROLS = "control cells, apical extrusion"
COMPLETE = "complete studies"
TIME = "time [h]"
RATIO = "ratio of EMT cells [%]"
END_MARK: Any = {"marker": "D", "markersize": 3.0, "linestyle": "none", "clip_on": False, "zorder": 4}
BEYOND = 0.015  # of the time, by which marks stand behind the end, and the time that they take


def ratios_in_time(cells: pd.DataFrame) -> pd.DataFrame:
    """Compute what ``over_time`` gives of these cells, at least one, for all output times at once."""
    times, parts = kept_times(cells), []
    replicate = pd.Series(np.tile(cells["replicate"], len(times)))
    category = pd.Series(np.repeat(times, len(cells)))
    for what, hits in in_time(cells).items():
        found = ratios(pd.Series(hits.ravel()), replicate, category)
        parts.append(found.rename_axis("time_h").reset_index().assign(what=what))
    return pd.concat(parts, ignore_index=True)[["what", "time_h", *COLUMNS]]


def draw_time_series(panel: Axes, cells: pd.DataFrame, runs: pd.DataFrame) -> pd.DataFrame:
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
    """Draw the ratios at the end of complete studies beside the end of a line, with their intervals."""
    for k, row in enumerate(rows.itertuples()):
        colour, _, _ = OUTCOMES[row.outcome]
        value, low, high = (100 * number for number in (row.value, row.low, row.high))
        at = end * (1 + (k + 1) * BEYOND)
        panel.errorbar(at, value, yerr=[[value - low], [high - value]], color=colour, **END_MARK, **CAP)
    panel.set_xlim(right=end * (1 + (len(rows) + 1) * BEYOND))


def plot_time_series(ax: Axes | None, scenario: str, cells: pd.DataFrame, runs: pd.DataFrame) -> Axes:
    """Draw ratios against time with a title, into ``ax`` or, if it is None, into a figure of its own with a legend."""
    with style(**CHART_STYLE):
        panel = _alone() if ax is None else ax
        draw_time_series(panel, cells, runs)
        panel.set(title=f"{scenario}, {len(runs)} run{'s' * (len(runs) != 1)}", xlabel=TIME)
    return panel


def time_series_entries() -> dict[str, Line2D | Patch]:
    """Return the legend of ratios against time."""
    return outcome_lines() | {CONTROLS: Line2D([], [], color=GREY, linewidth=0.8)}


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


def _alone() -> Axes:
    figure = page(4.0)
    legend(figure, time_series_entries())
    return figure.subplots()


def _of_controls(runs: pd.DataFrame, times: Sequence[float]) -> list[float]:
    """Return the share of control cells that are extruded apically [%]."""
    counts = [(runs[f"controls_apical_{t:g}h"].sum(), runs[f"controls_{t:g}h"].sum()) for t in times]
    return [100 * float(apical) / float(every) for apical, every in counts]
