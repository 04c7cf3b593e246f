"""Cells of a growing tissue beyond the linear limit of explicit Euler, and their jitter."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import pandas as pd

from dincl.study import Key, Row, Study
from tissue.frames.frame import Frame
from tissue.state.numbers import Numbers
from verification.thesis.chapter3 import linear
from verification.thesis.chapter3.growing import growing
from verification.thesis.chapter3.intervals import over_seeds
from verification.thesis.chapter3.jitter import swing

# A cell jitters if its nucleus swings by more [R_soft].
SEEN = 0.01
# Jittering cells settle where the product is 2, within some percent.
BEYOND = 0.97 * linear.LIMIT
# Before this the nuclei are still on their way from where they were thrown [h].
SETTLED = 5.0


@dataclass(frozen=True)
class BeyondForm:
    """Extent of the study: substeps by preset, number of seeds, times [h]."""

    substeps: dict[str, tuple[int, ...]]
    seeds: int
    times: tuple[float, ...]


COARSE = (1, 2, 5, 10, 20, 40)
FULL = BeyondForm(
    {"thesis": (*COARSE, 80, 160, 320, 640), "published": (*COARSE, 80)},
    20,
    (1.0, 2.0, 5.0, 10.0, 20.0, 30.0, 40.0, 48.0),
)


def study(form: BeyondForm) -> Study:
    """Return the study: one run for each preset, number of substeps and seed."""
    runs = [
        {"preset": name, "substeps": substeps, "seed": seed}
        for name, tried in form.substeps.items()
        for substeps in tried
        for seed in range(form.seeds)
    ]
    return Study(
        name="tissue_jitter",
        title="Tissue: jitter",
        key=("preset", "substeps", "seed"),
        runs=tuple(sorted(runs, key=lambda run: -run["substeps"])),
        run=partial(watched, times=form.times),
    )


def watched(key: Key, times: tuple[float, ...]) -> list[Row]:
    """Return one row for each time."""
    run = growing(key["preset"], key["seed"], substeps=key["substeps"])
    numbers = run.numbers
    about = dict(key) | {"scale": numbers.dt / numbers.substeps / numbers.mu, "alpha": numbers.alpha_axb}
    rows: list[Row] = []
    for t in times:
        going = run.to(t)
        rows.append(about | {"t": t, "status": run.status} | _looked_at(run.frame() if going else None, numbers))
    return rows


def _looked_at(frame: Frame | None, numbers: Numbers) -> dict[str, Any]:
    """Return means over the cells of one state; the linear limit is looked at where the swing is gone."""
    scale = numbers.dt / numbers.substeps / numbers.mu
    found = None if frame is None else swing(frame.cells, frame.layers, numbers, scale)
    if found is None:
        return dict.fromkeys(("mean", "largest", "jittering", "beyond", "mean_beyond", "mean_within", "least"), np.nan)
    cells, amplitude = found.middle, found.nuclei
    beyond = scale * linear.largest(linear.own_hessians(cells, numbers)) >= BEYOND
    ends = [np.hypot(cells.x - getattr(cells, f"{end}x"), cells.y - getattr(cells, f"{end}y")) for end in "ab"]
    return {
        "mean": amplitude.mean(),
        "largest": amplitude.max(),
        "jittering": (amplitude > SEEN).mean(),
        "beyond": beyond.mean(),
        "mean_beyond": amplitude[beyond].mean() if beyond.any() else np.nan,
        "mean_within": amplitude[~beyond].mean() if not beyond.all() else np.nan,
        "least": min(end.min() for end in ends),
    }


def summary(table: pd.DataFrame) -> pd.DataFrame:
    """Return one row for each preset and number of substeps: means over the seeds and the times from SETTLED on.

    ``reach`` is sqrt(alpha h/mu), nearer than which a nucleus is beyond the limit of its bending alone, 2 alpha/u^2.
    """
    rows = []
    for (name, substeps), mine in table.groupby(["preset", "substeps"]):
        last = mine[mine["t"] == mine["t"].max()]
        lost = int((last["status"] != "SUCCESS").sum())
        about = {"preset": name, "substeps": substeps, "scale": mine["scale"].iloc[0], "runs": len(last), "lost": lost}
        about["to"] = ", ".join(sorted(set(last["status"]) - {"SUCCESS"}))
        settled = mine[mine["t"] >= SETTLED]
        seeds = settled.groupby("seed").mean(numeric_only=True)
        beyond = over_seeds(seeds["beyond"].dropna())
        means = seeds[["mean", "jittering", "mean_beyond", "mean_within"]].mean().to_dict()
        extremes = {"largest": settled["largest"].max(), "least": settled["least"].min()}
        share = {"beyond": beyond.mean, "low": beyond.low, "high": beyond.high}
        rows.append(
            about | means | extremes | share | {"reach": float(np.sqrt(mine["alpha"].iloc[0] * about["scale"]))}
        )
    return pd.DataFrame(rows)
