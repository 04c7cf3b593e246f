"""The right side of the page: the numbers with their intervals, two settings against each other, and charts in time."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import islice
from typing import TYPE_CHECKING, Any

import numpy as np
from nicegui import ui

from tissue.pictures.charts import OUTCOMES
from verification.explore.answer import HEIGHT, POSITION, AnswerRow, rows_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from verification.explore.answer import Answer
    from verification.explore.session import Session, Side


COLOURS = {POSITION: "#3a3a3a", HEIGHT: "#3f7fc1"}
DASHES = {"-": "solid", "--": "dashed", "-.": "dotted"}
HELD = 0.45  # opacity of what is held
NAMES_IN_A_ROW = 2  # of a legend


def ratios_chart(answers: Sequence[Answer]) -> dict[str, Any]:
    """Return the ratios of EMT cells against time: the first answer, and pale the one that is held."""
    series: list[dict[str, Any]] = []
    for k, answer in enumerate(answers):
        for what, (colour, line, name) in OUTCOMES.items():
            rows = answer.in_time[answer.in_time["what"] == what]
            if len(rows):
                columns = (100 * rows[column].to_numpy(np.float64) for column in ("value", "low", "high"))
                series += _band(name, (colour, DASHES[line]), k, rows["time_h"].to_numpy(np.float64), *columns)
    return _chart("EMT cells [%]", series) | {"yAxis": _axis("EMT cells [%]", min=0, max=100)}


def mean_chart(answers: Sequence[Answer], what: str) -> dict[str, Any]:
    """Return a mean over runs against time."""
    series: list[dict[str, Any]] = []
    for k, answer in enumerate(answers):
        if what in answer.time_series:
            course = answer.time_series[what]
            look = COLOURS[what], "solid"
            series += _band(what, look, k, np.array(course.times), course.mean, course.low, course.high)
    return _chart(what, series)


def _chart(title: str, series: list[dict[str, Any]]) -> dict[str, Any]:
    names = list(dict.fromkeys(one["name"] for one in series if not one["name"].startswith("_")))
    rows = -(-len(names) // NAMES_IN_A_ROW) if len(names) > 1 else 0
    return {
        "animation": False,
        "grid": {"left": 46, "right": 12, "top": 12 + 18 * rows, "bottom": 34},
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
    """Draw a line and its interval: the low end without a line, on top of it the width, filled."""
    colour, dashes = look
    opacity = HELD if k else 1.0
    name += ", held" if k else ""
    line = {"type": "line", "showSymbol": False, "silent": True}
    yield line | {
        "name": name,
        "data": _points(t, value),
        "lineStyle": {"color": colour, "type": dashes, "width": 2, "opacity": opacity},
        "itemStyle": {"color": colour, "opacity": opacity},
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


TITLES = ("", "now", "held", "difference", "to decide it")
COLUMNS = dict(zip(AnswerRow._fields, TITLES, strict=True))
ALONE = 2  # columns when nothing is held


class AnswerPanel:
    """Answers of a session; ``compare`` holds the setting, or lets it go."""

    def __init__(self, session: Session, compare: Callable[[], None], more: Callable[[int], None]) -> None:
        self._session = session
        with ui.element("div").classes("answer") as self._whole:
            with ui.element("div").classes("row"):
                self._compare = ui.button(on_click=compare).props("dense no-caps outline size=sm")
                target = ui.number("runs", value=session.most, min=8, max=100_000, step=100).props("dense outlined")
                target.classes("short").on("change", lambda: more(int(target.value or session.most)))
            self._runs = ui.label().classes("runs").props('data-is="runs"')
            self._table = ui.table(rows=[], columns=_columns(ALONE), row_key="name").classes("numbers wide")
            self._table.props("flat dense hide-pagination :rows-per-page-options=[0] no-data-label=''")
            self._ratios = ui.echart({}).classes("chart").props('data-is="ratios"')
            self._courses = {name: ui.echart({}).classes("chart") for name in (POSITION, HEIGHT)}
        self.show()

    def show(self) -> None:
        """Show all that is known now."""
        now, held = self._session.now, self._session.held
        self._compare.text = "Compare: hold this" if held is None else "Compare no more"
        self._runs.text = _words(now) + ("" if held is None else f"; held: {_words(held)}")
        self._runs.props(f"data-runs={0 if now.answer is None else now.answer.runs}")
        if now.answer is None:  # what was there stays, pale, until there is something new
            self._whole.classes(add="stale")
            return
        self._whole.classes(remove="stale")
        self._numbers(now.answer, None if held is None else held.answer)
        answers = [side.answer for side in (now, held) if side is not None and side.answer is not None]
        self._draw(self._ratios, ratios_chart(answers), any(len(one.in_time) for one in answers))
        for name, chart in self._courses.items():
            self._draw(chart, mean_chart(answers, name), any(name in one.time_series for one in answers))

    def _numbers(self, now: Answer, held: Answer | None) -> None:
        self._table.columns = _columns(ALONE if held is None else None)
        self._table.rows = [row._asdict() for row in rows_of(now, held)]

    @staticmethod
    def _draw(chart: ui.echart, options: dict[str, object], there: bool) -> None:
        chart.set_visibility(there)
        if there:
            chart.options.clear()
            chart.options.update(options)
            chart.update()


def _columns(count: int | None) -> list[dict[str, str]]:
    """Return the first columns of the table of numbers."""
    shown = islice(COLUMNS.items(), count)
    return [{"name": name, "field": name, "label": title, "align": "left"} for name, title in shown]


def _words(side: Side) -> str:
    """Return how many runs there are, and what became of them."""
    if side.ensemble.fault:
        return side.ensemble.fault
    if side.answer is None:
        return "no run yet"
    failed = f", {side.answer.failed} failed" if side.answer.failed else ""
    folded = f"{side.answer.folded} runs with a folded apical layer, " if side.answer.folded else ""
    return f"{side.name}: {folded}{side.answer.runs} runs{failed}{'' if side.ensemble.over else ' ...'}"
