"""Speed against accuracy of a growing sheet: nuclei and heights for n substeps in each dt, beside a slice.

Runs of one seed meet the same noise and the same divisions, whatever their substeps: a difference is an error.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import partial

import numpy as np
import pandas as pd

from dincl.study import Key, Row, Study
from tissue.files.parameters import preset
from tissue.frames.frame import Frame
from tissue.frames.observables import height
from tissue.runs.simulate import simulate
from tissue.state.cells import Floats
from verification.instruments.order import estimate, order_text
from verification.thesis.chapter3.intervals import over_seeds
from verification.thesis.chapter3.substeps import ENOUGH, SAFETY

TISSUES: Mapping[str, Mapping[str, object]] = {
    "free sheet": {"tissue.dimension": 3, "tissue.cells": 196, "space.boundary": "open", "tissue.two_daughters": 1},
    "slice": {},
}
KEPT = {"numerics.t_end": "10 h", "numerics.keep": ["0.2 h", "1 h", "5 h", "10 h"]}


@dataclass(frozen=True)
class SheetSubstepsForm:
    """How far the study goes: substeps, those of the reference, and number of seeds."""

    substeps: tuple[int, ...] = (5, 10, 20, 40, 80)
    reference: int = 320
    seeds: int = 8


FULL = SheetSubstepsForm()


def study(form: SheetSubstepsForm) -> Study:
    """Plan one run for each tissue and seed: all numbers of substeps, and the reference with its half."""
    runs = tuple({"tissue": name, "seed": seed} for name in TISSUES for seed in range(form.seeds))
    settings = asdict(form) | {"seeds": None}  # more seeds are more runs
    return Study("space_substeps", "Space: substeps", ("tissue", "seed"), runs, partial(compared, form=form), settings)


def compared(key: Key, form: SheetSubstepsForm) -> list[Row]:
    """Compare each number of substeps with the reference at saved times: distances of nuclei and of height."""
    exact = _grown(key, form.reference)
    rows: list[Row] = []
    for substeps in (*form.substeps, form.reference // 2):
        for frame, true in zip(_grown(key, substeps), exact, strict=True):
            error = float(np.sqrt(((_nuclei(frame) - _nuclei(true)) ** 2).sum(axis=1).mean()))
            about = {"substeps": substeps, "t": frame.t, "rms": error, "height": height(frame) / height(true) - 1.0}
            rows.append({**key, **about, "cells": len(frame.cells.x)})
    return rows


def _grown(key: Key, substeps: int) -> Sequence[Frame]:
    """Return all saved states but the start."""
    changes = {**TISSUES[key["tissue"]], **KEPT, "numerics.substeps": substeps}
    return simulate(preset("published").changed(changes), key["seed"]).frames[1:]


def _nuclei(frame: Frame) -> Floats:
    """Return the nuclei (n, 3) by the names of the cells; cells of a slice change their places."""
    order = np.argsort(frame.cells.id)
    return np.stack([getattr(frame.cells, axis)[order] for axis in "xyz"], axis=1)


def errors(table: pd.DataFrame) -> pd.DataFrame:
    """Return a row for each tissue, time and number of substeps: median error of nuclei, relative error of heights.

    ``own`` bounds the error of the reference in each, SAFETY times its difference to half as many substeps; ``enough``:
    whether the height is right to ENOUGH, with interval and the error of the reference.
    """
    rows = []
    for (name, t, substeps), mine in table.groupby(["tissue", "t", "substeps"], sort=False):
        mean, low, high = over_seeds(mine["height"])
        about = {
            "tissue": name,
            "t": t,
            "substeps": substeps,
            "rms": mine["rms"].median(),
            "cells": mine["cells"].mean(),
        }
        rows.append(about | {"height": mean, "low": low, "high": high, "runs": len(mine)})
    made = pd.DataFrame(rows)
    half = made["substeps"] == made["substeps"].max()
    for column, own in (("rms", "own"), ("height", "own_height")):
        of_half = made[half].set_index(["tissue", "t"])[column].abs()
        made[own] = SAFETY * of_half.loc[list(zip(made["tissue"], made["t"], strict=True))].to_numpy()
    made["enough"] = made[["low", "high"]].abs().max(axis=1) + made["own_height"] <= ENOUGH
    return made[~half].reset_index(drop=True)


def orders(made: pd.DataFrame) -> pd.DataFrame:
    """Return a row for each tissue and time: orders in h, and the least substeps with accurate heights."""
    rows = []
    for (name, t), mine in made.groupby(["tissue", "t"], sort=False):
        h = 1.0 / mine["substeps"]
        told = {
            "tissue": name,
            "t": t,
            "nuclei": order_text(estimate(h, mine["rms"], floor=float(mine["own"].iloc[0]))),
        }
        deviation = estimate(h, mine["height"].abs(), floor=float(mine["own_height"].iloc[0]))
        rows.append(told | {"height": order_text(deviation), "substeps": _least(mine["substeps"], mine["enough"])})
    return pd.DataFrame(rows)


def _least(substeps: pd.Series, enough: pd.Series) -> int:
    """Return the substeps from which on all heights are accurate; 0 if the finest are not."""
    fine_first = enough.iloc[substeps.argsort()[::-1]]
    right = fine_first.cummin()
    return int(substeps[right[right].index].min()) if right.any() else 0
