"""Share of the runs of DAHA that do not end, for four readings of the model."""

from __future__ import annotations

from dataclasses import dataclass

import pandas as pd

from dincl.study import Key, Row, Study
from tissue.files.parameters import Parameters, preset
from tissue.quasi_steady.run import simulate_quasi_steady
from verification.thesis.chapter3.daha import END, wilson
from verification.thesis.chapter3.growing import until
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
    """Number of seeds of each reading; 73 give the 95 % interval of a share of 1/4 the half-width 0.1."""

    seeds: int = 73


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


def read(reading: str) -> Parameters:
    """Return the parameters of a reading, for runs to ``END``."""
    name, changes = READINGS[reading]
    return preset(name).changed({**changes, **until(END)})


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
