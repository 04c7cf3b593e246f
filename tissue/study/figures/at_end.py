"""Ratios at the end of the runs: of any study, and Figures 13, 15 and 17 to 19 of chapter 4."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import pandas as pd

from dincl.errors import InvalidProblem
from tissue.pictures.charts import ENVIRONMENTS, INTERVALS, OUTCOMES, caption, counted, legend
from tissue.pictures.sheet import Axes, Figure, Line2D, Patch
from tissue.statistics.categories import NO_INM, What
from tissue.study.figures.in_time import ALONE, ALONE_NO_INM
from tissue.study.figures.panels import APART, NAME_LETTERS, RatioSeries, checked_entry, draw_series, grid, name_axes
from tissue.study.figures.sources import POPULATIONS, FigureSource, Sources, needs

MAKES_NO_NUMBERS = True

EVENTS = ("[A]", "[B]", "[S]", "[BP]", "no EMT")
PROGRAMS = ("[ABP]", "[BAP]", "[BPx]", "[BxP]", "[AxB]", "[BxA]", "[Ax]", "[xA]", "[Bx]", "[xB]", "no EMT")
WITH_AND_WITHOUT = {"With INM": "", "Without INM": NO_INM}
ENDS = {"individual": ("", "o"), "homogeneous": (", 10 cells", "s")}
# Sections 4.1 and 4.2 of chapter 4, as parts of all cells.
PRINTED = {
    ("[A]", "apical"): 0.3,
    ("[A]", "basal"): 0.1,
    ("[A]", "below"): 0.6,
    ("[A] no INM", "basal"): 0.2,
    ("[B]", "basal"): 0.0,
    ("[B] no INM", "basal"): 0.7,
}
MARK: Any = {"marker": "D", "markersize": 5.0, "color": "#ffe08a", "markeredgecolor": "black", "linestyle": "none"}
ALONE_STYLES: dict[str, Any] = {
    "with INM": {"marker": "o"},
    "without INM": {"marker": "s", "markerfacecolor": "white"},
}
SHIFT = APART / 2  # of marks for cells with INM upwards, for those without it downwards
LINE, ROOM = 0.23, 0.5  # inches: a line of ratios; title and axis of a panel
AT_END = "ratio at the end [%]"


class _AtEnd(NamedTuple):
    """Ratios of all scenarios of some studies, and of fewer runs, if any."""

    ratios: pd.DataFrame
    checked: pd.DataFrame | None


def at_end(sources: Sources, study: str, scenarios: Sequence[str]) -> Figure:
    """Draw the three outcomes at the end for each scenario of a study."""
    figure, panels = grid(
        [name for *_, name in OUTCOMES.values()], list(sources), _tall(scenarios), sharex=True, sharey=True
    )
    tables = {preset: _rows(source, study) for preset, source in sources.items()}
    for preset, rows in tables.items():
        for what, (colour, _, name) in OUTCOMES.items():
            look = {"color": colour, "marker": "o"}
            draw_series(panels[name, preset], scenarios, [_dots(rows, {one: one for one in scenarios}, what, "", look)])
    name_axes(panels, AT_END, "")
    caption(figure, f"EMT cells; {_told(tables)}.")
    return figure


@needs(figure10="ratios", figure12="ratios")
def figure_13(sources: Sources) -> Figure:
    """Draw r(t_end) of (4.7) of isolated cells, with INM and without, beside the printed ratios."""
    figure, panels = grid(
        [name for *_, name in OUTCOMES.values()], list(sources), _tall(EVENTS) + 0.2, sharex=True, sharey=True
    )
    tables = {preset: _rows(source, "figure10", "figure12") for preset, source in sources.items()}
    for preset, rows in tables.items():
        for what, (colour, _, name) in OUTCOMES.items():
            series = []
            for (label, look), stored in zip(ALONE_STYLES.items(), (ALONE, ALONE_NO_INM), strict=True):
                lines = {one.removesuffix(NO_INM): one for one in stored}
                series.append(_dots(rows, lines, what, label, look | {"color": colour}))
            draw_series(panels[name, preset], EVENTS, series)
            _draw_printed(panels[name, preset], what)
    name_axes(panels, AT_END, "")
    entries: dict[str, Line2D | Patch] = {
        name: Line2D([], [], color="black", linestyle="none", **look) for name, look in ALONE_STYLES.items()
    }
    legend(figure, entries | {"printed in the thesis": Line2D([], [], **MARK)} | _checked(tables))
    absent = "[BP] without INM, and no EMT with INM, are not among them"
    caption(figure, f"Isolated EMT cells; {absent}; {_told(tables)}.")
    return figure


@needs(figure15="ratios")
def figure_15(sources: Sources) -> Figure:
    """Draw basal extrusion at the end: eleven programs of events, alone and in a group, with INM and without."""
    figure, panels = grid(list(WITH_AND_WITHOUT), list(sources), _tall(PROGRAMS), sharex=True, sharey=True)
    tables = {preset: _rows(source, "figure15") for preset, source in sources.items()}
    entries: dict[str, Line2D | Patch] = {}
    for (title, preset), panel in panels.items():
        series = []
        for kind, (ending, marker) in ENDS.items():
            colour, label = ENVIRONMENTS[kind]
            lines = {name: f"{name}{WITH_AND_WITHOUT[title]}{ending}" for name in PROGRAMS}
            series.append(_dots(tables[preset], lines, "basal", label, {"color": colour, "marker": marker}))
            entries[label] = Line2D([], [], color=colour, marker=marker, linestyle="none")
        draw_series(panel, PROGRAMS, series)
    name_axes(panels, "ratio of basal extrusion at the end [%]", "")
    legend(figure, entries | _checked(tables))
    text = "One EMT cell, or a group of ten with the same events; x: a delay of 12 h"
    caption(figure, f"{text}; {_told(tables)}.")
    return figure


def _rows(source: FigureSource, *studies: str) -> _AtEnd:
    fewer = [table for study in studies if (table := source.check("ratios", study)) is not None]
    return _AtEnd(pd.concat([source.rows("ratios", study) for study in studies]), pd.concat(fewer) if fewer else None)


def _dots(rows: _AtEnd, lines: Mapping[str, str], what: What, label: str, look: dict[str, Any]) -> RatioSeries:
    """Return the ratios of one outcome by the names of their lines; ``lines``: the scenario of each."""
    names = {scenario: name for name, scenario in lines.items()}

    def picked(table: pd.DataFrame) -> pd.DataFrame:
        mine = table[(table["outcome"] == what) & table["scenario"].isin(names)]
        return mine.set_index(mine["scenario"].map(names))

    return RatioSeries(label, picked(rows.ratios), None if rows.checked is None else picked(rows.checked), look)


def _draw_printed(panel: Axes, what: What) -> None:
    """Mark the printed ratios, on the lines of the measured ones."""
    for (name, which), value in PRINTED.items():
        if which == what:
            event = name.removesuffix(NO_INM)
            at = EVENTS.index(event) + (-SHIFT if event == name else SHIFT)
            panel.plot(100 * value, at, zorder=1.8, **MARK)


def _checked(tables: Mapping[str, _AtEnd]) -> dict[str, Line2D | Patch]:
    return checked_entry() if any(rows.checked is not None for rows in tables.values()) else {}


def _told(tables: Mapping[str, _AtEnd]) -> str:
    runs = [int(n) for rows in tables.values() for n in rows.ratios["runs"]]
    return f"{counted(runs, 'runs of each scenario')}; whiskers: {INTERVALS}"


def _tall(names: Sequence[str]) -> float:
    """Return the height of a panel with a line for each name [in]."""
    return ROOM + LINE * sum(len(textwrap.wrap(name, NAME_LETTERS)) for name in names)


HEIGHT = 1.55  # inches of a panel
ENVIRONMENT_NAMES = [name for _, name in ENVIRONMENTS.values()]
# The scenario of a cell alone with the events of a category.
DELAYED = {"[AB]": "[AxB]", "[A]": "[Ax]", "[B]": "[Bx]"}
STUDIES = {"figure15": "ratios", **dict.fromkeys(POPULATIONS, "categories")}


@needs(**STUDIES)
def figure_17(sources: Sources) -> Figure:
    """Draw cells with [A], then [B], at 6 h and 18 h; in heterogeneous groups at any time from 6 h to 24 h."""
    return _compared(sources, "[AB]", "[A] at 6 h and [B] at 18 h", "[A], then [B]")


@needs(**STUDIES)
def figure_18(sources: Sources) -> Figure:
    """Draw cells with [A] alone, at 6 h; in heterogeneous groups at any time."""
    return _compared(sources, "[A]", "[A] at 6 h", "[A] alone")


@needs(**STUDIES)
def figure_19(sources: Sources) -> Figure:
    """Draw cells with [B] alone, at 6 h; in heterogeneous groups at any time."""
    return _compared(sources, "[B]", "[B] at 6 h", "[B] alone")


def _compared(sources: Sources, order: str, fixed: str, drawn: str) -> Figure:
    scenario = DELAYED[order]
    endings = {f"{order} with INM": "", f"{order} without INM": NO_INM}
    figure, panels = grid(list(endings), list(sources), HEIGHT, sharex=True, sharey=True)
    counts: list[int] = []
    checked = False
    for (title, preset), panel in panels.items():
        ending = endings[title]
        rows, fewer = (dict(_found(sources[preset], scenario + ending, order + ending, check=k)) for k in (False, True))
        for kind, (_, name) in ENVIRONMENTS.items():
            if kind not in rows:
                raise InvalidProblem(f"there is no cell with {order}{ending}, {name}: more runs have some")
        counts += [int(row["of"].iloc[0]) for row in rows.values()]
        checked = checked or bool(fewer)
        series = [
            RatioSeries("", rows[kind], fewer.get(kind), {"color": colour, "marker": "o"})
            for kind, (colour, _) in ENVIRONMENTS.items()
        ]
        for one in series:
            draw_series(panel, ENVIRONMENT_NAMES, [one])
    name_axes(panels, "ratio of basal extrusion at the end [%]", "")
    if checked:
        legend(figure, checked_entry())
    text = f"Alone and in the homogeneous group: {fixed}; in heterogeneous groups: cells with {drawn} at any time"
    caption(figure, f"{text}. {counted(counts, 'cells in a ratio')}; whiskers: {INTERVALS}.")
    return figure


def _found(source: FigureSource, scenario: str, category: str, *, check: bool) -> Iterator[tuple[str, pd.DataFrame]]:
    """Give the ratio of basal extrusion in each environment in which there are such cells, by the name of its line."""
    rows_of = source.check if check else source.rows
    for kind, (_, name) in ENVIRONMENTS.items():
        if kind in POPULATIONS:
            table = rows_of("categories", kind)
            mine = table if table is None else table[table["category"] == category]
        else:
            table = rows_of("ratios", "figure15")
            whole = scenario if kind == "individual" else f"{scenario}, 10 cells"
            mine = table if table is None else table[(table["scenario"] == whole) & (table["outcome"] == "basal")]
        if mine is not None and len(mine):
            yield kind, mine.set_axis([name])
