"""Figures 20 to 22 of chapter 4: basal extrusion given the time of an event, and given the position at the onset."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd

from tissue.pictures.sheet import GREY, Axes, Figure, Line2D, Patch
from tissue.study.categories import by_selection, happened, kept_times, outcome, time_column
from tissue.study.curves import given
from tissue.study.figures.needs import POPULATIONS, Studies, needs, population
from tissue.study.figures.style import (
    ENVIRONMENTS,
    EVENT_COLOURS,
    INTERVALS,
    OUTCOMES,
    POSITION,
    band,
    caption,
    counted,
    legend,
    page,
    percent_axis,
)

MAKES_NO_NUMBERS = True

ONE = "table5_35"
GROUP = "Heterogeneous groups, 35 % of the cells with [P]"
TIMES = np.arange(6.0, 25.0, 2.0)  # [h], of intervals of event times
PLACES = np.linspace(0.0, 1.0, 11)  # of positions at the onset
PROGRAMS = ("A", "B", "AB")
MARKERS = ("o", "s", "^")
MOST = 4000  # dots in a scatter plot
SEED = 0  # of the choice of dots
SHOWN = (-0.75, 1.5)  # of the apical-basal scale
DOT = 4.0  # points
STILL = "#b8b8b8"  # of cells that stay in the tissue


@needs(*POPULATIONS)
def figure_20(results: Studies) -> Figure:
    """E[basal extrusion | time of the event] of (4.12) for [A], [B], [P], all cells and those without [P].

    The caption of the thesis names [S] in place of [P], but [S] does not happen in the populations of
    Table 5 of chapter 4.
    """
    figure = page(5.4)
    panels = figure.subplot_mosaic([["A", "B", "P"], ["A calm", "B calm", "P"]], sharex=True)
    tables = {name: population(results, name) for name in POPULATIONS}
    calm = {name: cells[~happened(cells, kept_times(cells)[-1])["P"]] for name, cells in tables.items()}
    for name, panel in panels.items():
        _against_time(panel, calm if name.endswith("calm") else tables, name[0])
        panel.set(title=f"[{name[0]}], {'cells without [P]' if name.endswith('calm') else 'all cells with it'}")
        percent_axis(panel, "basal extrusion at the end [%]")
        panel.set_xlabel("time of the event [h]")
        panel.label_outer()
    panels["P"].tick_params(labelleft=True)  # of another height than those beside it
    legend(figure, {ENVIRONMENTS[name][1]: Line2D([], [], **_look(name)) for name in POPULATIONS})
    numbers = counted(map(len, tables.values()), "cells in a population")
    caption(figure, f"{numbers}, in intervals of 2 h; [P]: when it begins to act, not before [B]; bands: {INTERVALS}.")
    return figure


@needs(ONE)
def figure_21(results: Studies) -> Figure:
    """E[basal extrusion | position at the onset] of 3.3.4, cells without [P], by their events."""
    figure = page(3.9)
    panels = figure.subplots(1, 2, sharex=True, sharey=True)
    cells, counts = _without_p(population(results, ONE)), []
    for panel, inm, title in zip(panels, (True, False), ("With INM", "Without INM"), strict=True):
        mine = cells[cells["inm"] == inm]
        counts.append(len(mine))
        selection = by_selection(mine, kept_times(mine)[-1])
        for events, marker in zip(PROGRAMS, MARKERS, strict=True):
            _against_onset(
                panel, mine[selection == events], color=EVENT_COLOURS[events], marker=marker, label=f"[{events}]"
            )
        panel.set(title=title, xlabel=f"position at the onset, {POSITION}", xlim=(0, 1))
        percent_axis(panel, "basal extrusion at the end [%]")
        panel.label_outer()
    legend(figure, dict(zip(*panels[0].get_legend_handles_labels()[::-1], strict=True)))
    text = f"{GROUP}: cells with [A], [B] or both in any order, without [P]"
    caption(figure, f"{text}; {counted(counts, 'cells in a panel')}, in intervals of 0.1; bands: {INTERVALS}.")
    return figure


@needs(ONE)
def figure_22(results: Studies) -> Figure:
    """Position at the onset against the position at the end: a dot for each cell without [P]."""
    figure = page(4.2)
    panels = figure.subplots(1, 2, sharex=True, sharey=True)
    cells = _without_p(population(results, ONE))
    some = cells.sample(min(MOST, len(cells)), random_state=SEED)
    end = f"ab_{kept_times(cells)[-1]:g}h"
    for panel, inm, title in zip(panels, (True, False), ("With INM", "Without INM"), strict=True):
        _scatter(panel, some[some["inm"] == inm], end)
        panel.set(title=title, xlabel=f"position at the end, {POSITION}", xlim=SHOWN, ylim=(-0.1, 1.1))
        panel.set_xticks(np.arange(-0.5, SHOWN[1] + 0.1, 0.5))
        panel.label_outer()
    panels[0].set_ylabel(f"position at the onset, {POSITION}")
    names = {OUTCOMES[what][2]: OUTCOMES[what][0] for what in ("basal", "apical")} | {"in the tissue": STILL}
    legend(figure, {name: Patch(color=colour) for name, colour in names.items()})
    beyond = int((~some[end].between(*SHOWN)).sum())
    text = f"{GROUP}: cells with [A] or [B] and without [P], n = {len(some)} at random from {len(cells)}"
    caption(figure, f"{text}; {beyond} of these lie beyond the panels. Dotted: the basal and the apical layer.")
    return figure


def _without_p(cells: pd.DataFrame) -> pd.DataFrame:
    """Cells that begin an event before the end and never protrude."""
    return cells[~happened(cells, kept_times(cells)[-1])["P"] & cells["onset_ab"].notna()]


def _look(name: str) -> dict[str, Any]:
    """Of the line of a population."""
    marker = MARKERS[list(POPULATIONS).index(name)]
    return {"color": ENVIRONMENTS[name][0], "marker": marker, "markersize": DOT}


def _against_time(panel: Axes, tables: Mapping[str, pd.DataFrame], event: str) -> None:
    for name, cells in tables.items():
        hits = outcome(cells, "basal", kept_times(cells)[-1])
        table = given(hits, cells["replicate"], cells[time_column(event)], TIMES)
        band(panel, table["middle"], table, **_look(name))
    panel.set(xlim=(TIMES[0] - 0.5, TIMES[-1] + 0.5), xticks=TIMES[::3])


def _against_onset(panel: Axes, cells: pd.DataFrame, **look: str) -> None:
    hits = outcome(cells, "basal", kept_times(cells)[-1])
    table = given(hits, cells["replicate"], cells["onset_ab"], PLACES)
    band(panel, table["middle"], table, markersize=DOT, **look)


def _scatter(panel: Axes, cells: pd.DataFrame, end: str) -> None:
    """Dots in the colour of what became of the cell; those that stayed lie below the others."""
    basal, apical = cells[end] < 0, cells[end] > 1
    sides = ((~basal & ~apical, STILL), (apical, OUTCOMES["apical"][0]), (basal, OUTCOMES["basal"][0]))
    for side, colour in sides:
        panel.scatter(cells.loc[side, end], cells.loc[side, "onset_ab"], s=4, color=colour, linewidths=0)
    for layer in (0.0, 1.0):
        panel.axvline(layer, color=GREY, linewidth=0.8, linestyle=":")
