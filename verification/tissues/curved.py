"""An example: does it matter for cells that leave a tissue whether its basal layer bends?"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pandas as pd
from scipy.stats import binomtest

from dincl.study import Key, Row, Study
from tissue.files.parameters import preset
from tissue.pictures.charts import CHART_STYLE, WIDTH, RatioSeries, draw_series, grid, legend
from tissue.pictures.picture import draw_frame
from tissue.pictures.sheet import Figure, Line2D, style, write
from tissue.runs.simulate import simulate
from tissue.study.outcomes import SIDES, outcomes
from tissue.study.plan import load_study, run_seeds
from verification.site.context import Context
from verification.site.store import shipped

NAME, STUDY = "curved_ways_out", "curved_published"
SMALLEST = {"events": "[A]", "layer": "inside", "replicates": 16}
COLUMNS = {
    "events": "Events",
    "layer": "Layer",
    "side": "Way out",
    "value": "Ratio",
    "low": "Lower end, 95 %",
    "high": "Upper end, 95 %",
    "of": "Cells",
}
# By layer: its name, colour and mark, distinct without colour, too.
LAYERS = {
    "line": ("line", "0.25", "o"),
    "inside": ("inside of an arc", "#d1495b", "s"),
    "outside": ("outside of an arc", "#2e78b7", "^"),
}
CIRCLE: dict[str, object] = {"layer.shape": "circle", "layer.perimeter": "400 um"}
TUBE = CIRCLE | {"layer.closed": True, "tissue.cells": 241}
ELLIPSE = {"layer.shape": "ellipse", "layer.perimeter": "800 um", "layer.aspect": 0.7, "tissue.cells": 481}
TISSUES: dict[str, dict[str, object]] = {
    "inside of an arc of 400 µm": CIRCLE,
    "outside of an arc of 400 µm": CIRCLE | {"layer.side": "outside"},
    "outside of a tube of 400 µm": TUBE | {"layer.side": "outside"},
    "inside of a tube of 800 µm on an ellipse": TUBE | ELLIPSE,
}
DPI = 120  # of tissues, whose many discs make large files


def study(smallest: bool = False) -> Study:
    """Count the cells that leave, by events and layer; 36,000 runs, half an hour of two cores."""
    plan = load_study(STUDY)
    names = (scenario.rsplit(", ", 1) for scenario in plan.scenarios)
    keys = tuple({"events": events, "layer": layer, "replicates": plan.replicates} for events, layer in names)
    key, runs = ("events", "layer", "replicates"), (SMALLEST,) if smallest else keys
    return Study(NAME, "Curved layers", key, runs, ways_out, columns=COLUMNS, by=("side",))


def ways_out(key: Key) -> list[Row]:
    """Return a row for each side: cells that have ended there, with Wilson's interval."""
    plan, scenario, numbers = load_study(STUDY), f"{key['events']}, {key['layer']}", range(key["replicates"])
    made = outcomes(plan.scenarios[scenario], numbers, run_seeds(plan.seed, scenario, numbers))
    ended = made.cells.to_pandas()["extruded"]
    rows: list[Row] = []
    for side in (SIDES[0], SIDES[-1]):
        count, of = int((ended == side).sum()), len(ended)  # one EMT cell in each run
        low, high = binomtest(count, of).proportion_ci(method="wilson")
        counts = {"count": count, "of": of, "value": count / of, "low": float(low), "high": float(high)}
        rows.append({**key, "side": side, **counts})
    return rows


def run(context: Context) -> None:
    """Read the table; a part of it would have fewer runs, and other ratios."""
    if context.full:
        context.rows(NAME)
    else:
        context.keep(NAME, shipped(NAME))


def draw_ways_out(table: pd.DataFrame, path: Path) -> Path:
    """Draw, for each set of events and each layer, the ratio of cells that have left on either side."""
    series = [
        RatioSeries(label, table[table["layer"] == layer], {"color": colour, "marker": marker})
        for layer, (label, colour, marker) in LAYERS.items()
    ]
    return draw_sides(series, list(table["events"].unique()), 2.6, path)


def draw_sides(series: Sequence[RatioSeries], names: Sequence[str], height: float, path: Path) -> Path:
    """Draw a panel for each side, with a line of marks and intervals for each set of events, and a legend.

    Rows of a series have the columns events, side, value, low, high.
    """
    with style(**CHART_STYLE):
        sides = ("basal", "apical")
        figure, panels = grid([f"{side} extrusion" for side in sides], height, x="ratio at 54 h [%]", sharey=True)
        for side, panel in zip(sides, panels, strict=True):
            mine = [one.rows[one.rows["side"] == side].set_index("events") for one in series]
            draw_series(panel, names, [one._replace(rows=rows) for one, rows in zip(series, mine, strict=True)])
        legend(figure, {one.label: Line2D([], [], linestyle="none", **one.look) for one in series})
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


def show(context: Context) -> None:
    """Give the answer with its figure and table, and tissues to look at."""
    table = context.tables[NAME]
    context.draw(NAME, draw_ways_out, table)
    context.draw("curved_tissues", draw_tissues)
    context.show(NAME, context.headed(NAME, table))
