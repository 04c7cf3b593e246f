"""Growth of sheets and slices, in which all daughters of divisions stay, or both of one division in five."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd

from dincl.study import Key, Row, Study
from tissue.files.parameters import preset
from tissue.frames.frame import Frame
from tissue.frames.observables import height, layer_area, state_of
from tissue.frames.section import section
from tissue.model.measures import measure
from tissue.runs.simulate import simulate
from tissue.state.cells import Floats, Integers
from verification.thesis.chapter3.sampled import over_seeds

# The probability that both daughters of a division stay: that of the slice, and that of a sheet.
SOME, ALL = 0.2, 1.0
END, EVERY, SEEDS = 48.0, 6.0, 4  # h, h
SHEET: Mapping[str, object] = {"tissue.dimension": 3}
FREE: Mapping[str, object] = {**SHEET, "space.boundary": "open"}
# What makes each tissue of the published preset. A nucleus of a sheet begins among five times as many soft balls as
# soft discs in a slice of the same spacing; the tube is so large that the tissue is low over it.
TISSUES: Mapping[str, Mapping[str, object]] = {
    "free sheet": FREE,
    "periodic sheet": SHEET,
    "free sheet, weak repulsion": {**FREE, "cell.alpha_xx": 0.2},
    "slice": {},
    "tube": {"layer.shape": "circle", "layer.closed": True, "layer.perimeter": "1000 um"},
}
# Tissue, number of cells, probability that both daughters stay; the longest runs first.
LAYERS = (
    *(("free sheet", 2304, ALL), ("free sheet", 400, ALL), ("periodic sheet", 196, ALL), ("free sheet", 196, ALL)),
    *(("free sheet, weak repulsion", 196, ALL), ("free sheet", 400, SOME), ("periodic sheet", 196, SOME)),
    *(("free sheet", 196, SOME), ("slice", 180, ALL), ("slice", 45, ALL), ("slice", 180, SOME), ("slice", 45, SOME)),
    ("tube", 600, SOME),
)
KEY = ("layer", "cells", "both")
COLUMNS = {
    "layer": "Tissue",
    "cells": "Cells",
    "both": "Divisions with both daughters kept",
    "height": "Height / at the start",
    "height_low": "Height, lower end, 95 %",
    "height_high": "Height, upper end, 95 %",
    "number": "Cells / at the start",
    "section": "Cells in the section / at the start",
    "stay": "Daughters that stay in the section",
    "stay_low": "Daughters, lower end, 95 %",
    "stay_high": "Daughters, upper end, 95 %",
    "basal": "Basal extent / at the start",
    "fan": "Apical / basal extent",
    "rough": "Roughness [R_soft]",
    "runs": "Runs",
    "folded": "Runs folded",
}


def study(smallest: bool = False) -> Study:
    """Return one run for each tissue and seed."""
    layers, seeds = (LAYERS[-2:-1], 2) if smallest else (LAYERS, SEEDS)
    runs = tuple({**dict(zip(KEY, layer, strict=True)), "seed": seed} for layer in layers for seed in range(seeds))
    settings = {"end": END, "every": EVERY, "tissues": TISSUES}
    return Study("space_growth", "Space: growth", (*KEY, "seed"), runs, grown, settings, COLUMNS, by=("t",))


def grown(key: Key) -> list[Row]:
    """Return a row for each output time, and whether the apical layer was folded by then; none from where a run is
    lost.
    """
    given: dict[str, Any] = {"tissue.cells": key["cells"], "tissue.two_daughters": key["both"]}
    given |= {"numerics.t_end": f"{END:g} h", "numerics.keep": f"{EVERY:g} h", **TISSUES[key["layer"]]}
    run = simulate(preset("published").changed(given), key["seed"])
    frames = run.frames if run.status else run.frames[:-1]
    folds = [bool(measure(state_of(frame)).fold) for frame in frames]
    return [
        {**key, "t": frame.t, "folded": any(folds[: k + 1])} | measured(frame, run.frames[0])
        for k, frame in enumerate(frames)
    ]


def measured(frame: Frame, first: Frame) -> dict[str, float]:
    """Measure relative height, cells, cells in the section z = 0, basal extent; apical over basal; roughness."""
    basal = basal_extent(frame)
    return {
        "height": height(frame) / height(first),
        "number": len(frame.cells.x) / len(first.cells.x),
        "section": len(section(frame).cells.x) / len(section(first).cells.x),
        "basal": basal / basal_extent(first),
        "fan": _apical_extent(frame) / basal,
        "rough": roughness(frame),
    }


def _apical_extent(frame: Frame) -> float:
    """Return the extent of the apical layer: the length of a path, in space the root of an area [R_soft]."""
    cells = frame.cells
    if frame.sheets is None:
        layer = _closed(frame.layers.apical, frame)
        return _length(cells.ax[layer], cells.ay[layer])
    return math.sqrt(layer_area(frame, "apical"))


def basal_extent(frame: Frame) -> float:
    """Return the extent of the basal layer: the length of a path, in space the root of an area [R_soft]."""
    if frame.sheets is None:
        layer = _closed(frame.layers.basal, frame)
        return _length(frame.cells.bx[layer], frame.cells.by[layer])
    return math.sqrt(layer_area(frame, "basal"))


def _closed(layer: Integers, frame: Frame) -> Integers:
    """Return the cells along a layer, the first one again at the end of a ring."""
    return np.append(layer, layer[: frame.curve.ring])


def _length(x: Floats, y: Floats) -> float:
    return float(np.hypot(np.diff(x), np.diff(y)).sum())


def roughness(frame: Frame) -> float:
    """Return the root mean square of apical height less the mean height of junction partners [R_soft]."""
    cells, edges = frame.cells, junctions(frame)
    ends, others = edges.T.ravel(), edges[:, ::-1].T.ravel()
    counts = np.bincount(ends, minlength=len(cells.x))
    inner = counts > 1
    y = frame.heights(cells.ax, cells.ay, cells.az)
    around = np.bincount(ends, weights=y[others], minlength=len(cells.x))[inner] / counts[inner]
    return float(np.sqrt(np.mean((y[inner] - around) ** 2)))


def junctions(frame: Frame) -> Integers:
    """Return the two cells of each junction, (m, 2)."""
    if frame.sheets is not None:
        return frame.sheets.apical.edges
    layer = _closed(frame.layers.apical, frame)
    return np.column_stack((layer[:-1], layer[1:]))


def means(table: pd.DataFrame) -> pd.DataFrame:
    """Return a row for each tissue and time: means, of height and section with Student's 95 % intervals; ``stay``.

    A run whose apical layer is folded has no height from then on, nor apical extent or roughness; ``folded`` counts
    these runs.
    """
    unfolded, rows = table.copy(), []
    unfolded.loc[table["folded"] == 1, ["height", "fan", "rough"]] = np.nan
    for name, mine in unfolded.groupby([*KEY, "t"], sort=False):
        row: dict[str, Any] = dict(zip((*KEY, "t"), name, strict=True))
        for column in ("height", "section"):
            row[column], row[f"{column}_low"], row[f"{column}_high"] = over_seeds(mine[column].dropna())
        row |= mine[["number", "basal", "fan", "rough"]].mean().to_dict()
        for end in ("", "_low", "_high"):
            row[f"stay{end}"] = part_that_stays(row[f"section{end}"], row["number"])
        rows.append(row | {"runs": len(mine), "folded": mine["folded"].sum()})
    return pd.DataFrame(rows)


def part_that_stays(section: float, number: float) -> float:
    """Return p of (1 + p)^g = section, g = log2(number) generations: the share of second daughters in a section.

    p^div of section 2.2.5 of chapter 3, as a slice would need it; NaN before any division, -1 for an end of an interval
    below 0.
    """
    generations = math.log2(number)
    return float(max(0.0, section) ** (1.0 / generations) - 1.0) if generations > 0.0 else math.nan
