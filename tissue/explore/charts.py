"""Charts of an answer in time, as options of ECharts: means and ratios with their bands, two settings side by side."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from tissue.explore.answer import HEIGHT, POSITION
from tissue.study.figures.style import OUTCOMES

if TYPE_CHECKING:
    from tissue.explore.answer import Answer

MAKES_NO_NUMBERS = True

COLOURS = {POSITION: "#3a3a3a", HEIGHT: "#3f7fc1"}
DASHES = {"-": "solid", "--": "dashed", "-.": "dotted"}
HELD = 0.45  # opacity of what is held


def ratios_chart(answers: Sequence[Answer]) -> dict[str, Any]:
    """The ratios of EMT cells against time; the first answer, and pale the one that is held."""
    series: list[dict[str, Any]] = []
    for k, answer in enumerate(answers):
        for what, (colour, line, name) in OUTCOMES.items():
            rows = answer.in_time[answer.in_time["what"] == what]
            if len(rows):
                columns = (100 * rows[column].to_numpy(np.float64) for column in ("value", "low", "high"))
                series += _band(name, (colour, DASHES[line]), k, rows["time_h"].to_numpy(np.float64), *columns)
    return _chart("EMT cells [%]", series) | {"yAxis": _axis("EMT cells [%]", min=0, max=100)}


def course_chart(answers: Sequence[Answer], what: str) -> dict[str, Any]:
    """A mean over runs against time."""
    series: list[dict[str, Any]] = []
    for k, answer in enumerate(answers):
        if what in answer.courses:
            course = answer.courses[what]
            look = COLOURS[what], "solid"
            series += _band(what, look, k, np.array(course.times), course.mean, course.low, course.high)
    return _chart(what, series)


def _chart(title: str, series: list[dict[str, Any]]) -> dict[str, Any]:
    names = list(dict.fromkeys(one["name"] for one in series if not one["name"].startswith("_")))
    return {
        "animation": False,
        "grid": {"left": 46, "right": 12, "top": 12 + 20 * (len(names) > 1), "bottom": 34},
        "legend": {"data": names, "show": len(names) > 1, "top": 0, "itemHeight": 8, "textStyle": {"fontSize": 11}},
        "tooltip": {"trigger": "axis", "valueFormatter": None},
        "xAxis": {"type": "value", "name": "time [h]", "nameLocation": "middle", "nameGap": 20, "max": "dataMax"},
        "yAxis": _axis(title, scale=True),
        "series": series,
    }


def _axis(name: str, **limits: Any) -> dict[str, Any]:
    return {"type": "value", "name": name, "nameLocation": "middle", "nameGap": 32, **limits}


def _band(
    name: str, look: tuple[str, str], k: int, t: Any, value: Any, low: Any, high: Any
) -> Iterator[dict[str, Any]]:
    """A line, and its interval: its low end without a line, and on top of that the width, filled."""
    colour, dashes = look
    opacity = HELD if k else 1.0
    line = {"type": "line", "showSymbol": False, "silent": True}
    yield line | {
        "name": name,
        "data": _points(t, value),
        "lineStyle": {"color": colour, "type": dashes, "width": 2, "opacity": opacity},
        "itemStyle": {"color": colour},
        "z": 3,
    }
    hidden = {
        "lineStyle": {"opacity": 0},
        "itemStyle": {"opacity": 0},
        "stack": f"{name} {k}",
        "tooltip": {"show": False},
    }
    yield line | hidden | {"name": f"_{name} {k} low", "data": _points(t, low), "stackStrategy": "all"}
    filled = {"color": colour, "opacity": 0.18 * opacity}
    yield (
        line
        | hidden
        | {
            "name": f"_{name} {k} high",
            "data": _points(t, high - low),
            "areaStyle": filled,
            "stackStrategy": "all",
        }
    )


def _points(t: Any, values: Any) -> Any:
    return np.column_stack((t, values)).round(5).tolist()
