"""The cheapest methods on each scene of the report, in tables."""

from __future__ import annotations

import math
from collections.abc import Sequence

import pandas as pd

from verification.beyond.chart.references import SCENES
from verification.beyond.chart.work_precision import Form, chart
from verification.instruments.chart import TARGETS, WorkPrecision
from verification.instruments.cheapest import NOT_TRIED, accuracy
from verification.instruments.order import MIN_STEPS, estimate, order_text
from verification.page.parts import number
from verification.thesis.chapter2.methods import CHARTED, PBD

SETTINGS = {method.label: method.setting for method in CHARTED}


def times(table: pd.DataFrame, form: Form, targets: Sequence[float] = TARGETS) -> pd.DataFrame:
    """Return one row for each scene and method.

    Columns: CPU seconds to each target, NaN where it is not reached; ``best``, the smallest error reached, and of that
    run ``at_end``, the error at the end over the largest in time; ``order`` of the error in dt, "" for tolerances or
    too few runs; how many runs ``failed``.
    """
    found = []
    for scene in dict.fromkeys(table["scene"]):
        one = chart(table, scene, form)
        costs = one.costs(targets)
        for label, rows in one.table.groupby("method", sort=False):
            seconds = {f"{target:g}": costs.loc[label, target] for target in targets}
            found.append({"scene": scene, "method": label} | seconds | _of_one(rows))
    order = {method.label: rank for rank, method in enumerate(CHARTED)}
    return pd.DataFrame(found).sort_values(
        ["scene", "method"], key=lambda names: names.map(order) if names.name == "method" else names, ignore_index=True
    )


def _of_one(rows: pd.DataFrame) -> dict[str, object]:
    """Return the columns of ``times`` that belong to no target."""
    done = rows[rows["status"] == "SUCCESS"]
    best = done.loc[done["largest"].idxmin()] if len(done) else None
    # Beyond the best setting the tolerances of the solver add up, once in each step: that is no order.
    falling = done if best is None else done[done["setting"] >= best["setting"]]
    stepping = len(falling) >= MIN_STEPS and SETTINGS[rows["method"].iloc[0]] == "dt"
    order = estimate(falling["setting"], falling["largest"], done["reference_error"].max()) if stepping else None
    return {
        "best": math.nan if best is None else accuracy(done, "largest").min(),
        "at_end": math.nan if best is None or best["largest"] == 0 else best["final"] / best["largest"],
        "order": "" if order is None else order_text(order),
        "failed": int((~rows["status"].isin(("SUCCESS", *NOT_TRIED))).sum()),
    }


def winners(table: pd.DataFrame, form: Form, targets: Sequence[float] = TARGETS) -> pd.DataFrame:
    """Return one row for each scene and target: ``WorkPrecision.cheapest``, and how many times more PBD costs."""
    charts = {scene: chart(table, scene, form) for scene in dict.fromkeys(table["scene"])}
    return pd.concat([_of_scene(scene, one, targets) for scene, one in charts.items()], ignore_index=True)


def _of_scene(scene: str, one: WorkPrecision, targets: Sequence[float]) -> pd.DataFrame:
    found = one.cheapest(targets)
    costs = one.costs(targets)
    pbd = costs.loc[PBD.label] if PBD.label in costs.index else pd.Series(dtype=float)
    ratio = found["target"].map(pbd).astype(float) / found["cost"]
    return found.assign(pbd_ratio=ratio, disturbed=int(one.table["disturbed"].sum())).assign(scene=scene)[
        ["scene", "target", "cheapest", "cost", "tied", "next", "ratio", "pbd_ratio", "disturbed"]
    ]


def wide(rows: pd.DataFrame) -> pd.DataFrame:
    """Return the cheapest method for each scene and error, from the table of ``winners``: a row for each scene."""
    titles = rows.assign(Scene=[SCENES[name]().title for name in rows["scene"]])
    table = titles.pivot(index="Scene", columns="target", values="cheapest").rename_axis(columns=None)
    return table[sorted(table, reverse=True)].rename(columns=number).reset_index()
