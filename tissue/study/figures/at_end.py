"""Figures 13 and 15 of chapter 4: ratios at the end of the runs, scenario by scenario."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from tissue.pictures.sheet import Axes, Figure, Line2D, Patch
from tissue.study.categories import NO_INM, What, kept_times, outcome
from tissue.study.figures.in_time import ALONE, ALONE_NO_INM
from tissue.study.figures.needs import Studies, cells_of, needs, ratio_of
from tissue.study.figures.style import (
    CAP,
    ENVIRONMENTS,
    INTERVALS,
    OUTCOMES,
    bars,
    caption,
    counted,
    errors,
    legend,
    no_inm,
    page,
    percent_axis,
)
from tissue.study.ratios import Ratio

if TYPE_CHECKING:
    from tissue.study.read import Results

MAKES_NO_NUMBERS = True

EVENTS = ("[A]", "[B]", "[S]", "[BP]", "no EMT")
PROGRAMS = ("[ABP]", "[BAP]", "[BPx]", "[BxP]", "[AxB]", "[BxA]", "[Ax]", "[xA]", "[Bx]", "[xB]", "no EMT")
GROUP = ", 10 cells"
# Sections 4.1 and 4.2 of chapter 4, as parts of all cells.
PRINTED = {
    ("[A]", "apical"): 0.3,
    ("[A]", "basal"): 0.1,
    ("[A]", "below"): 0.6,
    ("[A] no INM", "basal"): 0.2,
    ("[B]", "basal"): 0.0,
    ("[B] no INM", "basal"): 0.7,
}
MARK: Any = {"marker": "D", "markersize": 5.5, "color": "white", "markeredgecolor": "black", "linestyle": "none"}
WIDE = 0.38  # of a bar, where two scenarios are 1 apart
APART = 0.17  # of the marks of one program
ENDS = {"individual": ("", "o"), "homogeneous": (GROUP, "s")}


@needs("figure10", "figure12")
def figure_13(results: Studies) -> Figure:
    """r(t_end) of (4.7) of isolated cells, with INM and without, beside the printed ratios."""
    figure = page(3.6)
    panels = figure.subplots(1, len(OUTCOMES), sharey=True)
    stored = dict.fromkeys(ALONE, results["figure10"]) | dict.fromkeys(ALONE_NO_INM, results["figure12"])
    found = {name: cells_of(study, name, last_only=True) for name, study in stored.items()}
    for panel, what in zip(panels, OUTCOMES, strict=True):
        _alone(panel, found, what)
        panel.set(title=OUTCOMES[what][2], xticks=range(len(EVENTS)), xticklabels=EVENTS)
        panel.grid(visible=False, axis="x")
        percent_axis(panel, "ratio of EMT cells at the end [%]")
        panel.label_outer()
    with_and_without = {"with INM": Patch(color="#555555"), "without INM": Patch(**no_inm("#555555"))}
    legend(figure, with_and_without | {"printed in the thesis": Line2D([], [], **MARK)})
    runs = counted((cells["replicate"].nunique() for cells in found.values()), "runs of each scenario")
    absent = "[BP] without INM, and no EMT with INM, are not among them"
    caption(figure, f"Isolated EMT cells, {runs}; {absent}; whiskers: {INTERVALS}.")
    return figure


def _alone(panel: Axes, found: Mapping[str, pd.DataFrame], what: What) -> None:
    """A bar for each scenario, and marks for the printed ratios."""
    colour = OUTCOMES[what][0]
    for names, shift, look in ((ALONE, -WIDE / 2, {"color": colour}), (ALONE_NO_INM, WIDE / 2, no_inm(colour))):
        ends = [_at_end(found[name], what, name) for name in names]
        places = [EVENTS.index(name.removesuffix(NO_INM)) + shift for name in names]
        bars(panel, places, ends, width=WIDE, **look)
        for x, name in zip(places, names, strict=True):
            if (name, what) in PRINTED:
                panel.plot(x, 100 * PRINTED[name, what], **MARK, zorder=5)


def _at_end(cells: pd.DataFrame, what: What, who: str) -> Ratio:
    return ratio_of(outcome(cells, what, kept_times(cells)[-1]), cells, who)


@needs("figure15")
def figure_15(results: Studies) -> Figure:
    """Basal extrusion at the end: eleven programs of events, alone and in a group, with INM and without."""
    figure = page(4.8)
    panels, runs = figure.subplots(1, 2, sharex=True, sharey=True), []
    for panel, suffix, title in zip(panels, ("", NO_INM), ("With INM", "Without INM"), strict=True):
        for (kind, (ending, marker)), shift in zip(ENDS.items(), (-APART, APART), strict=True):
            colour, name = ENVIRONMENTS[kind]
            found, counts = _programs(results["figure15"], suffix + ending)
            runs += counts
            places = np.arange(len(PROGRAMS)) + shift
            _dots(panel, found, places, color=colour, marker=marker, label=name)
        panel.set(title=title, xlabel="ratio of basal extrusion at the end [%]", xlim=(-2, 102))
    panels[0].set(yticks=range(len(PROGRAMS)), yticklabels=PROGRAMS)
    panels[0].invert_yaxis()
    legend(figure, dict(zip(*panels[0].get_legend_handles_labels()[::-1], strict=True)))
    numbers = counted(runs, "runs of each scenario")
    text = "One EMT cell, or a group of ten with the same events; x: a delay of 12 h"
    caption(figure, f"{text}; {numbers}; whiskers: {INTERVALS}.")
    return figure


def _programs(study: Results, suffix: str) -> tuple[list[Ratio], list[int]]:
    """Basal extrusion at the end of each program, and how many runs there are."""
    tables = [cells_of(study, f"{name}{suffix}", last_only=True) for name in PROGRAMS]
    found = [_at_end(cells, "basal", name) for cells, name in zip(tables, PROGRAMS, strict=True)]
    return found, [cells["replicate"].nunique() for cells in tables]


def _dots(panel: Axes, found: list[Ratio], places: np.ndarray, **look: Any) -> None:
    values = [100 * one.value for one in found]
    panel.errorbar(values, places, xerr=errors(found), linestyle="none", markersize=4.5, **CAP, **look)
