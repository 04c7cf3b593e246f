"""Figures of the third dimension: how sheets grow, and where their isolated cells go."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pandas as pd

from tissue.pictures.charts import CHART_STYLE, RatioSeries, legend, page
from tissue.pictures.sheet import Line2D, Patch, style, write
from verification.tissues.curved import draw_sides
from verification.tissues.space.growth import ALL, SOME
from verification.tissues.space.isolated import SLICES, TISSUES

HEIGHT = 4.0  # inches
LOOKS = {
    "slice": ("0.25", "o"),
    "tube": ("0.6", "D"),
    "free sheet": ("#2e78b7", "^"),
    "free sheet, weak repulsion": ("#8e6bbf", "v"),
    "periodic sheet": ("#d1495b", "s"),
}
LINES = {45: ":", 180: "-", 196: "-", 400: "--", 2304: ":", 600: "-"}
LABELS = {
    "slice": "slice, 20 % stay",
    "growing": "free sheet, all stay",
    "inner": "away from its edge",
    "periodic": "periodic sheet, 20 % stay",
}
WAYS: dict[str, dict[str, Any]] = {
    "slice": {"color": "0.25", "marker": "o"},
    "growing": {"color": "#2e78b7", "marker": "^"},
    "inner": {"color": "#2e78b7", "marker": "^", "markerfacecolor": "white"},
    "periodic": {"color": "#d1495b", "marker": "s"},
}


def draw_growth(growth: pd.DataFrame, path: Path) -> Path:
    """Draw the height over the height at the start, in a panel for each share of divisions with both daughters kept."""
    entries: dict[str, Line2D | Patch] = {}
    with style(**CHART_STYLE):
        figure = page(HEIGHT)
        panels = figure.subplots(1, 2, sharey=True)
        for panel, both in zip(panels, (SOME, ALL), strict=True):
            for (layer, cells), mine in growth[growth["both"] == both].groupby(["layer", "cells"], sort=False):
                colour, marker = LOOKS[layer]
                name, *more = layer.split(", ")
                look: dict[str, Any] = {"color": colour, "marker": marker, "linestyle": LINES[cells], "markersize": 4}
                entries[", ".join((f"{name} of {cells}", *more))] = Line2D([], [], **look)
                panel.plot(mine["t"], mine["height"], **look)
                panel.fill_between(
                    mine["t"], mine["height_low"], mine["height_high"], color=colour, alpha=0.2, linewidth=0
                )
            part = "always" if both == ALL else f"{100 * both:.0f} %"
            panel.set(xlabel="time [h]", title=f"both daughters stay: {part}")
        panels[0].set_ylabel("height / height at the start")
        legend(figure, entries)
    write(figure, path)
    return path


def draw_isolated(ratios: pd.DataFrame, path: Path) -> Path:
    """Draw, for each set of events, the ratio of cells that have left on either side, in the slice and in sheets."""
    names = list(SLICES)
    named = ratios.rename(columns={"scenario": "events", "what": "side"})
    series = [RatioSeries(LABELS[one], named[named["tissue"] == one], WAYS[one]) for one in TISSUES]
    return draw_sides(series, names, 5.0, path)
