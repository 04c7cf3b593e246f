"""Accuracy of substeps: nuclei and heights for n substeps in each dt, against the same run with many more.

Runs of one seed meet the same noise and the same divisions, whatever their substeps: a difference is an error.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pandas as pd

from dincl.study import Key, Row, Study
from tissue.frames.frame import Frame
from tissue.frames.observables import height
from verification.instruments.order import estimate, order_text
from verification.thesis.chapter3.growing import PRESETS, Growing, growing, nuclei, rms
from verification.thesis.chapter3.sampled import over_seeds

SUBSTEPS, REFERENCE, SEEDS = (1, 2, 5, 10, 20, 40, 80, 160, 320, 640), 2560, 20
# Output times, multiples of dt in both presets; the length of the runs whose seconds are given [h].
TIMES, TIMED = (0.1, 1.0, 2.0, 5.0, 10.0, 20.0, 30.0, 40.0, 48.0), 10.0
# Part of the height that is accurate enough.
ENOUGH = 0.01
# The reference is off by no more than this times its difference to half as many substeps: with order p it is
# 1 / (2^p - 1) of it, and 1 / (sqrt(2) - 1) = 2.4 for the lowest order here.
SAFETY = 2.5
COLUMNS = {
    "preset": "Preset",
    "t": "t [h]",
    "substeps": "Substeps",
    "nuclei": "Order in h of nuclei [range]",
    "rms": "Error of nuclei [R_soft]",
    "own": "Error of nuclei of the reference [R_soft]",
    "height": "Order in h of the height [range]",
    "deviation": "Relative error of the height",
    "low": "from",
    "high": "to",
    "own_height": "Relative error of the height of the reference",
    "enough": "Substeps from which on heights are within 1 %",
    "seconds": "Seconds for 10 h",
    "lost": "Lost",
    "runs": "Runs",
}


def study(smallest: bool = False) -> Study:
    """Return one run for each preset and seed: all numbers of substeps, and the reference with its half."""
    times, seeds = (TIMES[:4], 1) if smallest else (TIMES, SEEDS)
    runs = tuple({"preset": name, "seed": seed} for seed in range(seeds) for name in PRESETS)
    run = partial(compared, times=times)
    settings = {"substeps": SUBSTEPS, "reference": REFERENCE, "times": times}
    key, by = ("preset", "seed"), ("substeps", "t")
    return Study("tissue_substeps", "Tissue: substeps", key, runs, run, settings, COLUMNS, by)


def compared(key: Key, times: tuple[float, ...]) -> list[Row]:
    """Return a row for each number of substeps and time: distance of the nuclei to the reference, error of the height.

    The reference is made first, so that loading and compiling are not in the seconds of the others.
    """
    exact = _states(growing(key["preset"], key["seed"], substeps=REFERENCE), times)
    rows: list[Row] = []
    for substeps in (*SUBSTEPS, REFERENCE // 2):
        states = _states(growing(key["preset"], key["seed"], substeps=substeps), times)
        for t, (now, status, seconds), (true, *_) in zip(times, states, exact, strict=True):
            found = {"rms": np.nan, "deviation": np.nan}
            if now is not None and true is not None:
                found = {"rms": rms(nuclei(now), nuclei(true)), "deviation": height(now) / height(true) - 1}
            rows.append({**key, "substeps": substeps, "t": t, "status": status, "seconds": seconds} | found)
    return rows


def _states(run: Growing, times: tuple[float, ...]) -> list[tuple[Frame | None, str, float]]:
    """Return the states at the times, None where the run is lost, with status and seconds so far."""
    return [(run.frame() if run.to(t) else None, run.status, run.seconds) for t in times]


def accuracy(table: pd.DataFrame) -> pd.DataFrame:
    """Return a row for each preset, time and number of substeps: median error of nuclei, mean error of heights.

    ``own`` and ``own_height`` bound the errors of the reference, SAFETY times its difference to half as many substeps;
    ``at_most`` is the largest error of the height by its interval over the seeds and the error of the reference.
    Runs that are lost are counted; their height is NaN. The last number of substeps is half of the reference's.
    """
    rows = []
    for name, mine in table.groupby(["preset", "t", "substeps"]):
        row: dict[str, Any] = dict(zip(("preset", "t", "substeps"), name, strict=True)) | {"rms": mine["rms"].median()}
        row["deviation"], row["low"], row["high"] = over_seeds(mine["deviation"])
        rows.append(row | {"lost": int(mine["rms"].isna().sum()), "runs": len(mine)})
    made = pd.DataFrame(rows)
    finest = made["substeps"] == made.groupby("preset")["substeps"].transform("max")
    for column, own in (("rms", "own"), ("deviation", "own_height")):
        of_half = made[finest].set_index(["preset", "t"])[column].abs()
        made[own] = SAFETY * of_half.loc[list(zip(made["preset"], made["t"], strict=True))].to_numpy()
    made["at_most"] = made[["low", "high"]].abs().max(axis=1) + made["own_height"]
    timed = table[table["t"] == TIMED].groupby(["preset", "substeps"])["seconds"].median().rename("seconds")
    return made.join(timed, on=["preset", "substeps"])


def orders(made: pd.DataFrame) -> pd.DataFrame:
    """Return a row for each preset and time: orders in h of both errors, and the substeps from which heights are right.

    0 where none of those tried is right to ENOUGH. Orders are fitted without the half of the reference, whose error has
    set the floor.
    """
    rows = []
    for (name, t), mine in made.groupby(["preset", "t"]):
        row: dict[str, Any] = {"preset": name, "t": t}
        for column, error, own in (("nuclei", "rms", "own"), ("height", "deviation", "own_height")):
            tried = mine[mine["substeps"] < mine["substeps"].max()]
            floor, failed = float(tried[own].iloc[0]), (tried["lost"] > 0).to_numpy()
            row[column] = order_text(estimate(1 / tried["substeps"], tried[error].abs(), floor=floor, failed=failed))
        right = (mine.sort_values("substeps", ascending=False)["at_most"] <= ENOUGH).cummin()
        rows.append(row | {"enough": int(mine.loc[right[right].index, "substeps"].min()) if right.any() else 0})
    return pd.DataFrame(rows)
