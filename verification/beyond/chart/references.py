"""The scenes of the chart of speed against accuracy, and what their errors are measured against.

Exact solutions where there are any; otherwise the event-driven scheme, whose error estimate is stated. For the pile of
a thousand discs it is a table that was computed once.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

import dincl
from dincl.scenes import Scene
from dincl.study import Key, Row, Study, digest, read_sealed
from verification.instruments import references
from verification.instruments.references import Known
from verification.page.kept import DATA

Floats = NDArray[np.float64]
SCENES: Mapping[str, Callable[[], Scene]] = {
    "sliding_disc": dincl.scenes.sliding_disc,
    "stack": dincl.scenes.stack,
    "four_disks": dincl.scenes.four_disks,
    "ten_disks_corner": dincl.scenes.ten_disks_corner,
    "ball_pile_30": partial(dincl.scenes.ball_pile, 30),
    "pile_1000": partial(dincl.scenes.pile, 1000),
}
# Between two times at which errors are looked at, where the reference does not say; the times of the scenes are among
# them [time].
EVERY = 0.05
# Tighter than that of any method on the chart.
TOL = 1e-13
# Of t, particle, the coordinates and error; made by ``pile_reference``.
FILES = {"pile_1000": DATA / "pile_1000.parquet"}


def study(scenes: Sequence[str] = tuple(SCENES)) -> Study:
    """Return the references of the scenes; one run for each."""
    return Study(
        name="work_references",
        title="References of the chart of speed against accuracy",
        key=("scene",),
        runs=tuple({"scene": name} for name in reversed(scenes)),
        run=rows,
        settings={"files": {name: digest(path.read_bytes()) for name, path in FILES.items() if name in scenes}},
    )


def rows(key: Key) -> list[Row]:
    """Return one row for each time and particle."""
    name = key["scene"]
    return _rows(name, _from_file(FILES[name]) if name in FILES else _computed(SCENES[name]()))


def _rows(name: str, known: Known) -> list[Row]:
    return [
        {"scene": name, "t": t, "particle": i, "error": error} | dict(zip("xyz", x, strict=False))
        for t, state, error in zip(known.t, known.x, known.error, strict=True)
        for i, x in enumerate(state)
    ]


def reference(table: pd.DataFrame, name: str) -> Known:
    """Return the reference of a scene, from the table of ``study``."""
    return stacked(table[table["scene"] == name])


def _computed(scene: Scene) -> Known:
    end = scene.times[-1]
    return references.reference(scene, TOL)(np.linspace(0.0, end, round(end / EVERY) + 1)[1:])


def _from_file(path: Path) -> Known:
    return stacked(read_sealed(path))


def stacked(table: pd.DataFrame) -> Known:
    """Return positions with their error at each time; the columns that hold numbers are the axes of the scene."""
    ordered = table.sort_values(["t", "particle"])
    t = np.unique(ordered["t"].to_numpy())
    axes = [name for name in "xyz" if name in ordered and ordered[name].notna().all()]
    x = ordered[axes].to_numpy().reshape(len(t), -1, len(axes))
    return Known(t, x, ordered["error"].to_numpy().reshape(len(t), -1).max(axis=1))
