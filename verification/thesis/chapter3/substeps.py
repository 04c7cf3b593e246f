"""Accuracy against speed: nuclei and heights for n substeps in each dt, against the same run with many more.

Runs of one seed meet the same noise and the same divisions, whatever their substeps: a difference is an error.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from typing import Any

import numpy as np
import pandas as pd

from dincl.study import Key, Row, Study
from tissue.frames.frame import Frame
from tissue.frames.observables import height
from verification.instruments.order import Order, estimate, order_text
from verification.thesis.chapter3.growing import PRESETS, SUCCESS, Growing, growing, nuclei, rms
from verification.thesis.chapter3.intervals import over_seeds

# When the states are looked at; all of them are multiples of dt in both presets [h].
TIMES = (0.1, 1.0, 2.0, 5.0, 10.0, 20.0, 30.0, 40.0, 48.0)
# The length of the runs whose speed is told; when a height has to be right [h].
TIMED = 10.0
HEIGHTS = (10.0, 48.0)
# Part of the height that is good enough.
ENOUGH = 0.01
# The reference is off by no more than this times its difference to half as many substeps: with order p it is
# 1 / (2^p - 1) of it, and 1 / (sqrt(2) - 1) = 2.4 for the lowest order here.
SAFETY = 2.5


@dataclass(frozen=True)
class SubstepsForm:
    """Extent of the study: substeps and those of the reference by preset, number of seeds, times [h].

    At the times ``heights`` a height has to be right [h].
    """

    substeps: Mapping[str, tuple[int, ...]]
    reference: Mapping[str, int]
    seeds: int
    times: tuple[float, ...] = TIMES
    heights: tuple[float, ...] = HEIGHTS


FEW, MANY = (1, 2, 5, 10, 20, 40, 80), (160, 320, 640)
# The step dt of the published preset is half as long.
FULL = SubstepsForm(dict.fromkeys(PRESETS, (*FEW, *MANY)), dict.fromkeys(PRESETS, 2560), 20)


def study(form: SubstepsForm) -> Study:
    """Return the study: one run for each preset and seed: all numbers of substeps, and the reference with its half."""
    return Study(
        name="tissue_substeps",
        title="Tissue: substeps",
        key=("preset", "seed"),
        runs=tuple({"preset": name, "seed": seed} for seed in range(form.seeds) for name in PRESETS),
        run=partial(compared, form=form),
        # More seeds are more runs; the heights are looked at afterwards.
        settings=asdict(form) | {"seeds": None, "heights": None},
    )


def compared(key: Key, form: SubstepsForm) -> list[Row]:
    """Return one row for each number of substeps and time: distance of the nuclei to the reference, and both heights.

    The reference is made first, so that loading and compiling are not in the seconds of the others.
    """
    name = key["preset"]
    exact = _states(growing(name, key["seed"], substeps=form.reference[name]), form)
    rows: list[Row] = []
    for substeps in (*form.substeps[name], form.reference[name] // 2):
        run = growing(name, key["seed"], substeps=substeps)
        for t, now, true in zip(form.times, _states(run, form), exact, strict=True):
            about = {"substeps": substeps, "h": run.numbers.dt / substeps, "t": t}
            rows.append(dict(key) | about | _measured(*now, true[0]))
    return rows


def _states(run: Growing, form: SubstepsForm) -> list[tuple[Frame | None, str, float]]:
    """Return the states at the times of the form, None where the run is lost, with status and seconds so far."""
    return [(run.frame() if run.to(t) else None, run.status, run.seconds) for t in form.times]


def _measured(now: Frame | None, status: str, seconds: float, true: Frame | None) -> dict[str, Any]:
    numbers = dict.fromkeys(("rms", "relative", "height", "reference_height"), np.nan)
    if now is not None and true is not None:
        x, y = nuclei(now), nuclei(true)
        numbers = {
            "rms": rms(x, y),
            "relative": float(np.linalg.norm(x - y) / np.linalg.norm(y)),
            "height": height(now),
            "reference_height": height(true),
        }
    return {"status": status, "seconds": seconds} | numbers


def errors(table: pd.DataFrame) -> pd.DataFrame:
    """Return one row for each preset, number of substeps and time: medians over the seeds, and how many were lost.

    ``own`` is the bound on the error of the reference, SAFETY times its median distance to half as many substeps.
    """
    rows = []
    for (name, substeps, t), mine in table.groupby(["preset", "substeps", "t"], sort=False):
        lost = (mine["status"] != SUCCESS).sum()
        numbers = {column: mine[column].median() for column in ("h", "rms", "relative")}
        rows.append({"preset": name, "substeps": substeps, "t": t, "lost": lost, "runs": len(mine)} | numbers)
    made = pd.DataFrame(rows)
    made["largest"] = table.groupby(["preset", "substeps", "t"], sort=False)["rms"].max().to_numpy()
    half = made["substeps"] == made.groupby("preset")["substeps"].transform("max")
    own = SAFETY * made[half].set_index(["preset", "t"])["rms"]
    timed = table[table["t"] == TIMED].groupby(["preset", "substeps"])["seconds"].median()
    made["own"] = own.loc[list(zip(made["preset"], made["t"], strict=True))].to_numpy()
    made["seconds"] = timed.loc[list(zip(made["preset"], made["substeps"], strict=True))].to_numpy()
    return made[~half].reset_index(drop=True)


def orders(made: pd.DataFrame) -> pd.DataFrame:
    """Return one row for each preset and time: the order in h of the median error of the nuclei, from ``errors``."""
    groups = made.groupby(["preset", "t"], sort=False)
    return pd.DataFrame([{"preset": name, "t": t} | _order(mine) for (name, t), mine in groups])


def _order(mine: pd.DataFrame) -> dict[str, Any]:
    found = estimate(mine["h"], mine["rms"], floor=float(mine["own"].iloc[0]), failed=(mine["lost"] > 0).to_numpy())
    return _told(found)


def _told(found: Order) -> dict[str, Any]:
    low, high = found.interval or (np.nan, np.nan)
    slope = np.nan if found.slope is None else found.slope
    return {"order": order_text(found), "slope": slope, "low": low, "high": high, "verdict": found.verdict}


def heights(table: pd.DataFrame, times: Sequence[float] = HEIGHTS) -> pd.DataFrame:
    """Return one row for each preset, time and number of substeps: the deviation of the height, in parts of it.

    Mean over the seeds with its interval, and the largest that the deviation of the limit can be: beside the interval
    the reference itself may be off by ``own``. Lost runs are counted; a height of which some are lost is not told.
    """
    rows = []
    for (name, t, substeps), mine in table[table["t"].isin(times)].groupby(["preset", "t", "substeps"]):
        lost = int((mine["status"] != SUCCESS).sum())
        part = (mine["height"] / mine["reference_height"] - 1).to_numpy()
        mean, low, high = over_seeds(part)
        about = {"preset": name, "t": t, "substeps": substeps, "h": mine["h"].iloc[0], "lost": lost, "runs": len(mine)}
        rows.append(about | {"height": mine["height"].mean(skipna=False), "deviation": mean, "low": low, "high": high})
    made = pd.DataFrame(rows)
    finest = made["substeps"] == made.groupby("preset")["substeps"].transform("max")
    half = made[finest].set_index(["preset", "t"])["deviation"]
    made["own"] = SAFETY * half.abs().loc[list(zip(made["preset"], made["t"], strict=True))].to_numpy()
    made["at_most"] = made[["low", "high"]].abs().max(axis=1) + made["own"]
    return made


def enough(made: pd.DataFrame) -> pd.DataFrame:
    """Return one row for each preset and time: the substeps from which on heights are right to ENOUGH.

    0 where none of those tried is; beside it the order in h of the mean deviation.
    """
    rows = []
    finest_first = made.sort_values("substeps", ascending=False)
    for (name, t), mine in finest_first.groupby(["preset", "t"]):
        right = (mine["at_most"] <= ENOUGH).cummin()
        least = int(mine.loc[right, "substeps"].min()) if right.any() else 0
        coarse = mine.iloc[1:]
        found = estimate(
            coarse["h"],
            coarse["deviation"].abs(),
            floor=float(mine["own"].iloc[0]),
            failed=(coarse["lost"] > 0).to_numpy(),
        )
        rows.append({"preset": name, "t": t, "substeps": least, "finest": int(mine["substeps"].max())} | _told(found))
    return pd.DataFrame(rows)
