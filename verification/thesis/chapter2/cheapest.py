"""Which method reaches an accuracy in the shortest time."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd

from verification.order import MIN_STEPS, estimate, order_text
from verification.page.report import number
from verification.thesis.chapter2.methods import METHODS, PBD

TARGETS = (1e-2, 1e-3, 1e-4, 1e-6, 1e-8)
# An error below this many times the stated error of the reference is not counted as an accuracy reached.
RESOLVED = 2.0
# Rows of runs that were not made, which is no failure.
NOT_TRIED = ("LEFT_OUT", "REFUSED")


def accuracy(rows: pd.DataFrame) -> pd.Series:
    """The largest error in time, or RESOLVED times the error of the reference if that is larger; NaN if none."""
    return rows["sup"].clip(lower=RESOLVED * rows["reference_error"])


def seconds_to(rows: pd.DataFrame, target: float) -> float:
    """The time in which one method reaches ``target``, from its runs on one scene; infinite if it does not [s].

    Runs go from coarse to fine. After the last one that misses the target the next one has it, and so have all finer
    ones; the time lies on the straight line between these two in (log error, log time). Nothing is extrapolated: where
    no run misses the target, the shortest time of all is taken; where the finest misses it, it is not reached.
    """
    done = rows[rows["status"] == "SUCCESS"].sort_values("setting", ascending=False)
    error, seconds = accuracy(done).to_numpy(), done["seconds"].to_numpy()
    missing = np.flatnonzero(error > target)
    if len(missing) == 0:
        return float(seconds.min(initial=math.inf))
    last = int(missing[-1])
    if last == len(error) - 1:
        return math.inf
    pair = slice(last, last + 2)
    there = np.interp(np.log(target), np.log(error[pair])[::-1], np.log(seconds[pair])[::-1])
    return float(np.exp(there))


def times(table: pd.DataFrame, targets: Sequence[float] = TARGETS) -> pd.DataFrame:
    """One row for each scene and method, in the order of METHODS.

    Columns: the time to each target [s], NaN where it is not reached; ``best``, the smallest error reached, and of that
    run ``at_end``, the error at the end over the largest in time; ``order`` of the error in dt, "" for tolerances or
    too few runs; how many runs ``failed``.
    """
    groups = table.groupby(["scene", "method"], sort=False)
    found = [{"scene": name[0], "method": name[1]} | _of_one(rows, targets) for name, rows in groups]
    order = {name: rank for rank, name in enumerate(METHODS)}
    return pd.DataFrame(found).sort_values(
        ["scene", "method"], key=lambda names: names.map(order) if names.name == "method" else names, ignore_index=True
    )


def _of_one(rows: pd.DataFrame, targets: Sequence[float]) -> dict[str, object]:
    """The columns of ``times`` for one scene and method."""
    seconds = {f"{target:g}": seconds_to(rows, target) for target in targets}
    done = rows[rows["status"] == "SUCCESS"]
    best = done.loc[done["sup"].idxmin()] if len(done) else None
    stepping = len(done) >= MIN_STEPS and METHODS[rows["method"].iloc[0]].setting == "dt"
    return {name: s if math.isfinite(s) else math.nan for name, s in seconds.items()} | {
        "best": math.nan if best is None else accuracy(done).min(),
        "at_end": math.nan if best is None or best["sup"] == 0 else best["final"] / best["sup"],
        "order": order_text(estimate(done["setting"], done["sup"], done["reference_error"].max())) if stepping else "",
        "failed": int((~rows["status"].isin(("SUCCESS", *NOT_TRIED))).sum()),
    }


def winners(table: pd.DataFrame, targets: Sequence[float] = TARGETS) -> pd.DataFrame:
    """One row for each scene and target: the cheapest method, its time, and how many times longer others take.

    ``method`` is "" where none reaches the target; ``runner_up`` likewise, and ratios are NaN where there is nothing
    to compare with.
    """
    wide = times(table, targets)
    return pd.DataFrame(
        [
            {"scene": scene, "target": target} | _winner(rows.set_index("method")[f"{target:g}"].dropna())
            for scene, rows in wide.groupby("scene", sort=False)
            for target in targets
        ]
    )


def _winner(seconds: pd.Series) -> dict[str, object]:
    """``seconds`` by method, those that reach the target."""
    ranked = seconds.sort_values()
    best, second = ([*ranked.index, "", ""])[:2]
    time, next_time = ([*ranked, math.nan, math.nan])[:2]
    return {
        "method": best,
        "seconds": time,
        "runner_up": second,
        "runner_up_ratio": next_time / time,
        "pbd_ratio": float(ranked.get(PBD.name, math.nan)) / time,
    }


def sentence(rows: pd.DataFrame) -> str:
    """The winners of one scene in words, from the table of ``winners``."""
    ordered = rows.sort_values("target", ascending=False)
    won, open_ = ordered[ordered["method"] != ""], ordered[ordered["method"] == ""]
    parts = [_part(row) for row in won.itertuples()]
    if len(open_):
        parts.append(f"no method reaches {', '.join(number(target) for target in open_['target'])} in the time given")
    text = "; ".join(parts)
    return f"{text[0].upper()}{text[1:]}."


def _part(row: Any) -> str:
    others = []
    if row.runner_up and row.runner_up != PBD.name:
        others.append(f"{METHODS[row.runner_up].label} takes {number(row.runner_up_ratio)} times as long")
    if not row.runner_up:
        others.append("no other method gets there")
    elif row.method != PBD.name:
        got = math.isfinite(row.pbd_ratio)
        others.append(f"PBD takes {number(row.pbd_ratio)} times as long" if got else "PBD does not get there")
    label, target = METHODS[row.method].label, number(row.target)
    return f"to an error of {target} {label} is the cheapest, with {number(row.seconds)} s ({', '.join(others)})"


def summary(rows: pd.DataFrame) -> str:
    """How often each method wins, and where PBD does, from the table of ``winners``."""
    won = rows[rows["method"] != ""]
    counts = [f"{METHODS[name].label} {count}" for name, count in won["method"].value_counts(sort=True).items()]
    own = [
        f"{number(target)}" for target in sorted(won.loc[won["method"] == PBD.name, "target"].unique(), reverse=True)
    ]
    where = f"PBD is the cheapest at an error of {' and '.join(own)} only" if own else "PBD is never the cheapest"
    return (
        f"Of {len(rows)} pairs of scene and error, {len(won)} were reached by some method. Cheapest, and how often: "
        f"{', '.join(counts)}. {where}."
    )
