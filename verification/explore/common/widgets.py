"""Parts of the page: tables, charts, sliders, and the player of pictures, a canvas with its controls."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from nicegui import ui
from nicegui.element import Element

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping


class QuickSlider(ui.slider):
    """With one end."""

    LOOPBACK = False


class QuickRange(ui.range):
    """With two ends."""

    LOOPBACK = False


def number_table(titles: Mapping[str, str], row_key: str) -> ui.table:
    """Add an empty table of numbers; titles by the names of fields."""
    table = ui.table(rows=[], columns=columns_of(titles.items()), row_key=row_key).classes("numbers wide")
    return table.props("flat dense hide-pagination :rows-per-page-options=[0] no-data-label=''")


def columns_of(titles: Iterable[tuple[str, str]]) -> list[dict[str, str]]:
    """Make columns of their fields and titles."""
    return [{"name": name, "field": name, "label": title, "align": "left"} for name, title in titles]


def empty_chart() -> ui.echart:
    """Add a chart of which nothing is known yet."""
    return ui.echart({}).classes("chart")


def draw(chart: ui.echart, options: Mapping[str, Any]) -> None:
    """Show other options of ECharts in place of those that were there."""
    chart.options.clear()
    chart.options.update(options)
    chart.update()


class Player(Element, component="player.js", esm={"tissue-pictures": "js"}):
    """Player of streams of ``explore.common.streams``; data attributes of its element say what it shows."""

    def play(self, url: str) -> None:
        """Show another run, from its first frames on, at the time that is shown now."""
        self._props["url"] = url
        self.update()
