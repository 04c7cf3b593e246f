"""Tables of ratios that figures are drawn from: of a study that is stored, in the form of those that are kept."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

import pandas as pd

from tissue.study.answers import scenario_ratios
from tissue.study.categories import by_order, happened, kept_times, outcome
from tissue.study.curves import given
from tissue.study.figures.cells import cells_of
from tissue.study.ratios import ratios

if TYPE_CHECKING:
    from tissue.study.read import Results

MAKES_NO_NUMBERS = True

# Edges of the position at the onset, and of event times [h], for Figures 21 and 20 of chapter 4.
ONSETS, TIMES = tuple(k / 10 for k in range(11)), tuple(range(6, 25, 3))
INM = {True: "INM", False: "no INM"}


def categories(results: Results) -> pd.DataFrame:
    """Basal extrusion at the end by the events of a cell in their order, with and without INM."""
    parts = []
    for scenario, cells, end in _at_end(results):
        table = ratios(outcome(cells, "basal", end), cells["replicate"], by_order(cells, end, inm=True))
        parts.append(table.rename_axis("category").reset_index().assign(scenario=scenario))
    return pd.concat(parts, ignore_index=True)


def conditional(results: Results) -> pd.DataFrame:
    """Basal extrusion at the end given the position at the onset and the times of [A], [B], [P] in their column.

    Of the cells without [P], and given the time of [P] of those with it; ``given``, ``inm`` say which rows are which.
    """
    parts = []
    for _, cells, end in _at_end(results):
        hits, calm = outcome(cells, "basal", end), ~happened(cells, end)["P"]
        for moves, inm in INM.items():
            for column, edges in {"onset_ab": ONSETS, "t_a_h": TIMES, "t_b_h": TIMES, "t_p_h": TIMES}.items():
                kind = (~calm if column == "t_p_h" else calm) & (cells["inm"] == moves)
                table = given(hits[kind], cells["replicate"][kind], cells[column][kind], edges)
                parts.append(table.assign(given=column, inm=inm))
    return pd.concat(parts, ignore_index=True)


def _at_end(results: Results) -> Iterator[tuple[str, pd.DataFrame, float]]:
    """Each scenario with its cells, of their positions those at the end, and when that is [h]."""
    for scenario in results.study.scenarios:
        cells = cells_of(results, scenario, last_only=True)
        yield scenario, cells, kept_times(cells)[-1]


TABLES: dict[str, Callable[[Results], pd.DataFrame]] = {
    "ratios": scenario_ratios,
    "categories": categories,
    "conditional": conditional,
}
