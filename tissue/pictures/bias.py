"""The chart of ``tissue simplify``: the bias of simpler models with its interval, against their cost."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pandas as pd

from tissue.pictures.charts import CAP, CHART_STYLE, caption, legend, page
from tissue.pictures.sheet import Axes, Figure, Line2D, style, write

MAKES_NO_NUMBERS = True
# By verdict: colour and mark, told apart without colours, too.
MARKS = {"enough": ("#00796b", "o"), "open": ("#808080", "s"), "not enough": ("#a31621", "X")}
ANSWER = "#e0a100"


def draw_bias(table: pd.DataFrame, tolerance: float, unit: str, answer: str, path: Path) -> Path:
    """Write ``bias_chart`` to a PNG or SVG file."""
    path.parent.mkdir(parents=True, exist_ok=True)
    write(bias_chart(table, tolerance, unit, answer), path)
    return path


def bias_chart(table: pd.DataFrame, tolerance: float, unit: str, answer: str) -> Figure:
    """Draw simpler models, a row for each, the cheapest on top: cost on the left, bias on the right.

    Parameters
    ----------
    table
        That of ``tissue.study.simplify.Simplified``.
    tolerance, unit
        The largest bias that does not matter, and its unit: "points" for shares, which are drawn in points.
    answer
        The model of the answer, which is marked; "" if there is none.
    """
    scale = 100.0 if unit == "points" else 1.0
    rows = table[table["bias"].notna()].sort_values("cpu", ascending=False, ignore_index=True)
    with style(**CHART_STYLE):
        figure = page(1.2 + 0.27 * len(rows))
        cost, bias = figure.subplots(1, 2, sharey=True, width_ratios=(1, 1.6))
        _draw_costs(cost, rows, answer)
        bias.axvspan(-scale * tolerance, scale * tolerance, color="#00796b", alpha=0.12, linewidth=0)
        for verdict in MARKS:
            mine = rows[rows["verdict"] == verdict]
            ends = [scale * (mine["bias"] - mine["low"]), scale * (mine["high"] - mine["bias"])]
            bias.errorbar(scale * mine["bias"], mine.index, xerr=ends, **_look(verdict), **CAP)
        bias.set(title="bias: simpler minus full", xlabel=f"bias [{unit}]")
        legend(figure, {verdict: Line2D([], [], **_look(verdict)) for verdict in MARKS})
        within = (
            f"Shaded: the tolerance, {scale * tolerance:g} {unit}. An interval within it: enough; outside: not enough"
        )
        caption(figure, f"{within}. Coloured bar, the answer: {answer}." if answer else f"{within}.")
    return figure


def _look(verdict: str) -> dict[str, Any]:
    colour, mark = MARKS[verdict]
    return {"color": colour, "marker": mark, "linestyle": "none"}


def _draw_costs(panel: Axes, rows: pd.DataFrame, answer: str) -> None:
    """Draw CPU time of a run over that of the full model, as bars with the names of the models."""
    mine = rows[rows["model"] == answer]
    together = mine[mine["step"] == "together"]
    last = (mine if together.empty else together).index
    colours = [ANSWER if k in last else "#c8c8c8" for k in rows.index]
    panel.barh(rows.index, rows["cpu"], color=colours, height=0.6)
    panel.axvline(1.0, color="#333333", linewidth=0.8)
    names = rows["model"].mask(rows["parts"] > 1, rows["parts"].map("{} together".format))
    again = (rows["step"] == "together") & (rows["parts"] == 1)
    names = names.mask(again, names + ", fresh seeds")
    panel.set_yticks(rows.index, list(names))
    panel.set(title="cost", xlabel="CPU time of a run / full model", ylim=(-0.6, len(rows) - 0.4))
