"""The one style of the figures: colours, marks with intervals, captions."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Mapping
from typing import Any, Literal

import pandas as pd

from tissue.pictures.emt import EMT_COLOURS
from tissue.pictures.sheet import Axes, Figure, Line2D, Patch
from tissue.study.categories import What
from tissue.study.proportions import LEVEL

MAKES_NO_NUMBERS = True

WIDTH = 9.2  # inches, as the pictures and the page of the report
DPI = 200
LOOK: Any = {
    "axes.titlesize": 9.5,
    "axes.titlelocation": "left",
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#e6e6e6",
    "grid.linewidth": 0.6,
    "lines.linewidth": 1.4,
}
LineStyle = Literal["-", "--", "-."]
# What becomes of a cell: colour, line, name. Told apart by lightness and line, too.
OUTCOMES: dict[What, tuple[str, LineStyle, str]] = {
    "basal": ("#a31621", "-", "basal extrusion"),
    "apical": ("#3f7fc1", "--", "apical extrusion"),
    "below": ("#e0a100", "-.", "below all control cells"),
}
# Around a cell; the populations of Table 5 of chapter 4 by the study that makes them.
ENVIRONMENTS = {
    "individual": ("#808080", "individual"),
    "homogeneous": ("#8c6bb1", "homogeneous group"),
    "table5_63": ("#00796b", "heterogeneous, 63 % [P]"),
    "table5_35": ("#2fa89a", "heterogeneous, 35 % [P]"),
    "table5_7": ("#7fcabf", "heterogeneous, 7 % [P]"),
}
EVENT_COLOURS = EMT_COLOURS
POSITION = "$y_{AB}$"
PERCENT = f"{100 * LEVEL:g} %"
INTERVALS = f"{PERCENT} Wilson intervals on the effective number of cells"
CAPTION_SIZE, CAPTION_LETTERS = 8.0, 155  # points; in a line
CAP: dict[str, Any] = {"capsize": 2.5, "elinewidth": 1.0, "capthick": 1.0}
# Fewer runs laid over complete studies.
CHECKED = "the runs of this page"
CHECK: dict[str, Any] = {"marker": "o", "markersize": 7.5, "markerfacecolor": "none", "color": "#9a9a9a", "zorder": 1.5}


def page(height: float) -> Figure:
    """An empty figure, ``height`` in inches."""
    return Figure(figsize=(WIDTH, height), layout="constrained", dpi=DPI)


def verbatim(name: str) -> str:
    """A name from a file for a text of matplotlib, in which $ begins a formula."""
    return name.replace("$", r"\$")


def caption(figure: Figure, text: str) -> None:
    """Lines below the figure that say what it shows, of how many cells, and what the intervals are."""
    whole = text.replace("\n", " ").replace(" %", "\N{NO-BREAK SPACE}%")
    lines = textwrap.fill(whole, CAPTION_LETTERS)
    figure.supxlabel(lines, x=0.01, ha="left", fontsize=CAPTION_SIZE, color="#333333")


def legend(figure: Figure, handles: Mapping[str, Line2D | Patch]) -> None:
    """One legend for all panels, above them."""
    figure.legend(list(handles.values()), list(handles), loc="outside upper left", ncols=len(handles))


def outcome_lines() -> dict[str, Line2D | Patch]:
    """The legend of lines over time."""
    return {name: Line2D([], [], color=colour, linestyle=line) for colour, line, name in OUTCOMES.values()}


def band(panel: Axes, x: pd.Series, table: pd.DataFrame, **look: Any) -> None:
    """A line of ratios [%] with their intervals; ``table`` as that of ``ratios``."""
    low, value, high = (100 * table[name] for name in ("low", "value", "high"))
    panel.fill_between(x, low, high, color=look["color"], alpha=0.18, linewidth=0)
    panel.plot(x, value, **look)


def percent_axis(panel: Axes, text: str) -> None:
    """The whole range of ratios."""
    panel.set(ylim=(-2, 102), ylabel=text)


def counted(numbers: Iterable[int], what: str) -> str:
    """How many there were: "n = 400 runs", or "n = 398 to 400 runs"."""
    found = sorted(set(numbers))
    span = f"{found[0]}" if len(found) == 1 else f"{found[0]} to {found[-1]}"
    return f"n = {span} {what}"
