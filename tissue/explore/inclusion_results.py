"""The right side of the tab of inclusions: the numbers at the present dt, and error and overlap against dt and time."""

from __future__ import annotations

import asyncio
from time import monotonic
from typing import Any

from nicegui import ui

from tissue.explore.inclusion_charts import COLOURS, Compared, What, against_dt, in_time
from tissue.explore.widgets import draw, empty_chart, number_table

MAKES_NO_NUMBERS = True

PAUSE = 0.15  # seconds between two drawings
COLUMNS = {"method": "method", "error": "largest error", "overlap": "overlap", "order": "order"}
DOT = """<q-td :props="props" :style="{fontWeight: props.row.pictured ? 600 : 400}">
<i class="dot" :style="{background: props.row.colour}"></i>{{ props.row.method }}</q-td>"""
WHAT: tuple[What, ...] = ("error", "overlap")


class InclusionResults:
    """What is known of the runs that are compared."""

    def __init__(self) -> None:
        self._table = number_table(COLUMNS, row_key="method")
        self._table.add_slot("body-cell-method", DOT)
        self._faults = ui.label().classes("faults").props('data-is="run-faults"')
        kinds = [(what, against) for against in (against_dt, in_time) for what in WHAT]
        self._charts = [(_chart(f"{what} {against.__name__}"), what, against) for what, against in kinds]
        self._drawn = 0.0
        self._later: asyncio.TimerHandle | None = None

    def show(self, runs: Compared) -> None:
        """All that is known, now or, if it was drawn just before, a little later: the browser has more to do."""
        self._runs = runs
        if self._later is None:
            wait = max(0.0, self._drawn + PAUSE - monotonic())
            self._later = asyncio.get_running_loop().call_later(wait, self._draw)

    def stop(self) -> None:
        """Draw no more."""
        if self._later is not None:
            self._later.cancel()

    def _draw(self) -> None:
        runs, self._later, self._drawn = self._runs, None, monotonic()
        self._table.props(f"data-left={runs.left()}")
        self._table.rows = [_row(runs, method) for method in runs.methods]
        found = {method: runs.known.get((method, runs.steps)) for method in runs.methods}
        said = [f"{method}: {one.fault}" for method, one in found.items() if one is not None and one.fault]
        self._faults.text = "\n".join(said)
        self._faults.set_visibility(bool(said))
        for chart, what, against in self._charts:
            draw(chart, against(what, runs))


def _chart(name: str) -> ui.echart:
    return empty_chart().props(f'data-is="{name}"')


def _row(runs: Compared, method: str) -> dict[str, Any]:
    """The numbers of a method at the present dt."""
    found, order = runs.known.get((method, runs.steps)), runs.order(method)
    row: dict[str, Any] = {"method": method, "colour": COLOURS[method], "pictured": method == runs.pictured}
    row["order"] = "" if order is None else f"{order:.1f}"
    if found is not None and found.fault:
        return row | {"error": "failed", "overlap": ""}
    values = {what: runs.largest(what, method, runs.steps) for what in WHAT}
    return row | {what: "" if value is None else f"{value:.1e}" if value else "0" for what, value in values.items()}
