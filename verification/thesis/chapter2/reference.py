"""The reference of the report: the event-driven solution, with its own estimate of its error."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

import dincl
from dincl.study import Key, Row, Study
from verification.instruments.references import Known
from verification.thesis.chapter2.runs import about, position_rows, scene, timed

Floats = NDArray[np.float64]
# Greatest estimated error [length].
TOL = 1e-12
# Between two output times; the times of the scenes are among them [time].
EVERY = 0.25


@dataclass(frozen=True)
class EventReference(Known):
    """The reference of one scene; ``events`` (K,) counts the contacts made or lost until each time."""

    events: NDArray[np.int64]


def kept_times(name: str) -> Floats:
    """Return the output times of a scene, from 0 to its end."""
    return np.arange(0.0, scene(name).times[-1] + EVERY / 2, EVERY)


def study(scenes: Sequence[str]) -> Study:
    """Return one run for each scene; there is one form only."""
    return Study(
        name="reference",
        title="Reference solutions",
        key=("scene",),
        runs=tuple({"scene": name} for name in scenes),
        run=run,
    )


def run(key: Key) -> list[Row]:
    """Return the positions of a scene at its output times: one row for each time and particle."""
    times = kept_times(key["scene"])
    path, seconds = timed(scene(key["scene"]), dincl.EventDriven(TOL), times)
    rows = position_rows(path, times, dict(key) | about(path, seconds))
    # A run that failed before it could be compared has no estimate; its rows are no reference then.
    error = np.full(len(times), np.inf) if path.error is None else path.error
    count = np.searchsorted([event.t for event in path.events], times, side="right")
    stated = dict(zip(times, zip(error, count, strict=True), strict=True))
    return [dict(row) | {"error": stated[row["t"]][0], "events": int(stated[row["t"]][1])} for row in rows]


def reference(table: pd.DataFrame, name: str) -> EventReference:
    """Return the reference of a scene, from the table of ``study``."""
    mine = table[table["scene"] == name]
    one = mine[mine["particle"] == 0].sort_values("t")
    return EventReference(*stack(mine), one["error"].to_numpy(), one["events"].to_numpy())


def stack(rows: pd.DataFrame) -> tuple[Floats, Floats]:
    """Return times (K,) and positions (K, N, d) of the rows of one run."""
    t = np.unique(rows["t"].to_numpy())
    axes = [name for name in "xyz" if name in rows]
    return t, rows.sort_values(["t", "particle"])[axes].to_numpy().reshape(len(t), -1, len(axes))
