"""Prediction of nuclei: two runs of one seed that begin a little apart, or that have different noise."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np
import pandas as pd

from dincl.study import Key, Row, Study
from verification.thesis.chapter3.growing import Growing, disturbed, growing, nuclei, rms, with_noise
from verification.thesis.chapter3.intervals import over_seeds

# Standard deviations of each coordinate at the start [R_soft].
SIZES = (1e-9, 1e-6, 1e-3)
# Two runs are in agreement as long as they are closer than this part of the distance of runs with other noise.
PART = 0.5
# Before this runs with other noise have met it only a few times [h].
FIRST = 1.0
# Seeds of other noise are these beyond those of the run.
OTHER = 1_000_000


@dataclass(frozen=True)
class DisturbedForm:
    """Extent of the study: pairs of preset and substeps, number of seeds, times [h]."""

    runs: tuple[tuple[str, int], ...]
    seeds: int
    times: tuple[float, ...]


TIMES = (0.1, 0.5, 1.0, 2.0, 3.0, 5.0, 7.0, 10.0, 15.0, 20.0)
FEW = (("thesis", 20), ("thesis", 160), ("published", 40))
FULL = DisturbedForm((*FEW, ("thesis", 640), ("published", 640)), 20, (*TIMES, 30.0, 40.0, 48.0))


def study(form: DisturbedForm) -> Study:
    """Return the study: one run for each preset, number of substeps and seed."""
    runs = sorted(form.runs, key=lambda pair: -pair[1])
    return Study(
        name="tissue_disturbed",
        title="Tissue: small disturbances",
        key=("preset", "substeps", "seed"),
        runs=tuple(
            {"preset": name, "substeps": substeps, "seed": seed}
            for name, substeps in runs
            for seed in range(form.seeds)
        ),
        run=partial(followed, times=form.times),
    )


def followed(key: Key, times: tuple[float, ...]) -> list[Row]:
    """Return one row for each disturbance and time: its size (infinite: other noise) and the distance of the nuclei."""

    def run() -> Growing:
        return growing(key["preset"], key["seed"], substeps=key["substeps"])

    plain = _paths(run(), times)
    others = {size: disturbed(run(), size) for size in SIZES} | {np.inf: with_noise(run(), OTHER + key["seed"])}
    rows: list[Row] = []
    for size, other in others.items():
        distances = [rms(x, y) for x, y in zip(plain, _paths(other, times), strict=True)]
        rows += [dict(key) | {"size": size, "t": t, "rms": far} for t, far in zip(times, distances, strict=True)]
    return rows


def _paths(run: Growing, times: tuple[float, ...]) -> list[np.ndarray]:
    return [nuclei(run.frame()) if run.to(t) else np.full_like(nuclei(run.frame()), np.nan) for t in times]


def medians(table: pd.DataFrame) -> pd.DataFrame:
    """Return one row for each preset, number of substeps, size and time: median and largest distance over the seeds."""
    grouped = table.groupby(["preset", "substeps", "size", "t"])["rms"]
    return grouped.agg(median="median", largest="max").reset_index()


def rates(table: pd.DataFrame) -> pd.DataFrame:
    """Return one row for each preset, number of substeps and size: growth of a disturbance, in two numbers.

    ``rate`` is the mean over the seeds of log(end / start) / time with its interval [1/h]: what an exponential growth
    would have. ``jumped`` is the part of the seeds whose nuclei are in the end further apart than ``PART`` of the
    distance of runs with other noise.
    """
    names = ["preset", "substeps", "size"]
    start, end = (table[table["t"] == t].set_index([*names, "seed"])["rms"] for t in table["t"].agg(["min", "max"]))
    hours = table["t"].max() - table["t"].min()
    noise = end.xs(np.inf, level="size").groupby(["preset", "substeps"]).median()
    rows = []
    for (name, substeps, size), last in end[end.index.get_level_values("size") < np.inf].groupby(names):
        mean, low, high = over_seeds(np.log(last / start[last.index]) / hours)
        about = {"preset": name, "substeps": substeps, "size": size, "rate": mean, "low": low, "high": high}
        rows.append(about | {"jumped": float((last > PART * noise[name, substeps]).mean()), "runs": len(last)})
    return pd.DataFrame(rows)


def predicted(errors: pd.DataFrame, made: pd.DataFrame) -> pd.DataFrame:
    """Return one row for each preset and number of substeps: until when nuclei are predicted, from medians.

    Until the last time t [h] such that the error is at most PART of the distance of runs with other noise at all times
    from FIRST to t; 0 if it is more at FIRST. ``errors`` is that of ``substeps.errors``.
    """
    noise = made[made["size"] == np.inf].groupby(["preset", "t"])["median"].median()
    rows = []
    for (name, substeps), mine in errors.groupby(["preset", "substeps"]):
        known = mine[[t >= FIRST and (name, t) in noise.index for t in mine["t"]]].sort_values("t")
        limit = PART * noise.loc[[(name, t) for t in known["t"]]].to_numpy()
        good = (known["rms"].to_numpy() <= limit).cumprod().astype(bool)
        until = float(known["t"].to_numpy()[good].max(initial=0.0))
        rows.append({"preset": name, "substeps": substeps, "until": until, "looked_at": float(known["t"].max())})
    return pd.DataFrame(rows)
