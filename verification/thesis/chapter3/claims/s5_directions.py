"""Chapter 3, section 5: what the third dimension takes."""

from __future__ import annotations

import numpy as np
import pandas as pd

from tissue.files.parameters import preset
from tissue.frames.frame import Frame
from tissue.runs.simulate import simulate
from verification.claims import Evidence, Tables, Verdict, at_least, equal
from verification.thesis.text.quoted import claim

SEED = 0
SHEET = {"tissue.dimension": 3, "tissue.cells": 100, "space.boundary": "open", "numerics.t_end": "12 h"}


def overtaken(frame: Frame, first: Frame) -> int:
    """Pairs of basal neighbours at the start whose order along x is another one now."""
    sheets = first.sheets
    i, j = sheets.basal.edges.T if sheets is not None else np.zeros((2, 0), np.int64)
    before, now = (one.cells.bx[j] - one.cells.bx[i] for one in (first, frame))
    return int((before * now < 0).sum())


@claim(
    "c3.independent-rules",
    "What is left to be done for the tissue in three dimensions.",
    "section 5",
    Verdict.CORRECTED,
)
def _rules() -> Evidence:
    run = simulate(preset("published").changed(SHEET), SEED)
    passed, sheets = overtaken(run.final, run.frames[0]), run.final.sheets
    edges, triangles = (0, 0) if sheets is None else (len(sheets.basal.edges), len(sheets.basal.triangles))
    cells = len(run.final.layers.basal)
    return Evidence(
        f"a sheet of 100 cells grows for 12 h to {cells} basal points; of those that were neighbours at the start "
        f"{passed} pairs have another order along x, which (C4) of the slice forbids. The network of neighbours, along "
        f"whose {edges} edges (C2) holds, is still a disc without crossings",
        printed=(equal("pairs of basal neighbours that have passed each other along x", passed, 0.0),),
        corrected=(equal("Euler characteristic of the basal triangulation", cells - edges + triangles, 1.0),),
        seed=SEED,
    )


def least_grown(table: pd.DataFrame) -> pd.Series:
    """The row of the kind of sheet whose height may have grown least, at the end."""
    last = table[(table["t"] == table["t"].max()) & table["layer"].str.contains("sheet")]
    return last.loc[last["height_low"].idxmin()]


@claim(
    "c3.height-in-space",
    "Tissue in three dimensions grows in height.",
    "Figure 17",
    needs=("space_heights",),
)
def _height(tables: Tables) -> Evidence:
    least = least_grown(tables["space_heights"])
    interval = (float(least["height_low"]), float(least["height_high"]))
    return Evidence(
        f"after {least['t']:g} h the height of every kind of sheet is above that of the start: of the one that grows "
        f"least, {least['layer']} of {least['cells']} cells, {least['height']:.2f} times [{least['height_low']:.2f}, "
        f"{least['height_high']:.2f}], {least['runs']} runs",
        printed=(at_least("least height over that of the start", least["height"], 1.0, interval=interval),),
        runs_needed=2,
    )
