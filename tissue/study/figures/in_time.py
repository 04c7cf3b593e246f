"""Ratios of extruded cells against time: of any study, and Figures 10, 12 and 14 of chapter 4."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import pandas as pd

from tissue.pictures.sheet import GREY, Axes, Figure, Line2D
from tissue.study.categories import kept_times
from tissue.study.figures.cells import cells_of
from tissue.study.figures.course import (
    COMPLETE,
    END_MARK,
    RATIO,
    TIME,
    course_lines,
    draw_course,
    draw_ends,
)
from tissue.study.figures.needs import FigureSource, Sources, needs
from tissue.study.figures.panels import grid, name_axes
from tissue.study.figures.style import INTERVALS, band, caption, counted, legend

MAKES_NO_NUMBERS = True

ALONE = ("[A]", "[B]", "[S]", "[BP]")
ALONE_NO_INM = ("[A] no INM", "[B] no INM", "[S] no INM", "no EMT no INM")
# Shades of the colour of basal positioning, to tell the scenarios apart.
TWICE = {"[AxB]": ("#e0a100", "-"), "[AB]": ("#8f6400", "--"), "[BxA]": ("#3f2c00", ":")}
SINCE = "Basal positioning"
HEIGHT = 1.75  # inches of a panel
CAPTION = "{who}, {n} in each panel; bands: {intervals}, for each time; dotted: time of an event."


class _Drawn(NamedTuple):
    """Of one panel."""

    cells: pd.DataFrame
    ratios: pd.DataFrame


@needs(figure10="runs")
def figure_10(sources: Sources) -> Figure:
    """r(t) of (4.7) of an isolated cell with [A], [B], [S], [BP]."""
    return courses(sources, "figure10", ALONE, "Isolated EMT cell")


@needs(figure12="runs")
def figure_12(sources: Sources) -> Figure:
    """r(t) of (4.7) of an isolated cell without INM, with [A], [B], [S] and without any event."""
    return courses(sources, "figure12", ALONE_NO_INM, "Isolated EMT cell without INM")


@needs(figure14="runs")
def figure_14(sources: Sources) -> Figure:
    """r(t) of (4.7) with [A] and [B] at three pairs of times; and basal positioning since [A]."""
    figure, panels = grid([*TWICE, SINCE], list(sources), HEIGHT, sharey=True)
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
        since.legend(loc="upper left")
    name_axes(panels, TIME, RATIO)
    for preset in sources:
        panels[SINCE, preset].set(xlabel="time since [A] [h]")
    return _finished(figure, sources, "figure14", "Isolated EMT cell; x: a longer delay", runs)


def courses(sources: Sources, study: str, scenarios: Sequence[str], who: str) -> Figure:
    """A panel for each scenario of a study; ``who`` its EMT cells are."""
    figure, panels = grid(scenarios, list(sources), HEIGHT, sharey=True, sharex="col" if len(sources) > 1 else False)
    runs = [
        _draw(panel, sources[preset], study, scenario).cells["replicate"].nunique()
        for (scenario, preset), panel in panels.items()
    ]
    name_axes(panels, TIME, RATIO)
    return _finished(figure, sources, study, who, runs)


def _draw(panel: Axes, source: FigureSource, study: str, scenario: str) -> _Drawn:
    """The course of a scenario, and its end by complete studies if those are kept."""
    results = source.studies[study]
    cells = cells_of(results, scenario)
    table = draw_course(panel, cells, results.runs(scenario))
    if source.is_kept("ratios", study):
        rows = source.rows("ratios", study)
        draw_ends(panel, rows[rows["scenario"] == scenario], kept_times(cells)[-1])
    return _Drawn(cells, table)


def _finished(figure: Figure, sources: Sources, study: str, who: str, runs: Sequence[int]) -> Figure:
    text = CAPTION.format(who=who, n=counted(runs, "runs"), intervals=INTERVALS)
    lines = course_lines()
    complete = [source.rows("ratios", study) for source in sources.values() if source.is_kept("ratios", study)]
    if complete:
        lines[COMPLETE] = Line2D([], [], color=GREY, **END_MARK)
        many = counted([int(n) for rows in complete for n in rows["runs"]], "runs of each scenario")
        text += f" Diamonds: the end by complete studies, {many}."
    legend(figure, lines)
    caption(figure, text)
    return figure
