"""Figures 10, 12 and 14 of chapter 4: ratios of extruded cells against time."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import pandas as pd

from tissue.pictures.sheet import GREY, Axes, Figure
from tissue.study.figures.course import RATIO, TIME, course_lines, draw_course
from tissue.study.figures.needs import Studies, cells_of, needs
from tissue.study.figures.style import (
    INTERVALS,
    band,
    caption,
    counted,
    legend,
    page,
)

if TYPE_CHECKING:
    from tissue.study.read import Results

MAKES_NO_NUMBERS = True

ALONE = ("[A]", "[B]", "[S]", "[BP]")
ALONE_NO_INM = ("[A] no INM", "[B] no INM", "[S] no INM", "no EMT no INM")
# Shades of the colour of basal positioning, to tell the scenarios apart.
TWICE = {"[AxB]": ("#e0a100", "-"), "[AB]": ("#8f6400", "--"), "[BxA]": ("#3f2c00", ":")}
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
    legend(figure, course_lines())
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
    legend(figure, course_lines())
    caption(figure, CAPTION.format(n=counted(runs, "runs")) + more)
    return figure


def _panel(panel: Axes, study: Results, scenario: str) -> tuple[pd.DataFrame, pd.DataFrame]:
    """The course of a scenario. The cells, and their ratios."""
    cells = cells_of(study, scenario)
    table = draw_course(panel, cells, study.runs(scenario))
    panel.set(title=scenario)
    return cells, table


def _since(panel: Axes, cells: pd.DataFrame, table: pd.DataFrame, scenario: str) -> None:
    """Basal positioning against the time since [A]."""
    mine = table[table["what"] == "below"]
    since = mine["time_h"] - float(cells["t_a_h"].iloc[0])
    colour, line = TWICE[scenario]
    band(panel, since, mine, color=colour, linestyle=line, label=scenario)
