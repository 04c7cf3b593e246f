"""Figures of curved layers: the ways out with intervals, and tissues to look at."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from tissue.files.parameters import preset
from tissue.pictures.charts import CHART_STYLE, WIDTH, legend, page
from tissue.pictures.picture import draw_frame
from tissue.pictures.sheet import Figure, Line2D, Patch, style, write
from tissue.runs.simulate import simulate

# A label, colour, mark and what it is filled with, rows.
Series = tuple[str, tuple[str, ...], pd.DataFrame]
# Distinct without colour, too.
LOOKS = {"line": ("0.25", "o"), "inside": ("#d1495b", "s"), "outside": ("#2e78b7", "^")}
LABELS = {"line": "line", "inside": "inside of an arc", "outside": "outside of an arc"}
MARKERS = {600: "D"}
STEP = 0.11  # between marks of one set of events
LEGEND, DPI = 0.4, 120  # inches of the legend; of tissues, whose many discs make large files
APART = 30  # the layer whose EMT cells are further apart is there to compare
CIRCLE: dict[str, object] = {"layer.shape": "circle", "layer.perimeter": "400 um"}
TUBE: dict[str, object] = {
    "layer.shape": "circle",
    "layer.perimeter": "400 um",
    "layer.closed": True,
    "tissue.cells": 241,
}
TISSUES: dict[str, dict[str, object]] = {
    "inside of an arc of 400 µm": CIRCLE,
    "outside of an arc of 400 µm": CIRCLE | {"layer.side": "outside"},
    "outside of a tube of 400 µm": TUBE | {"layer.side": "outside"},
    "inside of a tube of 800 µm on an ellipse": TUBE
    | {"layer.shape": "ellipse", "layer.perimeter": "800 um", "layer.aspect": 0.7, "tissue.cells": 481},
}


def draw_ways_out(ways_out: pd.DataFrame, path: Path) -> Path:
    """Draw, for each set of events and each layer, the ratio of cells that have left on either side."""
    names = list(ways_out["events"].unique())
    rows = [(LABELS[layer], LOOKS[layer], mine) for layer, mine in ways_out.groupby("layer", sort=False)]
    return draw_sides(rows, names, 3.6, path)


def draw_tubes(ways_out: pd.DataFrame, tubes: pd.DataFrame, path: Path) -> Path:
    """Draw the same ratios for arcs and for closed tubes; marks of tubes are filled."""
    names = list(tubes["events"].unique())
    rows = [(label, look, mine) for label, look, mine in _closed_or_not(ways_out, tubes) if len(mine)]
    return draw_sides(rows, names, 4.8, path)


def _closed_or_not(ways_out: pd.DataFrame, tubes: pd.DataFrame) -> Iterator[Series]:
    """List the line, then the layers on either side by increasing size, arcs before tubes."""
    yield "line", LOOKS["line"], ways_out[ways_out["layer"] == "line"]
    for side in ("outside", "inside"):
        colour, marker = LOOKS[side]
        yield f"{side} of an arc of 400 µm", (colour, marker, "white"), ways_out[ways_out["layer"] == side]
        here = tubes[(tubes["layer"] == side) & (tubes["every"] != APART)]
        for (perimeter, closed), mine in here.groupby(["perimeter_um", "closed"]):
            shape = MARKERS.get(perimeter, marker)
            label = f"{side} of {'a tube' if closed else 'an arc'} of {perimeter} µm"
            yield label, (colour, shape, colour if closed else "white"), mine


def draw_sides(series: Sequence[Series], names: Sequence[str], height: float, path: Path) -> Path:
    """Draw a panel for each side, with a row of marks and intervals for each set of events."""
    with style(**CHART_STYLE):
        figure = page(height + LEGEND)
        panels = figure.subplots(1, 2, sharey=True)
        entries: dict[str, Line2D | Patch] = {}
        for k, (label, (colour, marker, *filled), rows) in enumerate(series):
            look: dict[str, Any] = {"color": colour, "marker": marker, "markersize": 5}
            look["markerfacecolor"] = (*filled, colour)[0]
            entries[label] = Line2D([], [], linestyle="none", **look)
            for panel, side in zip(panels, ("basal", "apical"), strict=True):
                mine = rows[(rows["side"] == side) & rows["events"].isin(names)]
                spread = 100 * np.abs(mine[["low", "high"]].to_numpy().T - mine["value"].to_numpy())
                at = np.array([names.index(name) for name in mine["events"]]) + STEP * (k - (len(series) - 1) / 2)
                panel.errorbar(100 * mine["value"], at, xerr=spread, linestyle="none", **look)
        for panel, side in zip(panels, ("basal", "apical"), strict=True):
            panel.set_yticks(range(len(names)), [name.replace(", no", " without") for name in names])
            panel.set(xlabel=f"{side} extrusion [%]", xlim=(-2, 102), ylim=(len(names) - 0.5, -0.5))
            panel.grid(visible=False, axis="y")
            for between in range(1, len(names)):
                panel.axhline(between - 0.5, color="0.8", linewidth=0.6, zorder=0)
        legend(figure, entries)
    write(figure, path)
    return path


def draw_tissues(path: Path) -> Path:
    """Draw tissues on curved layers after a day."""
    with style(**CHART_STYLE | {"axes.grid": False}):
        figure = Figure(figsize=(WIDTH, 8.0), layout="constrained", dpi=DPI)
        panels = figure.subplots(2, 2, height_ratios=(2, 3)).flat
        for panel, (name, changes) in zip(panels, TISSUES.items(), strict=True):
            given: dict[str, object] = {"tissue.cells": 51, "numerics.t_end": "24 h", "numerics.keep": "24 h"}
            parameters = preset("published").changed(given | changes)
            draw_frame(panel, simulate(parameters, 0, throw=False).final, parameters)
            panel.set_title(name, pad=18.0)  # above the line on the state
    write(figure, path)
    return path
