"""Figures of curved layers: the ways out with intervals, and tissues to look at."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd

from tissue.files.parameters import preset
from tissue.first_order import simulate
from tissue.pictures.picture import draw_frame
from tissue.pictures.sheet import Figure, style, write
from verification.thesis.chapter4.curved import LAYERS

# Distinct without colour, too.
LOOKS = {"line": ("0.25", "o"), "inside": ("#d1495b", "s"), "outside": ("#2e78b7", "^")}
CIRCLE: dict[str, object] = {"layer.shape": "circle", "layer.perimeter": "400 um"}
TUBE: dict[str, object] = {
    "layer.shape": "circle",
    "layer.perimeter": "400 um",
    "layer.closed": True,
    "tissue.cells": 241,
}
TISSUES: dict[str, dict[str, object]] = {
    "an arc, tissue inside": CIRCLE,
    "an arc, tissue outside": CIRCLE | {"layer.side": "outside"},
    "a tube, tissue outside": TUBE | {"layer.side": "outside"},
    "a tube of 800 µm on an ellipse, tissue inside": TUBE
    | {"layer.shape": "ellipse", "layer.perimeter": "800 um", "layer.aspect": 0.7, "tissue.cells": 481},
}


def draw_ways_out(ways_out: pd.DataFrame, path: Path) -> Path:
    """For each set of events the ratio of cells that have left on either side, on each layer."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with style():
        figure = Figure(figsize=(9.0, 3.6), layout="constrained")
        panels = figure.subplots(1, 2, sharey=True)
        for panel, side in zip(panels, ("basal", "apical"), strict=True):
            rows = ways_out[ways_out["side"] == side]
            names = list(rows["events"].unique())
            for k, layer in enumerate(LAYERS):
                mine = rows[rows["layer"] == layer]
                colour, marker = LOOKS[layer]
                spread = 100 * np.abs(mine[["low", "high"]].to_numpy().T - mine["value"].to_numpy())
                at = np.arange(len(names)) + 0.2 * (k - 1)
                panel.errorbar(
                    100 * mine["value"], at, xerr=spread, fmt=marker, color=colour, label=layer, markersize=5
                )
            panel.set_yticks(range(len(names)), names)
            panel.set(xlabel=f"{side} extrusion [%]", xlim=(-2, 100))
        panels[0].invert_yaxis()
        panels[1].legend(title="layer")
    write(figure, path)
    return path


def draw_tissues(path: Path) -> Path:
    """Tissues on curved layers after a day."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with style():
        figure = Figure(figsize=(9.0, 9.0), layout="constrained")
        for panel, (name, changes) in zip(figure.subplots(2, 2).flat, TISSUES.items(), strict=True):
            given: dict[str, object] = {"tissue.cells": 51, "numerics.t_end": "24 h", "numerics.keep": "24 h"}
            parameters = preset("published").changed(given | changes)
            draw_frame(panel, simulate(parameters, 0, throw=False).final, parameters)
            panel.set_title(name, y=1.1, fontsize=9)
    write(figure, path)
    return path
