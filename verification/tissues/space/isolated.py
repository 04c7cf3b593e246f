"""Isolated cells of sheets beside those of slices: ratios with intervals, and which comparisons of chapter 4 hold."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd

from dincl.study import Key, Row, Study
from tissue.files.groups import crowd_of
from tissue.files.parameters import Parameters
from tissue.state.cells import CONTROL, Flags
from tissue.state.checkpoint import streams
from tissue.study.categories import What, kept_times, outcome
from tissue.study.plan import load_study
from tissue.study.run import run_study
from verification.site.cells import percents
from verification.site.store import shipped
from verification.thesis.chapter4.frequencies import more
from verification.thesis.chapter4.ratios import as_ratio, difference, wilson

PLAN = "space_published"
SLICE, GROWING, INNER, PERIODIC = "slice", "growing", "inner", "periodic"
# INNER: those cells of the growing sheets that begin farther than EDGE [distances of neighbours] from their edge. Cells
# nearer than that leave less often, in sheets of 196, 784 and 1,764 cells.
TISSUES, EDGE = (SLICE, GROWING, INNER, PERIODIC), 3.0
# Without "below all control cells": the lowest of many cells of a sheet is lower than that of a slice.
SIDES: tuple[What, ...] = ("basal", "apical")
# Of the slices, the study of each scenario.
SLICES = {
    **dict.fromkeys(("[A]", "[B]", "[S]", "[BP]"), "figure10_published"),
    **dict.fromkeys(("[A] no INM", "[B] no INM", "[S] no INM"), "figure12_published"),
    **dict.fromkeys(("[AxB]", "[AB]", "[BxA]"), "figure14_published"),
    "[ABP]": "figure15_published",
}
COLUMNS = {
    "scenario": "Events",
    "says": "Finding",
    "what": "Way out",
    "compared": "More of",
    "tissue": "Tissue",
    **{one: one for one in TISSUES},
    "value": "Ratio",
    "low": "Lower end, 95 %",
    "high": "Upper end, 95 %",
    "of": "Cells",
    "effective": "Independent cells",
}


class EmtComparison(NamedTuple):
    """A finding of chapter 4: more cells leave on this side after the first events than after the second."""

    says: str
    side: str
    first: str
    second: str


WORDS = {True: "holds", False: "does not hold", None: "not decided"}
COMPARISONS = (
    EmtComparison("[P] almost guarantees basal extrusion (4.1.1)", "basal", "[BP]", "[A]"),
    EmtComparison("[A] drives cells out (4.1.2)", "basal", "[A]", "[S]"),
    EmtComparison("[A] drives cells out (4.1.2)", "apical", "[A]", "[S]"),
    EmtComparison("[A] more than [B] (4.1)", "basal", "[A]", "[B]"),
    EmtComparison("stopped INM: more basal extrusion (4.2.1)", "basal", "[A] no INM", "[A]"),
    EmtComparison("stopped INM: more basal extrusion (4.2.1)", "basal", "[B] no INM", "[B]"),
    EmtComparison("stopped INM: less apical extrusion (4.2.1)", "apical", "[A]", "[A] no INM"),
    EmtComparison("stopped INM: less apical extrusion (4.2.1)", "apical", "[B]", "[B] no INM"),
    EmtComparison("without INM [B] more than [A] (Figure 12)", "basal", "[B] no INM", "[A] no INM"),
    EmtComparison("[AxB] most of the orders (Figure 14)", "basal", "[AxB]", "[AB]"),
    EmtComparison("[AxB] most of the orders (Figure 14)", "basal", "[AxB]", "[BxA]"),
    EmtComparison("[B] after [A] adds to it (Figure 14)", "basal", "[AxB]", "[A]"),
    EmtComparison("[A] adds to [BP] (Figure 15)", "basal", "[ABP]", "[BP]"),
)


def study(smallest: bool = False) -> Study:
    """Return one run: the plan ``space_published``, 88 tissues in half an hour of two cores; none if smallest."""
    runs = () if smallest else ({"plan": PLAN},)
    by = ("scenario", "tissue", "what")
    return Study("space_isolated", "Space: isolated cells", ("plan",), runs, completed, columns=COLUMNS, by=by)


def completed(key: Key) -> list[Row]:
    """Complete the plan in the folder ``results``; return a row for each set of events, tissue and side."""
    results, rows = run_study(key["plan"], Path("results") / key["plan"]), []
    for name, parameters in load_study(key["plan"]).scenarios.items():
        scenario, tissue = name.rsplit(", ", 1)
        cells = results.cells(name)
        parts = {tissue: cells}
        if tissue == GROWING:
            parts[INNER] = cells[are_inner(parameters)[cells["cell"]]]
        for of, mine in parts.items():
            for side in SIDES:
                hits = outcome(mine, side, kept_times(mine)[-1])
                rows.append({"scenario": scenario, "tissue": of, "what": side, **counted(hits, mine["replicate"])})
    return [{**key, **row} for row in with_intervals(pd.DataFrame(rows), "tissue").to_dict("records")]


def are_inner(parameters: Parameters) -> Flags:
    """Return whether each isolated cell (m,) begins farther than EDGE from the edge of a flat sheet."""
    lattice = parameters.lattice()
    crowd = crowd_of(parameters.groups(), parameters.tissue.cells, streams(0), lattice)
    sheet = lattice.basal[::2]
    cells = sheet[:, crowd.kind != CONTROL]
    away = np.minimum(cells - sheet.min(axis=1)[:, None], sheet.max(axis=1)[:, None] - cells).min(axis=0)
    inner: Flags = away > EDGE * lattice.spacing
    return inner


def counted(hits: pd.Series, replicate: pd.Series) -> dict[str, float]:
    """Count the cells that are hits, and their spread from run to run.

    ``squares`` is the sum over the R runs of (y_r - p n_r)^2 R/(R - 1), y_r the hits of a run with n_r cells, of which
    ``expected`` = n p (1 - p) is expected if cells are independent.
    """
    runs = hits.groupby(replicate).agg(["sum", "size"])
    count, of, replicates = int(runs["sum"].sum()), int(runs["size"].sum()), len(runs)
    squares = float(((runs["sum"] - count / of * runs["size"]) ** 2).sum()) * replicates / (replicates - 1)
    return {"count": count, "of": of, "runs": replicates, "squares": squares, "expected": count * (1 - count / of)}


def with_intervals(rows: pd.DataFrame, together: str) -> pd.DataFrame:
    """Return counts with their ratio, its design effect, its effective number of cells, and Wilson's 95 % interval.

    The design effect, sum of squares over sum of expected ones and at least 1, is taken of all rows with the same
    value in the column ``together``: for p = 0 or 1 a single row says nothing about it.

    Source
    ------
    L. Kish, Survey Sampling (1965).
    """
    sums = rows.groupby(together)[["squares", "expected"]].transform("sum")
    made = rows.drop(columns=["squares", "expected"]).assign(value=rows["count"] / rows["of"])
    made["effect"] = (sums["squares"] / sums["expected"]).clip(lower=1.0)
    made["effective"] = made["of"] / made["effect"]
    made["low"], made["high"] = wilson(made["value"], made["effective"])
    return made


def with_slices(sheets: pd.DataFrame) -> pd.DataFrame:
    """Return ratios in sheets, below those of the same events in slices, which ship with the studies of chapter 4."""
    slices = shipped("emt_ratios")
    same = slices["scenario"].map(SLICES) == slices["study"]
    mine = slices[same & slices["what"].isin(SIDES)].drop(columns="study").assign(tissue=SLICE)
    return pd.concat([mine, sheets.drop(columns="plan")], ignore_index=True)


def compared(ratios: pd.DataFrame) -> pd.DataFrame:
    """Return a row for each comparison: the difference with its 95 % interval, and the verdict, in each tissue."""
    return pd.DataFrame(_compared(ratios))


def _compared(ratios: pd.DataFrame) -> Iterator[dict[str, object]]:
    rows = ratios.set_index(["tissue", "scenario", "what"]).sort_index()
    for one in COMPARISONS:
        row: dict[str, object] = {"says": one.says, "what": one.side, "compared": f"{one.first} than {one.second}"}
        for tissue in TISSUES:
            first, second = (rows.loc[(tissue, name, one.side)] for name in (one.first, one.second))
            found = difference(as_ratio(first), as_ratio(second))
            verdict = WORDS[more(one.says, found).comparison.true]
            points = percents((found.value, *found.interval()), 1, "+").replace(" %", "").replace("]", "] points")
            row |= {tissue: f"{points}: {verdict}", f"{tissue}_verdict": verdict}
        yield row
