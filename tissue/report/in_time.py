"""Figures of a study in time: positions of EMT cells, and ratios of extrusion."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from tissue.pictures.charts import (
    CHART_STYLE,
    POSITION,
    RATIO,
    TIME,
    draw_time_series,
    grid,
    legend,
    mark_events,
    time_axis,
    time_series_entries,
)
from tissue.pictures.sheet import GREY, Figure, Line2D, Patch, style
from tissue.study.categories import kept_times

if TYPE_CHECKING:
    from tissue.study.read import Results

HEIGHT = 1.8  # inches of a panel
PERCENTILES = (5, 25, 50, 75, 95)
BAND = "#4a4a4a"
WIDEST, LEAST = (-2.0, 3.0), (-0.3, 1.3)  # of the scale, shown at most and at least


def ratios_against_time(results: Results, scenarios: Sequence[str]) -> Figure:
    """Draw r(t) of (4.7) of the EMT cells in a panel for each of these scenarios, which have such cells."""
    with style(**CHART_STYLE):
        figure, panels = grid(scenarios, HEIGHT, x=TIME, y=RATIO, sharey=True)
        for scenario, panel in zip(scenarios, panels, strict=True):
            draw_time_series(panel, results.cells(scenario), results.runs(scenario))
        legend(figure, time_series_entries())
    return figure


def positions(results: Results, scenarios: Sequence[str]) -> Figure:
    """Draw y_AB (3.3.1) against time by scenario: median, half and nine tenths of the cells.

    The scenarios have EMT cells. The axis has nine tenths of the cells of each.
    """
    low, high = LEAST
    with style(**CHART_STYLE):
        figure, panels = grid(scenarios, HEIGHT, x=TIME, y=f"position {POSITION}", sharey=True)
        for panel, scenario in zip(panels, scenarios, strict=True):
            cells = results.cells(scenario)
            times = kept_times(cells)
            curves = np.array(cells[[f"ab_{t:g}h" for t in times]], np.float64)
            lowest, lower, median, upper, highest = np.percentile(curves, PERCENTILES, axis=0)
            panel.fill_between(times, lowest, highest, color=BAND, alpha=0.18, linewidth=0)
            panel.fill_between(times, lower, upper, color=BAND, alpha=0.3, linewidth=0)
            panel.plot(times, median, color="black", linewidth=1.6, zorder=4)
            for layer in (0.0, 1.0):
                panel.axhline(layer, color=GREY, linewidth=0.9, zorder=1)
            mark_events(panel, cells)
            time_axis(panel, times[-1])
            low, high = min(low, lowest.min() - 0.1), max(high, highest.max() + 0.1)
        panels[0].set_ylim(max(WIDEST[0], low), min(WIDEST[1], high))
        marks: dict[str, Line2D | Patch] = {"median of all cells": Line2D([], [], color="black", linewidth=1.6)}
        bands = {"half of them": 0.42, "nine tenths": 0.18}
        legend(figure, marks | {name: Patch(color=BAND, alpha=alpha, linewidth=0) for name, alpha in bands.items()})
    return figure
