"""The right side of the page: the numbers with their intervals, two settings against each other, and charts in time."""

from __future__ import annotations

from itertools import islice
from typing import TYPE_CHECKING

from nicegui import ui

from tissue.explore.answer import HEIGHT, POSITION
from tissue.explore.charts import course_chart, ratios_chart
from tissue.explore.comparison import AnswerRow, rows_of
from tissue.explore.widgets import columns_of, draw, empty_chart, number_table

if TYPE_CHECKING:
    from collections.abc import Callable

    from tissue.explore.answer import Answer
    from tissue.explore.session import Session, Side

MAKES_NO_NUMBERS = True

TITLES = ("", "now", "held", "difference", "to decide it")
COLUMNS = dict(zip(AnswerRow._fields, TITLES, strict=True))
ALONE = 2  # columns when nothing is held


class AnswerPanel:
    """What a session knows; ``compare`` holds the setting, or lets it go."""

    def __init__(self, session: Session, compare: Callable[[], None], more: Callable[[int], None]) -> None:
        self._session = session
        with ui.element("div").classes("answer") as self._whole:
            with ui.element("div").classes("row"):
                self._compare = ui.button(on_click=compare).props("dense no-caps outline size=sm")
                target = ui.number("runs", value=session.most, min=8, max=100_000, step=100).props("dense outlined")
                target.classes("short").on("change", lambda: more(int(target.value or session.most)))
            self._runs = ui.label().classes("runs").props('data-is="runs"')
            self._table = number_table(COLUMNS, row_key="name")
            self._ratios = empty_chart().props('data-is="ratios"')
            self._courses = {name: empty_chart() for name in (POSITION, HEIGHT)}
        self.show()

    def show(self) -> None:
        """All that is known now."""
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
            self._draw(chart, course_chart(answers, name), any(name in one.courses for one in answers))

    def _numbers(self, now: Answer, held: Answer | None) -> None:
        self._table.columns = columns_of(islice(COLUMNS.items(), ALONE if held is None else None))
        self._table.rows = [row._asdict() for row in rows_of(now, held)]

    @staticmethod
    def _draw(chart: ui.echart, options: dict[str, object], there: bool) -> None:
        chart.set_visibility(there)
        if there:
            draw(chart, options)


def _words(side: Side) -> str:
    """How many runs there are, and what became of them."""
    if side.ensemble is not None and side.ensemble.fault:
        return side.ensemble.fault
    if side.answer is None:
        return "no run yet"
    failed = f", {side.answer.failed} failed" if side.answer.failed else ""
    return f"{side.name}: {side.answer.runs} runs{failed}{'' if side.over else ' ...'}"
