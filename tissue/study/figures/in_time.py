"""Ratios and positions against time: of any study, and Figures 10, 12 and 14 of chapter 4."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Literal, NamedTuple

import numpy as np
import pandas as pd

from tissue.pictures.charts import (
    COMPLETE,
    END_MARK,
    INTERVALS,
    OUTCOMES,
    POSITION,
    RATIO,
    TIME,
    band,
    caption,
    counted,
    draw_ends,
    draw_time_series,
    legend,
    mark_events,
    time_axis,
    time_series_entries,
)
from tissue.pictures.sheet import GREY, Axes, Figure, Line2D, Patch
from tissue.statistics.categories import What, kept_times
from tissue.study.figures.panels import grid, name_axes
from tissue.study.figures.sources import FigureSource, Sources, cells_of, needs

MAKES_NO_NUMBERS = True

ALONE = ("[A]", "[B]", "[S]", "[BP]")
ALONE_NO_INM = ("[A] no INM", "[B] no INM", "[S] no INM", "no EMT no INM")
# Shades of the colour of basal positioning, to tell the scenarios apart.
TWICE: dict[str, tuple[str, Literal["-", "--", ":"]]] = {
    "[AxB]": ("#e0a100", "-"),
    "[AB]": ("#8f6400", "--"),
    "[BxA]": ("#3f2c00", ":"),
}
SINCE = "Basal positioning"
HEIGHT, LEGEND_LINE = 1.75, 0.2  # inches of a panel, and for a second line of a legend
CAPTION = "{who}, {n} in each panel; bands: {intervals}, for each time; dotted: time of an event."


class _Panel(NamedTuple):
    """Cells and ratios of one panel."""

    cells: pd.DataFrame
    ratios: pd.DataFrame


@needs(figure10="runs")
def figure_10(sources: Sources) -> Figure:
    """Draw r(t) of (4.7) of an isolated cell with [A], [B], [S], [BP]."""
    return ratios_against_time(sources, "figure10", ALONE, "Isolated EMT cell")


@needs(figure12="runs")
def figure_12(sources: Sources) -> Figure:
    """Draw r(t) of (4.7) of an isolated cell without INM, with [A], [B], [S] and without any event."""
    return ratios_against_time(sources, "figure12", ALONE_NO_INM, "Isolated EMT cell without INM")


@needs(figure14="runs")
def figure_14(sources: Sources) -> Figure:
    """Draw r(t) of (4.7) with [A] and [B] at three pairs of times; and basal positioning since [A]."""
    figure, panels = grid([*TWICE, SINCE], list(sources), HEIGHT + LEGEND_LINE, sharey=True)
    runs = []
    for preset, source in sources.items():
        since = panels[SINCE, preset]
        for name, (colour, line) in TWICE.items():
            cells, table = _draw(panels[name, preset], source, "figure14", name)
            runs.append(cells["replicate"].nunique())
            mine = table[table["what"] == "below"]
            times = mine["time_h"] - float(cells["t_a_h"].iloc[0])
            band(since, times, mine, color=colour, linestyle=line, label=name)
        since.axvline(0.0, color=GREY, linestyle=":", linewidth=1.0)
    name_axes(panels, TIME, RATIO)
    for preset in sources:
        panels[SINCE, preset].set(xlabel="time since [A] [h]")
    lines: dict[str, Line2D | Patch] = {
        f"since [A]: {name}": Line2D([], [], color=colour, linestyle=line) for name, (colour, line) in TWICE.items()
    }
    return _finished(figure, sources, "figure14", "Isolated EMT cell; x: a longer delay", runs, lines)


def ratios_against_time(sources: Sources, study: str, scenarios: Sequence[str], who: str) -> Figure:
    """Draw a panel for each scenario of a study; ``who`` its EMT cells are."""
    figure, panels = grid(scenarios, list(sources), HEIGHT, sharey=True, sharex="col" if len(sources) > 1 else False)
    runs = [
        _draw(panel, sources[preset], study, scenario).cells["replicate"].nunique()
        for (scenario, preset), panel in panels.items()
    ]
    name_axes(panels, TIME, RATIO)
    return _finished(figure, sources, study, who, runs)


def _draw(panel: Axes, source: FigureSource, study: str, scenario: str) -> _Panel:
    """Draw the ratios of a scenario against time, and at the end those of complete studies, if they are kept."""
    results = source.studies[study]
    cells = cells_of(results, scenario)
    table = draw_time_series(panel, cells, results.runs(scenario))
    if source.is_kept("ratios", study):
        rows = source.rows("ratios", study)
        draw_ends(panel, rows[rows["scenario"] == scenario], kept_times(cells)[-1])
    return _Panel(cells, table)


def _finished(
    figure: Figure,
    sources: Sources,
    study: str,
    who: str,
    runs: Sequence[int],
    more: Mapping[str, Line2D | Patch] | None = None,
) -> Figure:
    """Add the caption and the legend, which ends with ``more``."""
    text = CAPTION.format(who=who, n=counted(runs, "runs"), intervals=INTERVALS)
    lines = time_series_entries()
    complete = [source.rows("ratios", study) for source in sources.values() if source.is_kept("ratios", study)]
    if complete:
        lines[COMPLETE] = Line2D([], [], color=GREY, **END_MARK)
        many = counted([int(n) for rows in complete for n in rows["runs"]], "runs of each scenario")
        text += f" Diamonds: the end by complete studies, {many}."
    legend(figure, lines | dict(more or {}))
    caption(figure, text)
    return figure


POSITIONS_HEIGHT = 1.85  # inches of a panel
INNER, OUTER = (25, 75), (5, 95)  # percentiles
BAND = "#4a4a4a"
SIDES: tuple[What, ...] = ("basal", "apical")
MOST = 8  # lines of single cells on each side
SEED = 0  # of their choice
WIDEST = (-2.0, 3.0)  # of the scale, that is shown at most
LEAST = (-0.3, 1.3)  # and at least


def positions(sources: Sources, study: str, scenarios: Sequence[str]) -> Figure:
    """Draw y_AB (3.3.1) against time by scenario: median, half and nine tenths of the cells, and some that left."""
    figure, panels = grid(scenarios, list(sources), POSITIONS_HEIGHT, sharey=True)
    tables = {key: cells_of(sources[key[1]].studies[study], key[0]) for key in panels}
    low, high = _shown(tables)
    for key, panel in panels.items():
        _draw_positions(panel, tables[key])
        panel.set_ylim(low, high)
    name_axes(panels, TIME, f"position {POSITION}")
    legend(figure, _entries())
    numbers = counted(map(len, tables.values()), "cells in a panel")
    text = f"Positions of nuclei, {numbers}; 0 is the basal layer, 1 the apical one. Thin lines: {MOST} cells at most"
    caption(figure, f"{text} on each side that are outside at the end; dots: since when. Dotted: time of an event.")
    return figure


def _draw_positions(panel: Axes, cells: pd.DataFrame) -> None:
    times = kept_times(cells)
    curves = cells[[f"ab_{t:g}h" for t in times]].to_numpy(float)
    for ends, alpha in ((OUTER, 0.18), (INNER, 0.3)):
        panel.fill_between(times, *np.percentile(curves, ends, axis=0), color=BAND, alpha=alpha, linewidth=0)
    panel.plot(times, np.median(curves, axis=0), color="black", linewidth=1.6, zorder=4)
    for layer in (0.0, 1.0):
        panel.axhline(layer, color=GREY, linewidth=0.9, zorder=1)
    chosen = np.random.default_rng(SEED)
    for what in SIDES:
        colour, _, _ = OUTCOMES[what]
        left = np.flatnonzero(cells["extruded"] == what)
        for k in np.sort(chosen.choice(left, min(MOST, len(left)), replace=False)):
            panel.plot(times, curves[k], color=colour, linewidth=0.6, alpha=0.8, zorder=2)
            since = float(cells["extruded_h"].iloc[k])
            panel.plot(since, np.interp(since, times, curves[k]), "o", color=colour, markersize=3.0, zorder=3)
    mark_events(panel, cells)
    time_axis(panel, times[-1])


def _shown(tables: Mapping[tuple[str, str], pd.DataFrame]) -> tuple[float, float]:
    """Return the part of the scale in which nine tenths of the cells of each scenario are."""
    ends = []
    for cells in tables.values():
        curves = cells[[f"ab_{t:g}h" for t in kept_times(cells)]].to_numpy(float)
        low, high = np.percentile(curves, OUTER, axis=0)
        ends.append((low.min() - 0.1, high.max() + 0.1))
    low, high = np.array(ends).T
    return max(WIDEST[0], min(LEAST[0], low.min())), min(WIDEST[1], max(LEAST[1], high.max()))


def _entries() -> dict[str, Line2D | Patch]:
    found: dict[str, Line2D | Patch] = {"median of all cells": Line2D([], [], color="black", linewidth=1.6)}
    found["half of them"] = Patch(color=BAND, alpha=0.42, linewidth=0)
    found["nine tenths"] = Patch(color=BAND, alpha=0.18, linewidth=0)
    for what in SIDES:
        colour, _, name = OUTCOMES[what]
        found[f"a cell with {name}"] = Line2D([], [], color=colour, linewidth=0.8, marker="o", markersize=3.0)
    return found
