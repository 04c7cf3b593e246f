"""The scenes of the chart of speed against accuracy, and the study of the solutions that errors are measured against.

Exact solutions where there are any, otherwise the event-driven scheme, whose error estimate is stated. Midpoint
catch-up with ever shorter steps around each contact, which shares neither steps nor the search for events with it, came
to the same states of the pile of a thousand discs within 2.5e-9.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray

import dincl
from dincl.scenes import Scene
from dincl.study import Key, Row, Study
from verification.instruments import references
from verification.instruments.budget import CpuSeconds
from verification.instruments.references import Known
from verification.site.store import shipped


class ChartedScene(NamedTuple):
    """A scene, the error of its reference [length], the times of errors (between two, the last), and the budget."""

    make: Callable[[], Scene]
    tol: float
    times: tuple[float, float]
    budget: CpuSeconds

    @property
    def t(self) -> NDArray[np.float64]:
        """The times at which errors are looked at; those of the scene are among them."""
        every, end = self.times
        return np.linspace(0.0, end, round(end / every) + 1)[1:]


# Tighter than that of any method on the chart.
TIGHT, LONG, SHORT = 1e-13, CpuSeconds(5.0), CpuSeconds(1.0)
SCENES: Mapping[str, ChartedScene] = {
    "sliding_disc": ChartedScene(dincl.scenes.sliding_disc, TIGHT, (0.05, 3.0), LONG),
    "stack": ChartedScene(dincl.scenes.stack, TIGHT, (0.05, 1.5), LONG),
    "four_disks": ChartedScene(dincl.scenes.four_disks, TIGHT, (0.05, 2.0), LONG),
    "ten_disks_corner": ChartedScene(dincl.scenes.ten_disks_corner, TIGHT, (0.05, 3.0), LONG),
    "ball_pile_30": ChartedScene(partial(dincl.scenes.ball_pile, 30), TIGHT, (0.05, 2.0), LONG),
    "pile_100": ChartedScene(partial(dincl.scenes.pile, 100), 1e-12, (0.1, 1.0), SHORT),
    "pile_300": ChartedScene(partial(dincl.scenes.pile, 300), 1e-11, (0.1, 1.0), SHORT),
    "pile_1000": ChartedScene(partial(dincl.scenes.pile, 1000), 1e-11, (0.1, 1.0), LONG),
}
SMALL = tuple(SCENES)[:4]


def study(smallest: bool = False) -> Study:
    """Return the study: the reference of a scene is a run; in the smallest form those of the small scenes."""
    runs = tuple({"scene": name} for name in reversed(SMALL if smallest else tuple(SCENES)))
    title = "References of the chart of speed against accuracy"
    return Study("work_references", title, ("scene",), runs, run, by=("t", "particle"))


def run(key: Key) -> list[Row]:
    """Return one row for each time and particle: its coordinates, and the stated error at that time."""
    charted = SCENES[key["scene"]]
    known = references.reference(charted.make(), charted.tol)(charted.t)
    return [
        {**key, "t": t, "particle": i, "error": error} | dict(zip("xyz", (*x, np.nan, np.nan), strict=False))
        for t, state, error in zip(known.t, known.x, known.error, strict=True)
        for i, x in enumerate(state)
    ]


def known(name: str) -> Known:
    """Return the reference of a scene as it ships."""
    return stacked(shipped("work_references").query("scene == @name"))


def stacked(table: pd.DataFrame) -> Known:
    """Return positions with their error at each time; the columns that hold numbers are the axes of the scene."""
    ordered = table.sort_values(["t", "particle"])
    t = np.unique(ordered["t"].to_numpy())
    axes = [name for name in "xyz" if name in ordered and ordered[name].notna().all()]
    x = ordered[axes].to_numpy().reshape(len(t), -1, len(axes))
    return Known(t, x, ordered["error"].to_numpy().reshape(len(t), -1).max(axis=1))
