"""The position on the apical-basal scale against time: all EMT cells of a scenario, and some of those that left."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd

from tissue.pictures.sheet import GREY, Axes, Figure, Line2D, Patch
from tissue.study.categories import What, kept_times
from tissue.study.figures.cells import cells_of
from tissue.study.figures.course import TIME, mark_events, time_axis
from tissue.study.figures.needs import Sources
from tissue.study.figures.panels import grid, name_axes
from tissue.study.figures.style import OUTCOMES, POSITION, caption, counted, legend

MAKES_NO_NUMBERS = True

HEIGHT = 1.85  # inches of a panel
INNER, OUTER = (25, 75), (5, 95)  # percentiles
BAND = "#4a4a4a"
SIDES: tuple[What, ...] = ("basal", "apical")
MOST = 8  # lines of single cells on each side
SEED = 0  # of their choice
WIDEST = (-2.0, 3.0)  # of the scale, that is shown at most
LEAST = (-0.3, 1.3)  # and at least


def positions(sources: Sources, study: str, scenarios: Sequence[str]) -> Figure:
    """y_AB (3.3.1) against time for each scenario: median, half and nine tenths of the cells, and some that left."""
    figure, panels = grid(scenarios, list(sources), HEIGHT, sharey=True)
    tables = {key: cells_of(sources[key[1]].studies[study], key[0]) for key in panels}
    low, high = _shown(tables)
    for key, panel in panels.items():
        _draw(panel, tables[key])
        panel.set_ylim(low, high)
    name_axes(panels, TIME, f"position {POSITION}")
    legend(figure, _entries())
    numbers = counted(map(len, tables.values()), "cells in a panel")
    text = f"Positions of nuclei, {numbers}; 0 is the basal layer, 1 the apical one. Thin lines: {MOST} cells at most"
    caption(figure, f"{text} on each side that are outside at the end; dots: since when. Dotted: time of an event.")
    return figure


def _draw(panel: Axes, cells: pd.DataFrame) -> None:
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
    """The part of the scale in which nine tenths of the cells of each scenario are."""
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
