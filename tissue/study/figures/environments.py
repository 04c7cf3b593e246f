"""Figures 17 to 19 of chapter 4: cells with the same events alone, in a homogeneous group and in heterogeneous ones."""

from __future__ import annotations

from collections.abc import Iterator

import pandas as pd

from dincl.errors import InvalidProblem
from tissue.pictures.sheet import Figure
from tissue.study.categories import NO_INM
from tissue.study.figures.cells import POPULATIONS
from tissue.study.figures.needs import FigureSource, Sources, needs
from tissue.study.figures.panels import Dots, checked_entry, draw_dots, grid, name_axes
from tissue.study.figures.style import ENVIRONMENTS, INTERVALS, caption, counted, legend

MAKES_NO_NUMBERS = True

HEIGHT = 1.55  # inches of a panel
NAMES = [name for _, name in ENVIRONMENTS.values()]
# The scenario of a cell alone with the events of a category.
ALONE = {"[AB]": "[AxB]", "[A]": "[Ax]", "[B]": "[Bx]"}
STUDIES = {"figure15": "ratios", **dict.fromkeys(POPULATIONS, "categories")}


@needs(**STUDIES)
def figure_17(sources: Sources) -> Figure:
    """Cells with [A], then [B], at 6 h and 18 h; in heterogeneous groups at any time from 6 h to 24 h."""
    return _compared(sources, "[AB]", "[A] at 6 h and [B] at 18 h", "[A], then [B]")


@needs(**STUDIES)
def figure_18(sources: Sources) -> Figure:
    """Cells with [A] alone, at 6 h; in heterogeneous groups at any time."""
    return _compared(sources, "[A]", "[A] at 6 h", "[A] alone")


@needs(**STUDIES)
def figure_19(sources: Sources) -> Figure:
    """Cells with [B] alone, at 6 h; in heterogeneous groups at any time."""
    return _compared(sources, "[B]", "[B] at 6 h", "[B] alone")


def _compared(sources: Sources, order: str, fixed: str, drawn: str) -> Figure:
    scenario = ALONE[order]
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
            Dots("", rows[kind], fewer.get(kind), {"color": colour, "marker": "o"})
            for kind, (colour, _) in ENVIRONMENTS.items()
        ]
        for one in series:
            draw_dots(panel, NAMES, [one])
    name_axes(panels, "ratio of basal extrusion at the end [%]", "")
    if checked:
        legend(figure, checked_entry())
    text = f"Alone and in the homogeneous group: {fixed}; in heterogeneous groups: cells with {drawn} at any time"
    caption(figure, f"{text}. {counted(counts, 'cells in a ratio')}; whiskers: {INTERVALS}.")
    return figure


def _found(source: FigureSource, scenario: str, category: str, *, check: bool) -> Iterator[tuple[str, pd.DataFrame]]:
    """The ratio of basal extrusion in each environment in which there are such cells, by the name of its line."""
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
