"""Runs of DAHA by four readings of the model: share that does not end, and heights after 48 h."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np
import pandas as pd

from dincl.study import Key, Row, Study
from tissue.files.parameters import Parameters, preset
from tissue.frames.observables import height
from tissue.quasi_steady.run import simulate_quasi_steady
from verification.thesis.chapter3.daha import END, wilson
from verification.thesis.chapter3.growing import until
from verification.thesis.chapter3.intervals import over_seeds
from verification.thesis.chapter3.judged import FLOORED

# A preset and what changes in it. The published program has the last one, and DAHA with the parameters of Table 4.
READINGS = {
    "as printed": ("thesis", {}),
    "desired rest lengths ≥ 0": ("thesis", FLOORED),
    "squared denominators": ("corrected", {}),
    "published program": ("published", {}),
}


@dataclass(frozen=True)
class EndsForm:
    """Number of seeds of each reading, for shares and for heights, and the end of the runs for heights [h].

    73 seeds give the 95 % interval of a share of 1/4 the half-width 0.1.
    """

    seeds: int = 73
    grown: int = 4
    end: float = 48.0


FULL = EndsForm()


def study(form: EndsForm) -> Study:
    """Return the study: one run for each reading and seed."""
    return Study(
        name="tissue_daha_ends",
        title="Tissue: runs of DAHA that end",
        key=("reading", "seed"),
        runs=tuple({"reading": reading, "seed": seed} for reading in READINGS for seed in range(form.seeds)),
        run=ended,
    )


def read(reading: str, end: float = END) -> Parameters:
    """Return the parameters of a reading, for runs to ``end`` [h]."""
    name, changes = READINGS[reading]
    return preset(name).changed({**changes, **until(end)})


def ended(key: Key) -> list[Row]:
    """Return one row: how a run ended, and when [h]."""
    run = simulate_quasi_steady(read(key["reading"]), key["seed"], throw=False)
    made = {"status": run.status.name, "t": run.final.t, "iterations": int(run.iterations.sum())}
    return [dict(key) | made | {"ended": bool(run.status)}]


def shares(table: pd.DataFrame) -> pd.DataFrame:
    """Return one row for each reading: share of the runs that do not end, with Wilson's 95 % interval."""
    rows = []
    for reading, mine in table.groupby("reading", sort=False):
        lost = mine[~mine["ended"].astype(bool)]
        low, high = wilson(len(lost), len(mine))
        counts = {"reading": reading, "runs": len(mine), "failed": len(lost), "share": len(lost) / len(mine)}
        rows.append(counts | {"low": low, "high": high, "first": lost["t"].min(), "last": lost["t"].max()})
    return pd.DataFrame(rows)


def heights_study(form: EndsForm) -> Study:
    """Return the study: one run for each seed and each reading but the printed one, of which no run ends."""
    _, *ending = READINGS
    return Study(
        name="tissue_daha_grown",
        title="Tissue: growth by DAHA",
        key=("reading", "seed"),
        runs=tuple({"reading": reading, "seed": seed} for reading in ending for seed in range(form.grown)),
        run=partial(grown, end=form.end),
    )


def grown(key: Key, end: float) -> list[Row]:
    """Return one row: the height at the end over the height at the start, NaN if the run does not end."""
    run = simulate_quasi_steady(read(key["reading"], end), key["seed"], throw=False)
    ratio = height(run.final) / height(run.frames[0]) if run.status else np.nan
    return [dict(key) | {"status": run.status.name, "ratio": ratio}]


def heights(table: pd.DataFrame) -> pd.DataFrame:
    """Return one row for each reading: mean of the heights at the end over the first ones, with its interval."""
    rows = []
    for reading, mine in table.groupby("reading", sort=False):
        ended = mine["ratio"].dropna()
        mean, low, high = over_seeds(ended)
        rows.append({"reading": reading, "runs": len(ended), "ratio": mean, "low": low, "high": high})
    return pd.DataFrame(rows)
