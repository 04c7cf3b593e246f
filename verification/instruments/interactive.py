"""Charts that answer to the pointer, in pages that open offline. This is the one file that imports bokeh."""

from __future__ import annotations

from functools import cache
from itertools import cycle
from typing import Any

import pandas as pd
from bokeh.embed import components
from bokeh.models import ColumnDataSource, HoverTool
from bokeh.models.annotations import Legend, LegendItem
from bokeh.plotting import figure
from bokeh.resources import Resources

from verification.instruments.charts import FAILED, LOWEST, Looks, cost_label, made_of, styles
from verification.instruments.cheapest import NOT_TRIED, accuracy, front
from verification.instruments.error_norms import label as error_label

HEIGHT = 560  # dots
MARKERS = ("circle", "square", "triangle", "diamond", "inverted_triangle", "star", "hex", "circle_x", "square_pin")
HOVER = [
    ("method", "@method"),
    ("setting", "@setting{%.3g}"),
    ("error", "@y{%.2e}"),
    ("cost", "@x{%.3g}"),
    ("overlap", "@overlap{%.1e}"),
    ("status", "@status"),
]
PRINTF: dict[str, Any] = dict.fromkeys(("@setting", "@y", "@x", "@overlap"), "printf")
DASHES = {"-": "solid", "--": "dashed", ":": "dotted", "-.": "dashdot"}
# Nothing is dragged until a tool is chosen: a finger that moves over the chart moves the page.
TOOLS: dict[str, Any] = {"tools": "pan,wheel_zoom,box_zoom,reset,save", "active_drag": None}
TOOLS |= {"toolbar_location": "above"}
# As small as it takes for two entries to fit beside each other on a telephone.
LEGEND: dict[str, Any] = {"location": "center", "border_line_color": None, "ncols": 2}
LEGEND |= {"label_text_font_size": "11px", "glyph_width": 14, "padding": 0, "spacing": 2}


@cache
def script() -> str:
    """Return the text of the library's script; a page that has charts needs it once, at its end."""
    return "\n".join(Resources(mode="inline", components=["bokeh"]).js_raw)


def draw_work_precision(table: pd.DataFrame, looks: Looks, error: str, cost: str) -> str:
    """Draw error against cost as HTML: a tooltip describes the point, a click in the legend hides a family.

    Parameters
    ----------
    table, looks
        Of ``verification.instruments.chart.WorkPrecision``.
    error, cost
        Columns of the table.
    """
    axes: dict[str, Any] = {"x_axis_type": "log", "y_axis_type": "log"}
    axes |= {"x_axis_label": cost_label(cost), "y_axis_label": error_label(error)}
    panel = figure(height=HEIGHT, sizing_mode="stretch_width", **TOOLS, **axes)
    best = front(table, error, cost)
    drawn = panel.line(best[cost], best["accuracy"].clip(lower=LOWEST), line_color="#d9d9d9", line_width=9)
    items: dict[str, list[Any]] = {"efficient front": [drawn]}
    points: list[Any] = []
    for (label, look), marker in zip(styles(looks).items(), cycle(MARKERS), strict=False):
        rows = table[table["method"] == label].sort_values("setting", ascending=False)
        source = ColumnDataSource(_points(rows, error, cost))
        color = {"line_color": look["color"], "fill_color": look["color"]}
        line = panel.line("x", "y", source=source, color=look["color"], line_dash=DASHES[look["linestyle"]])
        points.append(panel.scatter("x", "y", source=source, marker=marker, size=8, **color))
        items.setdefault(str(looks[label]["family"]), []).extend((line, points[-1]))
    if failed := _failures(table, error, cost):
        points.append(panel.scatter("x", "y", source=ColumnDataSource(failed), marker="x", size=9))
        items[FAILED] = points[-1:]
    told = [line for line in HOVER if line[0] != "overlap" or table["overlap"].notna().any()]
    panel.add_tools(HoverTool(renderers=points, tooltips=told, formatters=PRINTF))
    panel.toolbar.logo = None
    entries = [LegendItem(label=name, renderers=shapes) for name, shapes in items.items()]
    panel.add_layout(Legend(items=entries, click_policy="hide", **LEGEND), "below")
    made, place = components(panel)
    return f"{place}\n{made}"


def _points(rows: pd.DataFrame, error: str, cost: str) -> dict[str, Any]:
    """Return the runs of a method that finished, with the texts of their tooltips."""
    done = (rows["status"] == "SUCCESS") & (rows[cost] > 0)
    values = accuracy(rows, error)[done].clip(lower=LOWEST)
    return _told(rows[done], rows.loc[done, cost], values)


def _failures(table: pd.DataFrame, error: str, cost: str) -> dict[str, Any]:
    """Return runs that failed, above all others; nothing if there are none."""
    failed = table[~table["status"].isin(("SUCCESS", *NOT_TRIED)) & (table[cost] > 0)]
    done = table[table["status"] == "SUCCESS"]
    above = pd.Series(3.0 * done[error].max(), index=failed.index)
    return _told(failed, failed[cost], above) if len(failed) else {}


def _told(rows: pd.DataFrame, x: pd.Series, y: pd.Series) -> dict[str, Any]:
    columns = {
        "method": rows["method"] + made_of(rows),
        "setting": rows["setting"],
        "overlap": rows["overlap"],
        "x": x,
        "y": y,
    }
    return {name: list(values) for name, values in (columns | {"status": rows["status"]}).items()}
