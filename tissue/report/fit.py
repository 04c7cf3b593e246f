"""The page of a fit: what is not identified first, then intervals, pairs, and the predicted curves over the data."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from dincl.files import write_text
from tissue.fitting.results import FitResults
from tissue.pictures.charts import CAP, CHART_STYLE, TIME, WIDTH, grid, legend, page
from tissue.pictures.sheet import Axes, Figure, Line2D, Patch, style
from tissue.report.page import NAME, Drawable, html_table, image, template

# A column of panels that stays legible at the width of a telephone.
DRAWS, BINS, SIDE, HEIGHT, COLUMN = 4000, 40, 2.2, 2.4, 5.0
LINE, BAND = "#2e78b7", "#a9c8e4"
PAIRS = "Draws from the posterior; each axis is the range of a parameter."
CURVES = "Blue: 95 % of what the fitted model gives, for as many tissues as were measured. Bars: data, 95 %."


def write_fit_page(results: FitResults, folder: Path) -> Path:
    """Write page.html into the folder of a fit; it opens offline and can be sent to others."""
    fit, path = results.fit, folder / NAME
    sound = int(results.emulator.weights.sum())
    text = template("fit.html.j2").render(
        fit=fit,
        remarks=results.remarks(),
        p=shown_misfit(results),
        intervals=html_table(shown_intervals(results)),
        figures=[
            Drawable("pairs", "Pairs", partial(pairs, results), PAIRS),
            Drawable("predicted", "The model over the data", partial(predicted, results), CURVES),
        ],
        predicted=html_table(results.predicted().round(3)),
        sensitivity=html_table(shown_sensitivity(results.sensitivity())),
        runs=len(results.runs),
        failed=len(results.runs) - sound,
        degree=int(results.emulator.mean.degrees.sum(axis=1).max()),
        calibration=round(100 * results.emulator.calibration()),
        base=fit.base.as_toml(),
        image=image,
    )
    write_text(path, text)
    return path


def shown_misfit(results: FitResults) -> str:
    """Return p as a text."""
    p = results.p_value()
    return "unknown, as there are no more data than identified parameters" if np.isnan(p) else f"{p:.2g}"


def shown_intervals(results: FitResults) -> pd.DataFrame:
    """Return the intervals as texts."""
    found = results.intervals()
    texts = {name: [f"{value:.3g}" for value in found[name]] for name in ("median", "low", "high")}
    part = [f"{100 * value:.0f} %" for value in found["of_range"]]
    said = ["yes" if one else "no" for one in found["identified"]]
    names = [one.label for one in results.fit.ranges]
    return pd.DataFrame({"parameter": names, **texts, "of range": part, "identified": said})


def shown_sensitivity(table: pd.DataFrame) -> pd.DataFrame:
    """Return the indices with their intervals as texts."""
    rows = table.to_dict("records")
    ends = {
        name: [f"{row[name]:.2f} ({row[f'{name}_low']:.2f} to {row[f'{name}_high']:.2f})" for row in rows]
        for name in ("first", "total")
    }
    chance = [f"{value:.2f}" for value in table["chance"]]
    return pd.DataFrame({"output": table["output"], "parameter": table["parameter"], **ends, "chance": chance})


def pairs(results: FitResults) -> Figure:
    """Draw the posterior of each parameter, and of each pair."""
    ranges, drawn = results.fit.ranges, (1 + results.posterior.drawn(DRAWS)) / 2
    d, bins = len(ranges), np.linspace(0, 1, BINS + 1)
    with style(**CHART_STYLE | {"axes.grid": False}):
        figure = page(SIDE * d + 0.4, min(WIDTH, 2.6 * d + 0.8))
        panels: Any = figure.subplots(d, d, squeeze=False)
        for i, j in np.ndindex(d, d):
            panel: Axes = panels[i, j]
            parts = 0.0, 0.5, 1.0  # of the range
            panel.set_xticks(parts, [f"{ranges[j].value(part):.3g}" for part in parts])
            if i == j:
                panel.hist(drawn[:, i], bins.tolist(), color=BAND)
                panel.set_xlim(0, 1)
            elif j < i:
                panel.hist2d(drawn[:, j], drawn[:, i], [bins, bins], cmap="Blues")
            else:
                panel.remove()
            heights = parts if j < i else ()
            panel.set_yticks(heights, [f"{ranges[i].value(part):.3g}" for part in heights])
            if i == d - 1:
                panel.set_xlabel(ranges[j].label)
            if j == 0 < i:
                panel.set_ylabel(ranges[i].label)
    return figure


def predicted(results: FitResults) -> Figure:
    """Draw the data over what the fitted model gives, a panel for each measure."""
    table = results.predicted()
    measures = list(dict.fromkeys(table["measure"]))
    with style(**CHART_STYLE):
        figure, panels = grid(measures, HEIGHT, x=TIME, columns=1, width=COLUMN)
        for name, panel in zip(measures, panels, strict=True):
            rows = table[table["measure"] == name].sort_values("time_h")
            t, middle = rows["time_h"], rows["mean"]
            if len(rows) > 1:
                panel.fill_between(t, rows["low"], rows["high"], color=BAND, linewidth=0)
                panel.plot(t, middle, color=LINE)
            else:
                panel.errorbar(t, middle, [middle - rows["low"], rows["high"] - middle], color=BAND, linewidth=8)
                panel.set_xticks(t)
            panel.errorbar(t, rows["value"], 1.96 * rows["standard_error"], fmt="o", color="black", markersize=3, **CAP)
        marks: dict[str, Line2D | Patch] = {"data": Line2D([], [], color="black", marker="o", linestyle="none")}
        marks["model"] = Patch(color=BAND)
        legend(figure, marks)
    return figure
