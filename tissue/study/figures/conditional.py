"""Figures 20 and 21 of chapter 4: basal extrusion given the time of an event, and given the position at the onset."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import Any

import pandas as pd

from tissue.pictures.sheet import Axes, Figure, Line2D
from tissue.study.figures.cells import POPULATIONS
from tissue.study.figures.needs import Sources, needs
from tissue.study.figures.panels import grid, name_axes
from tissue.study.figures.style import (
    ENVIRONMENTS,
    INTERVALS,
    POSITION,
    LineStyle,
    band,
    caption,
    counted,
    legend,
    percent_axis,
)
from tissue.study.figures.tables import INM, ONSETS, TIMES

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
    """E[basal extrusion | time of the event] of (4.12) for [A], [B], [P], with INM and without.

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
    """E[basal extrusion | position at the onset] of 3.3.4, cells without [P], with INM and without."""
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
    """The line of a population; how many cells each of its intervals has."""
    mine = table[(table["given"] == column) & (table["inm"] == inm)]
    filled = {} if inm == WITH or column == "onset_ab" else {"markerfacecolor": "white", "linestyle": "--"}
    band(panel, mine["middle"], mine, **_look(study), **filled)
    return [int(n) for n in mine["of"]]


def _look(study: str) -> dict[str, Any]:
    return {"color": ENVIRONMENTS[study][0], "marker": MARKERS[study], "markersize": DOT}


def _entries(kinds: Sequence[str]) -> dict[str, Any]:
    """The legend: populations; with and without INM, if one panel has both."""
    found = {ENVIRONMENTS[name][1]: Line2D([], [], **_look(name)) for name in POPULATIONS}
    for inm in kinds:
        name, line = LINES[inm]
        found[name] = Line2D([], [], color="black", linestyle=line)
    return found
