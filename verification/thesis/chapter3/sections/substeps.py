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
from verification.thesis.chapter3.sections.part import PROSE, Part, named

ORDERS = {"preset": "Preset", "t": "t [h]", "order": "Order in h [95 %]", "verdict": "In words"}
ENOUGH = {
    "preset": "Preset",
    "t": "t [h]",
    "substeps": "Substeps from which on within 1 %",
    "finest": "Finest tried",
    "order": "Order in h of the deviation",
}
ERRORS = {
    "preset": "Preset",
    "substeps": "Substeps",
    "t": "t [h]",
    "rms": "Error of nuclei [R_soft]",
    "relative": "Relative",
    "largest": "Largest of the seeds",
    "own": "Error of the reference",
    "seconds": "Seconds for 10 h",
    "lost": "Lost",
    "runs": "Runs",
}
TITLE = "Substeps: how exact, how fast"
HEIGHTS = {
    "preset": "Preset",
    "t": "t [h]",
    "substeps": "Substeps",
    "height": "Height [R_soft]",
    "deviation": "Off by the part",
    "low": "from",
    "high": "to",
    "own": "Error of the reference",
    "lost": "Lost",
}

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
            Text(said["measures"]),
            Text(said["own"]),
            Picture(accuracy, said["accuracy"]),
            Text(said["heights"]),
            Picture(height, said["deviation"]),
            Grid(named(context.tables["tissue_enough"], ENOUGH), said["within"], "tissue_enough"),
            Grid(named(context.tables["tissue_orders"], ORDERS), said["orders"], "tissue_orders", folded=True),
            Grid(named(errors, ERRORS), said["errors"], "tissue_errors", folded=True),
            Grid(named(heights, HEIGHTS), said["all_heights"], "tissue_heights", folded=True),
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
    """The errors of a preset with its own substeps."""
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
    """The last height with the substeps of the preset."""
    own = (heights["preset"] == name) & (heights["substeps"] == preset(name).numbers().substeps)
    row: dict[str, Any] = heights[own & (heights["t"] == heights["t"].max())].iloc[0].to_dict()
    return row


PART = Part(_run_substeps, _substeps)
