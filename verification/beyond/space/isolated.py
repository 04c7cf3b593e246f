"""Isolated cells in sheets beside those in slices: ratios with intervals, and which comparisons of chapter 4 hold.

``python -m verification.beyond.space.isolated FOLDER`` makes the runs of the study ``space_published`` that are missing
in FOLDER, 88 in half an hour of two cores, and ``verification/data/space_isolated.parquet``.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import pandas as pd

from dincl.study import read_sealed, workers
from tissue.statistics.categories import What, kept_times, outcome
from tissue.statistics.comparisons import Difference
from tissue.statistics.ratios import as_ratio
from tissue.study.plan import load_study
from tissue.study.read import Results
from tissue.study.run import run_study
from verification.beyond.space.counted import counted, with_intervals
from verification.beyond.space.edge import INNER, are_inner
from verification.page.kept import DATA, keep
from verification.thesis.chapter4.frequencies import more
from verification.thesis.chapter4.kept import read

FILE = DATA / "space_isolated.parquet"
STUDY = "space_published"
SLICE, GROWING, PERIODIC = "slice", "growing", "periodic"
SHEETS = (GROWING, PERIODIC)
# INNER: those cells of the growing sheets that begin away from the edge.
TISSUES = (SLICE, GROWING, INNER, PERIODIC)
# Where "below all control cells" is left out: the lowest of many cells of a sheet is lower than that of a slice.
SIDES: tuple[What, ...] = ("basal", "apical")
# Of the slices, the study of each scenario.
SLICES = {
    **dict.fromkeys(("[A]", "[B]", "[S]", "[BP]"), "figure10_published"),
    **dict.fromkeys(("[A] no INM", "[B] no INM", "[S] no INM"), "figure12_published"),
    **dict.fromkeys(("[AxB]", "[AB]", "[BxA]"), "figure14_published"),
    "[ABP]": "figure15_published",
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


def main(folder: Path) -> None:
    """Complete the study, and keep its ratios."""
    with workers() as executor:
        results = run_study(STUDY, folder, executor)
    keep(with_intervals(pd.DataFrame(_counted(results)), "tissue"), FILE, main)


def _counted(results: Results) -> Iterator[dict[str, object]]:
    """Count, for each set of events, tissue and side, the cells that have left at the end."""
    for name, parameters in load_study(STUDY).scenarios.items():
        scenario, tissue = name.rsplit(", ", 1)
        cells = results.cells(name)
        tables = {tissue: cells}
        if tissue == GROWING:
            tables[INNER] = cells[are_inner(parameters)[cells["cell"]]]
        for of, mine in tables.items():
            for side in SIDES:
                hits = outcome(mine, side, kept_times(mine)[-1])
                yield {"scenario": scenario, "tissue": of, "what": side, **counted(hits, mine["replicate"])}


def table() -> pd.DataFrame:
    """Return ratios in sheets, and those of the same events in slices, which are kept with the studies of chapter 4."""
    slices = read("ratios")
    same = slices["scenario"].map(SLICES) == slices["study"]
    mine = slices[same & slices["what"].isin(SIDES)].drop(columns="study").assign(tissue=SLICE)
    return pd.concat([mine, read_sealed(FILE)], ignore_index=True)


def compared(ratios: pd.DataFrame) -> pd.DataFrame:
    """Return a row for each comparison: the difference with its 95 % interval, and the verdict, in each tissue."""
    return pd.DataFrame(_compared(ratios))


def _compared(ratios: pd.DataFrame) -> Iterator[dict[str, object]]:
    rows = ratios.set_index(["tissue", "scenario", "what"]).sort_index()
    for one in COMPARISONS:
        told: dict[str, object] = {"says": one.says, "side": one.side, "compared": f"{one.first} than {one.second}"}
        for tissue in TISSUES:
            first, second = (rows.loc[(tissue, name, one.side)] for name in (one.first, one.second))
            difference = Difference(as_ratio(first), as_ratio(second))
            verdict = WORDS[more(one.says, difference).comparison.true]
            told |= {tissue: f"{difference}: {verdict}", f"{tissue}_verdict": verdict}
        yield told


if __name__ == "__main__":
    main(Path(sys.argv[1]))
