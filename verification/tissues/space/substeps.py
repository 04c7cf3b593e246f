"""Accuracy of substeps in a growing sheet, beside a slice: as ``chapter3.substeps`` has it for slices."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from dincl.study import Key, Row, Study
from tissue.files.parameters import preset
from tissue.frames.frame import Frame
from tissue.frames.observables import height
from tissue.runs.simulate import simulate
from tissue.state.cells import Floats
from verification.thesis.chapter3.substeps import COLUMNS

SUBSTEPS, REFERENCE, SEEDS = (5, 10, 20, 40, 80), 320, 8
TISSUES: Mapping[str, Mapping[str, object]] = {
    "free sheet": {"tissue.dimension": 3, "tissue.cells": 196, "space.boundary": "open", "tissue.two_daughters": 1},
    "slice": {},
}
KEPT = {"numerics.t_end": "10 h", "numerics.keep": ["0.2 h", "1 h", "5 h", "10 h"]}


def study(smallest: bool = False) -> Study:
    """Return one run for each tissue and seed: all numbers of substeps, and the reference with its half."""
    tissues, seeds = (("slice",), 1) if smallest else (tuple(TISSUES), SEEDS)
    runs = tuple({"tissue": name, "seed": seed} for name in tissues for seed in range(seeds))
    settings = {"substeps": SUBSTEPS, "reference": REFERENCE, "tissues": TISSUES, "kept": KEPT}
    key, by = ("tissue", "seed"), ("substeps", "t")
    return Study("space_substeps", "Space: substeps", key, runs, compared, settings, COLUMNS, by)


def compared(key: Key) -> list[Row]:
    """Return a row for each number of substeps and time: distance of the nuclei to the reference, that of heights."""
    exact = _grown(key, REFERENCE)
    rows: list[Row] = []
    for substeps in (*SUBSTEPS, REFERENCE // 2):
        for frame, true in zip(_grown(key, substeps), exact, strict=True):
            error = float(np.sqrt(((_nuclei(frame) - _nuclei(true)) ** 2).sum(axis=1).mean()))
            about = {"substeps": substeps, "t": frame.t, "rms": error, "deviation": height(frame) / height(true) - 1.0}
            rows.append({**key, **about, "cells": len(frame.cells.x)})
    return rows


def _grown(key: Key, substeps: int) -> tuple[Frame, ...]:
    """Return all saved states but the start."""
    changes = {**TISSUES[key["tissue"]], **KEPT, "numerics.substeps": substeps}
    return simulate(preset("published").changed(changes), key["seed"]).frames[1:]


def _nuclei(frame: Frame) -> Floats:
    """Return the nuclei (n, 3) by the names of the cells; cells of a slice change their places."""
    order = np.argsort(frame.cells.id)
    return np.stack([getattr(frame.cells, axis)[order] for axis in "xyz"], axis=1)
