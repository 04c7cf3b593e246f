"""Who is cheapest on each scene of the report, in tables and in words."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
import pandas as pd

from verification.cheapest import AT_THE_LIMIT, NOT_REACHED, NOT_TRIED, TIE, accuracy
from verification.order import MIN_STEPS, estimate, order_text
from verification.page.report import number
from verification.speed_accuracy import TARGETS, WorkPrecision
from verification.thesis.chapter2.methods import CHARTED, PBD
from verification.thesis.chapter2.work_precision import Form, chart

SETTINGS = {method.label: method.setting for method in CHARTED}
UNDECIDED = (TIE, AT_THE_LIMIT)


def times(table: pd.DataFrame, form: Form, targets: Sequence[float] = TARGETS) -> pd.DataFrame:
    """One row for each scene and method.

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
    """The columns of ``times`` that no target belongs to."""
    done = rows[rows["status"] == "SUCCESS"]
    best = done.loc[done["largest"].idxmin()] if len(done) else None
    stepping = len(done) >= MIN_STEPS and SETTINGS[rows["method"].iloc[0]] == "dt"
    order = estimate(done["setting"], done["largest"], done["reference_error"].max()) if stepping else None
    return {
        "best": math.nan if best is None else accuracy(done, "largest").min(),
        "at_end": math.nan if best is None or best["largest"] == 0 else best["final"] / best["largest"],
        "order": "" if order is None else order_text(order),
        "failed": int((~rows["status"].isin(("SUCCESS", *NOT_TRIED))).sum()),
    }


def winners(table: pd.DataFrame, form: Form, targets: Sequence[float] = TARGETS) -> pd.DataFrame:
    """One row for each scene and target: ``WorkPrecision.cheapest``, and how many times more PBD costs."""
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


def sentence(rows: pd.DataFrame) -> str:
    """The winners of one scene in words, from the table of ``winners``."""
    ordered = rows.sort_values("target", ascending=False)
    parts = [_part(row) for row in ordered.itertuples() if row.cheapest not in (NOT_REACHED, AT_THE_LIMIT)]
    for verdict, words in (
        (AT_THE_LIMIT, "whoever reaches {} does so at the limit of the time given, which decides nothing"),
        (NOT_REACHED, "no method reaches {} in the time given"),
    ):
        named = ordered.loc[ordered["cheapest"] == verdict, "target"]
        if len(named):
            parts.append(words.format(", ".join(map(number, named))))
    text = "; ".join(parts)
    return f"{text[0].upper()}{text[1:]}."


def _part(row: Any) -> str:
    target = f"to an error of {number(row.target)}"
    if row.cheapest == TIE:
        return (
            f"{target} {_listed(row.tied.split('; '))} cost the same, {number(row.cost)} s, as far as can be measured"
        )
    others = []
    if row.next and row.next != PBD.label:
        others.append(f"{row.next} takes {number(row.ratio)} times as long")
    if not row.next:
        others.append("no other method gets there")
    elif row.cheapest != PBD.label:
        got = math.isfinite(row.pbd_ratio)
        others.append(f"PBD takes {number(row.pbd_ratio)} times as long" if got else "PBD does not get there")
    return f"{target} {row.cheapest} is the cheapest, with {number(row.cost)} s ({', '.join(others)})"


def _listed(names: Iterable[str]) -> str:
    *first, last = names
    return f"{', '.join(first)} and {last}"


def summary(rows: pd.DataFrame) -> str:
    """How often each method wins, and where PBD does, from the table of ``winners``."""
    decided = rows[~rows["cheapest"].isin((*UNDECIDED, NOT_REACHED))]
    counts = [f"{name} {count}" for name, count in decided["cheapest"].value_counts(sort=True).items()]
    own = np.unique(decided.loc[decided["cheapest"] == PBD.label, "target"])[::-1]
    where = f"PBD is the cheapest at an error of {' and '.join(map(number, own))} only" if len(own) else ""
    undecided = {word: int((rows["cheapest"] == word).sum()) for word in (*UNDECIDED, NOT_REACHED)}
    return (
        f"Of {len(rows)} pairs of scene and error, {len(decided)} have one cheapest method. Cheapest, and how often: "
        f"{', '.join(counts)}. {where or 'PBD is never alone the cheapest'}. Of the other pairs {undecided[TIE]} are "
        f"ties, {undecided[AT_THE_LIMIT]} lie at the limit of the time given, {undecided[NOT_REACHED]} are not reached."
    )
