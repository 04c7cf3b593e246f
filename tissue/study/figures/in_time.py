"""Figures 10, 12 and 14 of chapter 4: ratios of extruded cells against time."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from tissue.sheet import GREY, Axes, Figure, Line2D
from tissue.study.categories import EVENTS, kept_times, time_column
from tissue.study.curves import over_time
from tissue.study.figures.needs import Studies, cells_of, needs
from tissue.study.figures.style import (
    INTERVALS,
    OUTCOMES,
    band,
    caption,
    counted,
    legend,
    outcome_lines,
    page,
    percent_axis,
)

if TYPE_CHECKING:
    from tissue.study.read import Results

ALONE = ("[A]", "[B]", "[S]", "[BP]")
ALONE_NO_INM = ("[A] no INM", "[B] no INM", "[S] no INM", "no EMT no INM")
# Shades of the colour of basal positioning, to tell the scenarios apart.
TWICE = {"[AxB]": ("#e0a100", "-"), "[AB]": ("#8f6400", "--"), "[BxA]": ("#3f2c00", ":")}
HOURS = 12.0  # between two ticks
CONTROLS = "control cells, apical extrusion"
TIME = "time [h]"
RATIO = "ratio of EMT cells [%]"
CAPTION = f"Isolated EMT cell, {{n}} in each panel; bands: {INTERVALS}, for each time; dotted: time of an event."


@needs("figure10")
def figure_10(results: Studies) -> Figure:
    """r(t) of (4.7) of an isolated cell with [A], [B], [S], [BP]."""
    return _row(results["figure10"], ALONE, "")


@needs("figure12")
def figure_12(results: Studies) -> Figure:
    """r(t) of (4.7) of an isolated cell without INM, with [A], [B], [S] and without any event."""
    return _row(results["figure12"], ALONE_NO_INM, " The EMT cell has no INM.")


@needs("figure14")
def figure_14(results: Studies) -> Figure:
    """Left: r(t) of (4.7) with [A] and [B] at three pairs of times; right: basal positioning since [A]."""
    figure = page(5.4)
    places = figure.subplot_mosaic([[name, "since"] for name in TWICE], width_ratios=(1.0, 1.25))
    study, runs = results["figure14"], []
    for name in TWICE:
        tables = _panel(places[name], study, name)
        runs.append(tables[0]["replicate"].nunique())
        _since(places["since"], *tables, name)
        places[name].label_outer()
    places["[BxA]"].set_xlabel(TIME)
    places["since"].set(title="Basal positioning", xlabel="time since [A] [h]", ylabel=RATIO, ylim=(-2, 102))
    places["since"].axvline(0.0, color=GREY, linestyle=":", linewidth=1.0)
    places["since"].legend(loc="upper left")
    legend(figure, outcome_lines() | {CONTROLS: _thin()})
    caption(figure, CAPTION.format(n=counted(runs, "runs")) + " x: a longer delay.")
    return figure


def _row(study: Results, scenarios: Sequence[str], more: str) -> Figure:
    figure = page(3.4)
    panels = figure.subplots(1, len(scenarios), sharex=True, sharey=True)
    runs = []
    for panel, name in zip(panels, scenarios, strict=True):
        runs.append(_panel(panel, study, name)[0]["replicate"].nunique())
        panel.set(xlabel=TIME)
        panel.label_outer()
    legend(figure, outcome_lines() | {CONTROLS: _thin()})
    caption(figure, CAPTION.format(n=counted(runs, "runs")) + more)
    return figure


def _panel(panel: Axes, study: Results, scenario: str) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Three outcomes against time, and apical extrusion of the control cells. The cells, and their ratios."""
    cells = cells_of(study, scenario)
    table = over_time(cells)
    for what, (colour, line, _) in OUTCOMES.items():
        mine = table[table["what"] == what]
        band(panel, mine["time_h"], mine, color=colour, linestyle=line)
    times = kept_times(cells)
    panel.plot(times, _of_controls(study.runs(scenario), times), color=GREY, linewidth=0.8)
    _mark(panel, cells)
    panel.set(title=scenario, xlim=(times[0], times[-1]), xticks=np.arange(0.0, times[-1] + 1.0, HOURS))
    percent_axis(panel, RATIO)
    return cells, table


def _of_controls(runs: pd.DataFrame, times: Sequence[float]) -> list[float]:
    """Control cells that are extruded apically, of all [%]."""
    counts = [(runs[f"controls_apical_{t:g}h"].sum(), runs[f"controls_{t:g}h"].sum()) for t in times]
    return [100 * float(apical) / float(every) for apical, every in counts]


def _mark(panel: Axes, cells: pd.DataFrame) -> None:
    """A line at each time of events that is the same for all cells, and not never."""
    found: dict[float, str] = {}
    for event in EVENTS:
        times = cells[time_column(event)]
        first = float(times.iloc[0])
        if math.isfinite(first) and (times == first).all():
            found[first] = found.get(first, "") + event
    for t, events in found.items():
        panel.axvline(t, color=GREY, linestyle=":", linewidth=1.0)
        panel.annotate(f"[{events}]", (t, 1), (2, -1), ("data", "axes fraction"), "offset points", va="top")


def _since(panel: Axes, cells: pd.DataFrame, table: pd.DataFrame, scenario: str) -> None:
    """Basal positioning against the time since [A]."""
    mine = table[table["what"] == "below"]
    since = mine["time_h"] - float(cells["t_a_h"].iloc[0])
    colour, line = TWICE[scenario]
    band(panel, since, mine, color=colour, linestyle=line, label=scenario)


def _thin() -> Line2D:
    return Line2D([], [], color=GREY, linewidth=0.8)
