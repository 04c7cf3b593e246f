"""Ratios given an event time or the position at the onset: Figures 20 to 22 of chapter 4."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import Any

import numpy as np
import pandas as pd

from tissue.pictures.charts import (
    ENVIRONMENTS,
    INTERVALS,
    OUTCOMES,
    POSITION,
    LineStyle,
    band,
    caption,
    counted,
    legend,
    percent_axis,
)
from tissue.pictures.sheet import GREY, Axes, Figure, Line2D, Patch
from tissue.statistics.categories import happened, kept_times
from tissue.study.figures.panels import grid, name_axes
from tissue.study.figures.sources import INM, ONSETS, POPULATIONS, TIMES, Sources, needs, population

MAKES_NO_NUMBERS = True

STUDIES = dict.fromkeys(POPULATIONS, "conditional")
EVENTS = {"[A], cells without [P]": "t_a_h", "[B], cells without [P]": "t_b_h", "[P]": "t_p_h"}
MARKERS = dict(zip(POPULATIONS, ("o", "s", "^"), strict=True))
HEIGHT = 2.1  # inches of a panel
DOT = 4.0  # points
RATIO = "basal extrusion at the end [%]"
WITH, WITHOUT = INM.values()
LINES: dict[str, tuple[str, LineStyle]] = {WITH: ("with INM", "-"), WITHOUT: ("without INM", "--")}


@needs(**STUDIES)
def figure_20(sources: Sources) -> Figure:
    """Draw E[basal extrusion | time of the event] of (4.12) for [A], [B], [P], with INM and without.

    The caption of the thesis names [S] in place of [P], but [S] does not happen in the populations of
    Table 5 of chapter 4.
    """
    figure, panels = grid(list(EVENTS), list(sources), HEIGHT, sharex=True, sharey=True)
    counts: list[int] = []
    for (title, preset), panel in panels.items():
        for study, inm in product(POPULATIONS, (WITH, WITHOUT)):
            counts += _draw(panel, sources[preset].rows("conditional", study), study, EVENTS[title], inm)
        panel.set(xlim=(TIMES[0], TIMES[-1]), xticks=TIMES[::2])
        percent_axis(panel, "")
    name_axes(panels, "time of the event [h]", RATIO)
    legend(figure, _entries((WITH, WITHOUT)))
    numbers = counted(counts, "cells in an interval of 3 h")
    caption(figure, f"{numbers}; [P]: when it begins to act, not before [B]; bands: {INTERVALS}.")
    return figure


@needs(**STUDIES)
def figure_21(sources: Sources) -> Figure:
    """Draw E[basal extrusion | position at the onset] of 3.3.4, cells without [P], with INM and without."""
    figure, panels = grid(["With INM", "Without INM"], list(sources), HEIGHT, sharex=True, sharey=True)
    counts: list[int] = []
    for (title, preset), panel in panels.items():
        for study in POPULATIONS:
            inm = WITH if title == "With INM" else WITHOUT
            counts += _draw(panel, sources[preset].rows("conditional", study), study, "onset_ab", inm)
        panel.set(xlim=(ONSETS[0], ONSETS[-1]))
        percent_axis(panel, "")
    name_axes(panels, f"position at the onset, {POSITION}", RATIO)
    legend(figure, _entries(()))
    numbers = counted(counts, "cells in an interval of 0.1")
    caption(figure, f"Cells of heterogeneous groups without [P]; {numbers}; bands: {INTERVALS}.")
    return figure


def _draw(panel: Axes, table: pd.DataFrame, study: str, column: str, inm: str) -> list[int]:
    """Draw the line of a population; return how many cells each of its intervals has."""
    mine = table[(table["given"] == column) & (table["inm"] == inm)]
    filled = {} if inm == WITH or column == "onset_ab" else {"markerfacecolor": "white", "linestyle": "--"}
    band(panel, mine["middle"], mine, **_look(study), **filled)
    return [int(n) for n in mine["of"]]


def _look(study: str) -> dict[str, Any]:
    return {"color": ENVIRONMENTS[study][0], "marker": MARKERS[study], "markersize": DOT}


def _entries(kinds: Sequence[str]) -> dict[str, Any]:
    """Return the legend: populations; with and without INM, if one panel has both."""
    found = {ENVIRONMENTS[name][1]: Line2D([], [], **_look(name)) for name in POPULATIONS}
    for inm in kinds:
        name, line = LINES[inm]
        found[name] = Line2D([], [], color="black", linestyle=line)
    return found


ONE = "table5_35"
GROUP = "Heterogeneous groups, 35 % of the cells with [P]"
MOST = 4000  # dots
SEED = 0  # of the choice of dots
SHOWN = (-0.75, 1.5)  # of the apical-basal scale
STILL = "#b8b8b8"  # of cells that stay in the tissue
SCATTER_HEIGHT = 3.2  # inches of a panel


@needs(table5_35="runs")
def figure_22(sources: Sources) -> Figure:
    """Draw position at the onset against the position at the end: a dot for each cell without [P]."""
    figure, panels = grid(["With INM", "Without INM"], list(sources), SCATTER_HEIGHT, sharex=True, sharey=True)
    tables = {preset: _without_p(population(source.studies[ONE], ONE)) for preset, source in sources.items()}
    some = {preset: cells.sample(min(MOST, len(cells)), random_state=SEED) for preset, cells in tables.items()}
    beyond = 0
    for (title, preset), panel in panels.items():
        cells = some[preset][some[preset]["inm"] == (title == "With INM")]
        end = f"ab_{kept_times(cells)[-1]:g}h"
        _scatter(panel, cells, end)
        panel.set(xlim=SHOWN, ylim=(-0.1, 1.1), xticks=np.arange(-0.5, SHOWN[1] + 0.1, 0.5))
        beyond += int((~cells[end].between(*SHOWN)).sum())
    name_axes(panels, f"position at the end, {POSITION}", f"position at the onset, {POSITION}")
    names = {OUTCOMES[what][2]: OUTCOMES[what][0] for what in ("basal", "apical")} | {"in the tissue": STILL}
    legend(figure, {name: Patch(color=colour) for name, colour in names.items()})
    shown, whole = counted(map(len, some.values()), "at random from"), (str(len(one)) for one in tables.values())
    text = f"{GROUP}: cells with [A] or [B] and without [P], {shown} {' and '.join(whole)}"
    caption(figure, f"{text}; {beyond} of these lie beyond the panels. Dotted: the basal and the apical layer.")
    return figure


def _without_p(cells: pd.DataFrame) -> pd.DataFrame:
    """Return cells that begin an event before the end and never protrude."""
    return cells[~happened(cells, kept_times(cells)[-1])["P"] & cells["onset_ab"].notna()]


def _scatter(panel: Axes, cells: pd.DataFrame, end: str) -> None:
    """Draw dots in the colour of what became of the cell; those that stayed lie below the others."""
    basal, apical = cells[end] < 0, cells[end] > 1
    sides = ((~basal & ~apical, STILL), (apical, OUTCOMES["apical"][0]), (basal, OUTCOMES["basal"][0]))
    for side, colour in sides:
        panel.scatter(cells.loc[side, end], cells.loc[side, "onset_ab"], s=4, color=colour, linewidths=0)
    for layer in (0.0, 1.0):
        panel.axvline(layer, color=GREY, linewidth=0.8, linestyle=":")
