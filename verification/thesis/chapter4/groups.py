"""Heterogeneous groups, Table 5 of chapter 4: who leaves basally, by events, their times, the place at the onset.

Two tables of the same ensembles: ratios of cells of one kind, and how much each factor tells of all cells.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pandas as pd

from dincl.study import Key, Row, Study
from tissue.study.categories import kept_times, outcome
from verification.thesis.chapter4.categories import NO_INM, by_order, given, happened
from verification.thesis.chapter4.ensembles import POPULATIONS, PRESETS, ensemble, made
from verification.thesis.chapter4.ranking import by_importance
from verification.thesis.chapter4.ratios import ratios

# Edges of the position at the onset (Figure 21), and of the event times [h] (Figure 20).
ONSETS, TIMES = tuple(np.arange(11) / 10), tuple(range(6, 25, 3))
EDGES = {"onset_ab": ONSETS, "t_a_h": TIMES, "t_b_h": TIMES, "t_p_h": TIMES}
INM = {"INM": "", "no INM": NO_INM}
# ``given`` of the rows by the events of a cell in their order, and of those of one order by the time of [A], for (Q4).
EVENTS, ORDERS = "events", ("[AB]", "[BA]")
FIRST_RUNS = 2000  # of each ensemble, for the rows by order
RANKED, SEED = "table5_35", 0
SMALLEST = {"study": "table5_35_published", "replicates": 24}
COLUMNS = {
    "study": "Group",
    "given": "By",
    "kind": "Cells",
    "low_edge": "From",
    "high_edge": "To",
    "value": "Basal extrusion",
    "low": "Lower end, 95 %",
    "high": "Upper end, 95 %",
    "of": "Cells of this kind",
    "runs": "Runs",
}
RANKING_COLUMNS = {
    "study": "Group",
    "factor": "Factor",
    "value": "Loss without it [nats]",
    "low": "Lower end, 95 %",
    "high": "Upper end, 95 %",
}


def study(smallest: bool = False) -> Study:
    """Count who leaves, by kind of cell."""
    every = [name + ending for ending in PRESETS.values() for name in POPULATIONS]
    columns, by = COLUMNS, ("given", "kind", "low_edge")
    return Study("emt_groups", "EMT: groups", ("study", "replicates"), _runs(every, smallest), kinds, {}, columns, by)


def ranking(smallest: bool = False) -> Study:
    """Rank the factors of basal extrusion in the middle group."""
    runs, columns = _runs([RANKED + ending for ending in PRESETS.values()], smallest), RANKING_COLUMNS
    return Study("emt_ranking", "EMT: factors", ("study", "replicates"), runs, factors, {}, columns, ("factor",))


def _runs(names: list[str], smallest: bool) -> tuple[dict[str, Any], ...]:
    keys = ({"study": name, "replicates": ensemble(name).replicates} for name in names)
    return (SMALLEST,) if smallest else tuple(sorted(keys, key=lambda key: -key["replicates"]))


def _cells(study: str, replicates: int) -> tuple[pd.DataFrame, pd.Series, float]:
    """Return the cells of a group, whether they are extruded basally at the end, and when that is [h]."""
    plan = ensemble(study)
    (scenario,) = plan.scenarios
    cells, _ = made(plan.scenarios[scenario], plan.seed, scenario, replicates)
    end = kept_times(cells)[-1]
    return cells, outcome(cells, "basal", end), end


def kinds(key: Key) -> list[Row]:
    """Return a row for each kind of cell that occurs."""
    rows = pd.concat(list(_kinds(*_cells(**key))), ignore_index=True)
    return [{**key, **row} for row in rows.to_dict("records")]


def _kinds(cells: pd.DataFrame, basal: pd.Series, end: float) -> Iterator[pd.DataFrame]:
    """Give ratios by the order of events; by place and times, without [P] but for its time; by [A] in two orders."""
    replicate, order, with_p = cells["replicate"], by_order(cells, end), happened(cells, end)["P"]
    yield ratios(basal, replicate, order).rename_axis("kind").reset_index().assign(given=EVENTS)

    def among(kind: pd.Series, column: str) -> pd.DataFrame:
        return given(basal[kind], replicate[kind], cells.loc[kind, column], EDGES[column])

    for text, ending in INM.items():
        for column in EDGES:
            chosen = (with_p if column == "t_p_h" else ~with_p) & (cells["inm"] == (not ending))
            yield among(chosen, column).assign(given=column, kind=text)
        for name in ORDERS:
            chosen = (order == name + ending) & (replicate < FIRST_RUNS)
            yield among(chosen, "t_a_h").assign(given=name, kind=text)


def factors(key: Key) -> list[Row]:
    """Return a row for each factor: the loss of a prediction of basal extrusion without it."""
    cells, basal, end = _cells(**key)
    return [{**key, **row} for row in by_importance(cells, basal, end, seed=SEED).to_dict("records")]
