"""Figures 17 to 19 of chapter 4: cells with the same events alone, in a homogeneous group and in heterogeneous ones."""

from __future__ import annotations

from collections.abc import Iterator

import pandas as pd

from tissue.pictures.sheet import Axes, Figure, Patch
from tissue.study.categories import NO_INM, by_order, kept_times, outcome
from tissue.study.figures.needs import POPULATIONS, Studies, cells_of, needs, population, ratio_of
from tissue.study.figures.style import ENVIRONMENTS, INTERVALS, bars, caption, counted, legend, page, percent_axis

MAKES_NO_NUMBERS = True

STUDIES = ("figure15", *POPULATIONS)
WIDE = 0.75


@needs(*STUDIES)
def figure_17(results: Studies) -> Figure:
    """Cells with [A], then [B], at 6 h and 18 h; in heterogeneous groups at any time from 6 h to 24 h."""
    return _compared(results, "[AxB]", "[AB]", "[A] at 6 h and [B] at 18 h", "[A], then [B]")


@needs(*STUDIES)
def figure_18(results: Studies) -> Figure:
    """Cells with [A] alone, at 6 h; in heterogeneous groups at any time."""
    return _compared(results, "[Ax]", "[A]", "[A] at 6 h", "[A] alone")


@needs(*STUDIES)
def figure_19(results: Studies) -> Figure:
    """Cells with [B] alone, at 6 h; in heterogeneous groups at any time."""
    return _compared(results, "[Bx]", "[B]", "[B] at 6 h", "[B] alone")


def _compared(results: Studies, scenario: str, order: str, fixed: str, drawn: str) -> Figure:
    figure = page(3.3)
    panels, counts = figure.subplots(1, 2, sharey=True), []
    for panel, suffix, title in zip(panels, ("", NO_INM), ("With INM", "Without INM"), strict=True):
        counts += _panel(panel, results, f"{scenario}{suffix}", f"{order}{suffix}")
        panel.set(title=f"{order}{title.replace('W', ' w')}")
        panel.label_outer()
    legend(figure, {name: Patch(color=colour) for colour, name in ENVIRONMENTS.values()})
    text = f"Alone and in the homogeneous group: {fixed}; in heterogeneous groups: cells with {drawn} at any time"
    caption(figure, f"{text}. {counted(counts, 'cells in a bar')}; whiskers: {INTERVALS}.")
    return figure


def _panel(panel: Axes, results: Studies, scenario: str, order: str) -> list[int]:
    """One bar for each environment; how many cells there are."""
    found = []
    for k, (name, cells) in enumerate(_cells(results, scenario, order)):
        hits = outcome(cells, "basal", kept_times(cells)[-1])
        found.append(ratio_of(hits, cells, f"{order} in {ENVIRONMENTS[name][1]}"))
        bars(panel, [k], found[-1:], width=WIDE, color=ENVIRONMENTS[name][0])
    panel.set(xticks=[])
    panel.grid(visible=False, axis="x")
    percent_axis(panel, "ratio of basal extrusion at the end [%]")
    return [one.of for one in found]


def _cells(results: Studies, scenario: str, order: str) -> Iterator[tuple[str, pd.DataFrame]]:
    """The cells in each environment."""
    yield "individual", cells_of(results["figure15"], scenario, last_only=True)
    yield "homogeneous", cells_of(results["figure15"], f"{scenario}, 10 cells", last_only=True)
    for name in POPULATIONS:
        cells = population(results, name)
        yield name, cells[by_order(cells, kept_times(cells)[-1], inm=True) == order]
