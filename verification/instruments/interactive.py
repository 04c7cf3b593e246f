"""The chart of speed against accuracy that answers to the reader, offline. This is the one file that imports bokeh."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from itertools import cycle
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
from bokeh.document import Document
from bokeh.embed import components
from bokeh.models import ColumnDataSource, CustomJS, HoverTool, Range1d
from bokeh.models.annotations import BoxAnnotation
from bokeh.plotting import figure
from bokeh.resources import Resources

from verification.instruments import cheapest
from verification.instruments.charts import FRONT, LOWEST, NOT_COUNTED, absent, cost_label, rgb, styles
from verification.instruments.error_norms import label as error_label
from verification.instruments.error_norms import reference_error
from verification.site.cells import render

if TYPE_CHECKING:
    from verification.instruments.speed_accuracy import WorkPrecision

HEIGHT = 560  # dots
# Errors for which the page lists the cheapest method.
DECADES = tuple(10.0**-k for k in range(1, 13))
MARKERS = ("circle", "square", "triangle", "diamond", "inverted_triangle", "star", "hex", "circle_x", "square_pin")
HOVER = [("method", "@method"), ("setting", "@setting{%.3g}"), ("error", "@y{%.2e}"), ("cost", "@x{%.3g}")]
HOVER += [("status", "@status")]
PRINTF: dict[str, Any] = dict.fromkeys(("@setting", "@y", "@x"), "printf")
DASHES = {"-": "solid", "--": "dashed", ":": "dotted", "-.": "dashdot"}
# Of the colours of words, over those of their lines.
DARKER = 0.75
# Nothing is dragged until a tool is chosen: a finger that moves over the chart moves the page.
TOOLS: dict[str, Any] = {"tools": "pan,wheel_zoom,box_zoom,reset,save", "active_drag": None}
TOOLS |= {"toolbar_location": "above"}
WORDS = {"tie": cheapest.TIE, "at_the_limit": cheapest.AT_THE_LIMIT}
WORDS |= {"not_reached": cheapest.NOT_REACHED, "not_resolved": cheapest.NOT_RESOLVED}
# Columns of what is drawn: runs, names of lines, the strokes from the ends of lines to their names.
POINTS, NAMES = ("x", "y", "setting", "status", "method"), ("x", "y", "text", "color", "size")
LEADERS = ("x0", "y0", "x1", "y1", "color")
CODE = Path(__file__).parents[1] / "site" / "static" / "live.js"


@cache
def script() -> str:
    """Return the text of the library's script; a page that has a chart needs it once, at its end."""
    return "\n".join(Resources(mode="inline", components=["bokeh"]).js_raw)


def draw_chart(
    charts: Mapping[str, WorkPrecision],
    costs: Sequence[str],
    short: Mapping[str, str] | None = None,
) -> str:
    """Draw error against cost as HTML; the reader chooses scene, error, cost and families of methods.

    The page lists the cheapest method for each error of DECADES by the rule of ``cheapest.rank``. The choice stands in
    the address: ``#scene=stack&norm=final&cost=cpu_seconds&without=PBD``.

    Parameters
    ----------
    charts
        By the name of the scene in the address.
    costs
        Columns of the tables.
    short
        label -> name at the end of its line; the label itself for methods that it lacks.
    """
    looks = {label: look for one in charts.values() for label, look in one.looks.items()}
    drawn, norms = styles(looks), next(iter(charts.values())).errors
    methods: list[dict[str, Any]] = [
        {"label": label, "short": (short or {}).get(label, label), "rank": k}
        | {"family": str(looks[label]["family"]), "color": look["color"], "ink": _darker(look["color"])}
        for k, (label, look) in enumerate(drawn.items())
    ]
    runs = [_runs(one, number, list(looks), norms, costs) for number, one in enumerate(charts.values())]
    given: dict[str, Any] = {
        "scenes": list(charts),
        "methods": methods,
        "norms": {name: error_label(name) for name in norms},
        "costs": {name: cost_label(name) for name in costs},
        "targets": DECADES,
        "finest": {name: {norm: _finest(one, norm) for norm in norms} for name, one in charts.items()},
        "absent": {name: dict.fromkeys(looks, NOT_COUNTED) | _absent(one, looks) for name, one in charts.items()},
        "limits": {name: {one.budget.column: one.budget.certain()} for name, one in charts.items()},
        "lowest": LOWEST,
        "words": WORDS,
    }
    made, place = components(_panel(drawn, pd.concat(runs)))
    return render(
        "live.html",
        scenes={name: one.title for name, one in charts.items()},
        norms=given["norms"],
        costs=given["costs"],
        families=_families(methods),
        given=given,
        place=place,
        bokeh=made,
    )


def _panel(drawn: Mapping[str, Mapping[str, Any]], runs: pd.DataFrame) -> Any:
    """Return the chart; ``live.js`` fills its sources as soon as the page is there."""
    panel = figure(
        height=HEIGHT,
        sizing_mode="stretch_width",
        x_axis_type="log",
        y_axis_type="log",
        x_axis_label=" ",
        y_axis_label=" ",
        x_range=Range1d(start=1e-3, end=1.0),
        y_range=Range1d(start=1e-3, end=1.0),
        **TOOLS,
    )
    for axis in (*panel.xaxis, *panel.yaxis):
        axis.minor_tick_line_color = None
    floor = BoxAnnotation(fill_color="#efefef", level="image", top=LOWEST, line_color=None)
    panel.add_layout(floor)
    front, crosses, names, leaders = (_empty(columns) for columns in (("x", "y"), POINTS, NAMES, LEADERS))
    panel.line("x", "y", source=front, line_color=FRONT["color"], line_width=FRONT["linewidth"])
    panel.segment("x0", "y0", "x1", "y1", source=leaders, color="color", line_width=0.6, line_alpha=0.5)
    lines: list[ColumnDataSource] = []
    points: list[Any] = []
    for look, marker in zip(drawn.values(), cycle(MARKERS), strict=False):
        lines.append(_empty(POINTS))
        panel.line("x", "y", source=lines[-1], color=look["color"], line_dash=DASHES[look["linestyle"]])
        points.append(panel.scatter("x", "y", source=lines[-1], marker=marker, size=7, color=look["color"]))
    points.append(panel.scatter("x", "y", source=crosses, marker="x", size=9, color="#22262b"))
    words: dict[str, Any] = {"text_color": "color", "text_font_size": {"field": "size"}, "text_baseline": "middle"}
    panel.text("x", "y", "text", source=names, x_offset=6, **words)
    panel.add_tools(HoverTool(renderers=points, tooltips=HOVER, formatters=PRINTF))
    panel.toolbar.logo = None
    parts = {"panel": panel, "lines": lines, "crosses": crosses, "front": front, "names": names, "leaders": leaders}
    parts |= {"across": panel.xaxis[0], "up": panel.yaxis[0], "grid": panel.xgrid[0], "floor": floor}
    parts |= {"runs": ColumnDataSource({name: _column(runs[name]) for name in runs})}
    document = Document()
    document.add_root(panel)
    document.js_on_event("document_ready", CustomJS(args=parts, code=CODE.read_text("utf-8")))
    return panel


def _families(methods: Sequence[Mapping[str, Any]]) -> dict[str, list[str]]:
    """Return the colours of the methods of each family."""
    found: dict[str, list[str]] = {}
    for one in methods:
        found.setdefault(one["family"], []).append(one["color"])
    return found


def _darker(colour: str) -> str:
    """Return a colour "#rrggbb" dark enough for words on white."""
    return "#" + "".join(f"{round(DARKER * 255 * part):02x}" for part in rgb(colour))


def _empty(columns: Sequence[str]) -> ColumnDataSource:
    return ColumnDataSource({name: [] for name in columns})


def _column(values: pd.Series) -> Any:
    """Return numbers as an array, which a page holds to the last bit, and words as a list."""
    return list(values) if values.dtype == object or pd.api.types.is_string_dtype(values) else values.to_numpy()


def _runs(
    one: WorkPrecision, scene: int, labels: list[str], norms: Sequence[str], costs: Sequence[str]
) -> pd.DataFrame:
    """Return the columns of the runs that were tried, from coarse to fine."""
    rows = one.table[~one.table["status"].isin(cheapest.NOT_TRIED)].sort_values("setting", ascending=False)
    columns = {
        "scene": np.full(len(rows), scene, np.int32),
        "method": np.array([labels.index(label) for label in rows["method"]], np.int32),
        "setting": rows["setting"],
        "status": rows["status"],
        "spread": cheapest.spreads(rows, "cpu_seconds"),
    }
    columns |= {norm: cheapest.accuracy(rows, norm) for norm in norms} | {cost: rows[cost] for cost in costs}
    return pd.DataFrame(columns)


def _absent(one: WorkPrecision, labels: Iterable[str]) -> dict[str, str]:
    """Return why methods have no line on the chart of a scene."""
    return {label: "not measured here" for label in labels if label not in one.looks} | absent(one.table)


def _finest(one: WorkPrecision, norm: str) -> float:
    """Return the error below which the reference decides nothing; 0 if it is exact."""
    return float(np.nan_to_num(cheapest.RESOLVED * reference_error(one.table, norm).max()))
