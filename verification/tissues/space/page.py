"""The third dimension: how sheets grow, and whether isolated cells go where they go in slices."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pandas as pd

from tissue.pictures.charts import CHART_STYLE, RatioSeries, legend, page
from tissue.pictures.sheet import Line2D, Patch, style, write
from verification.site.context import Context
from verification.tissues.curved import draw_sides
from verification.tissues.space import growth, isolated, sheet
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
FOLDED = {"layer": "Tissue", "cells": "Cells", "both": "Share of divisions that keep both daughters"}
FOLDED |= {"folded": "Runs with a folded layer", "runs": "Runs"}


def grow(context: Context) -> None:
    """Take over the study of growing sheets."""
    context.keep("space_heights", growth.means(context.rows("space_growth")))


def run(context: Context) -> None:
    """Take over all studies."""
    context.keep("space_sheet_means", sheet.means(context.rows("space_sheet")))
    grow(context)
    ratios = isolated.with_slices(context.rows("space_isolated"))
    context.keep("space_isolated_ratios", ratios)
    context.keep("space_compared", isolated.compared(ratios))


def show(context: Context) -> None:
    """Give the fitted sheet, growth, isolated cells."""
    tables = context.tables
    fitted, heights, ratios = (tables[f"space_{name}"] for name in ("sheet_means", "heights", "isolated_ratios"))
    kept = fitted[fitted["t"].isin((0.0, 6.0, 24.0, 48.0))]
    context.show("space_sheet", context.headed("space_sheet", kept), "space_sheet_means")
    context.draw("space_growth", draw_growth, heights)
    last = heights[heights["t"] == growth.END]
    context.show("space_heights", context.headed("space_growth", last))
    folded = last[last["folded"] > 0]
    context.show("space_folded", folded[list(FOLDED)].rename(columns=FOLDED), "space_heights")
    context.draw("space_isolated", draw_isolated, ratios)
    for name in ("compared", "isolated_ratios"):
        context.show(f"space_{name}", context.headed("space_isolated", tables[f"space_{name}"]))


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
