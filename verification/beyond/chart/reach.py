"""Piles of more and more discs: the errors below which the event-driven scheme is the cheapest.

``python -m verification.beyond.chart.reach`` recomputes the table in some five minutes and writes
``verification/data/event_driven_reach.parquet``.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd

import dincl
from dincl.study import read_sealed
from verification.instruments.budget import Budget, CpuSeconds
from verification.instruments.references import Known
from verification.instruments.speed_accuracy import work_precision
from verification.page.kept import DATA, keep
from verification.page.prose import fill
from verification.thesis.chapter2.methods import ADAPTIVE, EVENT_DRIVEN, LINEARISED_ACTIVE, MIDPOINT_ACTIVE, PBD

FILE = DATA / "event_driven_reach.parquet"
DISCS = (10, 30, 60, 100)
METHODS = (EVENT_DRIVEN, ADAPTIVE, MIDPOINT_ACTIVE, LINEARISED_ACTIVE, PBD)
TARGETS = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8)
SETTINGS = {"dt": [0.1 / 4**k for k in range(10)], "tol": [1e-2, 1e-4, 1e-6, 1e-8]}
# Of one run; that of the reference, tighter than any method's [length].
BUDGET, TOL = CpuSeconds(4.0), 1e-10


def main() -> None:
    """Measure all piles and keep the table."""
    keep(pd.concat([measure(count, BUDGET) for count in DISCS], ignore_index=True), FILE, main)


def measure(count: int, budget: Budget) -> pd.DataFrame:
    """Return one row for each error: CPU seconds of each method, NaN where it is not reached, and the cheapest one."""
    scene = dincl.scenes.pile(count)
    found = dincl.solve(scene, dincl.EventDriven(TOL), np.linspace(0.0, scene.times[-1], 9)[1:])
    known = Known(found.t, found.x, np.asarray(found.error))
    chart = work_precision(scene, METHODS, SETTINGS, found.t, known, budget)
    costs = chart.costs(TARGETS).T.rename(columns={method.label: method.name for method in METHODS})
    won = chart.cheapest(TARGETS).set_index("target")["cheapest"]
    rows = costs.assign(cheapest=won, discs=count, events=len(found.events))
    return rows.rename_axis("target").reset_index().rename_axis(columns=None)


def table() -> pd.DataFrame:
    """Return the kept table."""
    return read_sealed(FILE)


def ratios() -> pd.DataFrame:
    """Return the kept table with the times over the least of their row: seconds belong to the machine of the table."""
    rows, names = table(), [method.name for method in METHODS]
    return rows.assign(**rows[names].div(rows[names].min(axis=1), axis=0))


def first(rows: pd.DataFrame) -> pd.DataFrame:
    """Return, for each number of discs, the error below which the event-driven scheme is the cheapest, or NaN."""
    found = []
    for discs, mine in rows.sort_values("target").groupby("discs"):
        wins = (mine["cheapest"] == EVENT_DRIVEN.label).cumprod().astype(bool)
        found.append({"discs": discs, "target": mine.loc[wins, "target"].max()})
    return pd.DataFrame(found)


def said() -> dict[str, str]:
    """Fill the prose of the section from the kept table."""
    rows = table()
    begins = first(rows)
    return fill(
        Path(__file__).parent / "prose" / "reach.html",
        discs=rows["discs"].unique(),
        events=rows["events"].unique(),
        first=[row._replace(target=None if np.isnan(row.target) else row.target) for row in begins.itertuples()],
        least=begins["target"].min(skipna=False),
        budget=BUDGET,
    )


if __name__ == "__main__":
    main()
