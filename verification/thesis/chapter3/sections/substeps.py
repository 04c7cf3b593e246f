"""Accuracy against speed of the substeps."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd

from tissue.files.parameters import preset
from verification.page.context import Context
from verification.page.parts import Follows, Grid, Picture, Section, Text
from verification.page.prose import fill
from verification.thesis.chapter3 import figures as figures_tissue
from verification.thesis.chapter3 import substeps
from verification.thesis.chapter3.growing import PRESETS
from verification.thesis.chapter3.sections.part import COLUMNS, PROSE, Part, named

TITLE = "How exact and how fast are substeps?"

# Made again beside the complete study: one seed to 5 h.
AGAIN = replace(substeps.FULL, seeds=1, times=substeps.TIMES[:4])


def _run_substeps(context: Context) -> None:
    form = context.form(substeps.FULL)
    table = context.rows_of(substeps.study(form), substeps.study(AGAIN), ("substeps", "t"))
    errors, heights = substeps.errors(table), substeps.heights(table, form.heights)
    context.keep("tissue_errors", errors)
    context.keep("tissue_orders", substeps.orders(errors))
    context.keep("tissue_heights", heights)
    context.keep("tissue_enough", substeps.enough(heights))


def _substeps(context: Context) -> Section:
    errors, heights, distances = (context.tables[f"tissue_{name}"] for name in ("errors", "heights", "distances"))
    noise = distances[np.isinf(distances["size"])]
    accuracy = context.draw("tissue_accuracy", figures_tissue.accuracy, errors, noise)
    height = context.draw("tissue_heights", figures_tissue.heights, heights)
    said = fill(PROSE / "substeps.html", **_errors(errors), **_heights(context.tables["tissue_enough"], heights))
    return Section(
        TITLE,
        [
            Text(said["heights"]),
            Picture(height, said["deviation"]),
            Text(said["own"]),
            Picture(accuracy, said["accuracy"]),
            Text(said["measures"]),
            Grid(named(context.tables["tissue_enough"], COLUMNS["enough"]), said["within"], "tissue_enough"),
            Grid(
                named(context.tables["tissue_orders"], COLUMNS["orders"]), said["orders"], "tissue_orders", folded=True
            ),
            Grid(named(errors, COLUMNS["errors"]), said["errors"], "tissue_errors", folded=True),
            Grid(named(heights, COLUMNS["heights"]), said["all_heights"], "tissue_heights", folded=True),
            Follows(said["follows"]),
        ],
    )


def _errors(errors: pd.DataFrame) -> dict[str, Any]:
    late = errors[(errors["t"] == substeps.TIMED) & (errors["lost"] == 0)]
    far = {name: (mine["rms"] / mine["relative"]).median() for name, mine in late.groupby("preset")}
    lost = errors[(errors["lost"] > 0) & (errors["t"] == substeps.TIMED)].groupby("preset")["substeps"].max()
    return {
        "safety": substeps.SAFETY,
        "timed": substeps.TIMED,
        "far": far["thesis"],
        "own": [_own_error(errors, name) for name in PRESETS],
        "lost": list(lost.items()),
    }


def _own_error(errors: pd.DataFrame, name: str) -> dict[str, Any]:
    """Return the errors of a preset with its own substeps."""
    own = preset(name).numbers().substeps
    mine = errors[(errors["preset"] == name) & (errors["substeps"] == own)].set_index("t")
    late = mine.loc[substeps.TIMED]
    return {
        "preset": name,
        "substeps": own,
        "early": mine.loc[1.0, "rms"],
        "late": late["rms"],
        "relative": late["relative"],
        "seconds": late["seconds"],
    }


def _heights(enough: pd.DataFrame, heights: pd.DataFrame) -> dict[str, Any]:
    return {
        "enough": substeps.ENOUGH,
        "seeds": heights["runs"].max(),
        "reached": list(enough.sort_values(["preset", "t"], ascending=[False, True]).itertuples()),
        "end": heights["t"].max(),
        "off": [_off(heights, name) for name in PRESETS],
    }


def _off(heights: pd.DataFrame, name: str) -> dict[str, Any]:
    """Return the last height with the substeps of the preset."""
    own = (heights["preset"] == name) & (heights["substeps"] == preset(name).numbers().substeps)
    row: dict[str, Any] = heights[own & (heights["t"] == heights["t"].max())].iloc[0].to_dict()
    return row


PART = Part(_run_substeps, _substeps)
