"""Error and infeasibility against the step, for every method of the report (Figures 4 and 5 of chapter 2)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd

from dincl.study import Key, Row, Study
from verification.instruments.error_norms import distance
from verification.instruments.measure import reached
from verification.instruments.order import Order, estimate, order_text
from verification.thesis.chapter2.methods import COMPARED, METHODS, NamedMethod
from verification.thesis.chapter2.reference import EventReference
from verification.thesis.chapter2.runs import scene, solved

SCENES = ("four_disks", "ten_disks_corner")
# Steps are STEP / 2^k [time].
STEP = 0.1
# Errors and infeasibilities below this come from the tolerances of the projections, not from the method [length].
FLOOR = 1e-9


@dataclass(frozen=True)
class ConvergenceForm:
    """How many steps are run with each method, and with each of the costly ones."""

    steps: int
    costly_steps: int
    methods: tuple[NamedMethod, ...] = COMPARED


FULL = ConvergenceForm(10, 10)


@dataclass(frozen=True)
class ConvergenceRun:
    """The errors of one run at the times of its scene: one row each."""

    references: Mapping[str, EventReference]

    def __call__(self, key: Key) -> list[Row]:
        kept = scene(key["scene"]).times
        times = np.array(kept)
        path, run = solved(key["scene"], key["method"], key["dt"], times)
        states = reached(path, times)
        x, resolution = self.references[key["scene"]].at(kept)
        error = distance(states, x)
        infeasible = [
            path.problem.violation(t, state) if np.isfinite(state).all() else np.nan
            for t, state in zip(times, states, strict=True)
        ]
        columns = {"t": times, "error": error, "infeasibility": infeasible, "reference_error": resolution}
        return [
            dict(key) | dict(zip(columns, values, strict=True)) | run for values in zip(*columns.values(), strict=True)
        ]


def study(references: Mapping[str, EventReference], form: ConvergenceForm) -> Study:
    """Return all runs of the methods compared."""
    runs = [
        {"scene": name, "method": method.name, "dt": STEP / 2**k}
        for k in reversed(range(form.steps))
        for method in reversed(form.methods)
        for name in reversed(SCENES)
        if k < form.costly_steps or not method.costly
    ]
    return Study(
        name="convergence",
        title="Convergence",
        key=("scene", "method", "dt"),
        runs=tuple(runs),
        run=ConvergenceRun(references),
    )


def order_of(rows: pd.DataFrame, quantity: str = "error") -> Order:
    """Return the order of one method on one scene at one time; a run that ended before that time failed."""
    floor = max(FLOOR, float(rows["reference_error"].iloc[0])) if quantity == "error" else FLOOR
    return estimate(rows["dt"], rows[quantity], floor=floor, failed=rows[quantity].isna().to_numpy())


def orders(table: pd.DataFrame) -> pd.DataFrame:
    """Return one row for each scene, time and method: order, its interval, the sentence, the finest run."""
    names = ["scene", "method", "t"]
    groups = table.groupby(names, sort=False)
    found = pd.DataFrame([dict(zip(names, values, strict=True)) | _orders_of(rows) for values, rows in groups])
    ranks = {method: rank for rank, method in enumerate(METHODS)}
    return found.sort_values(
        ["scene", "t", "method"], key=lambda column: column.map(ranks) if column.name == "method" else column
    ).reset_index(drop=True)


def _orders_of(rows: pd.DataFrame) -> dict[str, object]:
    order, finest = order_of(rows), rows.loc[rows["dt"].idxmin()]
    low, high = order.interval or (None, None)
    return {
        "order": order_text(order),
        "slope": order.slope,
        "low": low,
        "high": high,
        "verdict": order.verdict,
        "infeasibility_order": order_text(order_of(rows, "infeasibility")),
        **finest[["dt", "error", "infeasibility", "seconds"]].to_dict(),
        "runs": len(rows),
        "failed": int(rows["error"].isna().sum()),
    }
