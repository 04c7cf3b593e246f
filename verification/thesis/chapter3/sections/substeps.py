"""Accuracy against speed of the substeps."""
# ruff: noqa: RUF001 - formulas for readers are written with Greek letters and minus signs

from __future__ import annotations

import numpy as np
import pandas as pd

from tissue.files.parameters import preset
from verification.page.report import Context, Grid, Picture, Section, Text, number
from verification.thesis.chapter3 import figures as figures_tissue
from verification.thesis.chapter3 import substeps
from verification.thesis.chapter3.growing import PRESETS
from verification.thesis.chapter3.sections.part import Part, named

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


def _run_substeps(context: Context) -> None:
    form = context.form(substeps.SHORT, substeps.FULL)
    table = substeps.study(form).complete(context.folder, context.executor)
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
    return Section(
        "Substeps: how exact, how fast",
        [
            Text(_measures(errors)),
            Text(_own_substeps(errors)),
            Picture(
                accuracy,
                "Median error over the seeds against time; hollow where the reference itself may be off by as much.",
            ),
            Text(_heights(context.tables["tissue_enough"], heights)),
            Picture(
                height,
                "Deviation of the mean height of the apical layer from the reference of the same seed: means with 95 % "
                "intervals; crosses: runs that were lost. The band is 1 %.",
            ),
            Grid(named(context.tables["tissue_enough"], ENOUGH), "Heights within 1 %; 0: none tried.", "tissue_enough"),
            Grid(named(context.tables["tissue_orders"], ORDERS), "Orders of nuclei", "tissue_orders", folded=True),
            Grid(named(errors, ERRORS), "All errors", "tissue_errors", folded=True),
            Grid(named(heights, HEIGHTS), "All heights", "tissue_heights", folded=True),
        ],
    )


def _measures(errors: pd.DataFrame) -> str:
    late = errors[(errors["t"] == substeps.TIMED) & (errors["lost"] == 0)]
    far = {name: (mine["rms"] / mine["relative"]).median() for name, mine in late.groupby("preset")}
    return (
        "Runs of one seed meet the same noise and the same divisions whatever their substeps, so that a difference is "
        "an error. The reference has four times as many substeps as the finest run; its own error is stated as "
        f"{substeps.SAFETY:g} times its distance to half as many. Given are the root mean square over the nuclei, in "
        "R_soft, and the relative distance |X − Y|/|Y| of the thesis. The latter depends on where the origin is: it is "
        f"the former over the distance of the nuclei from the origin, here {number(far['thesis'])} R_soft at "
        f"{substeps.TIMED:g} h, so that 6 % are {number(0.06 * far['thesis'])} R_soft (thesis preset)."
    )


def _own_substeps(errors: pd.DataFrame) -> str:
    parts = []
    for name in PRESETS:
        own = preset(name).numbers().substeps
        mine = errors[(errors["preset"] == name) & (errors["substeps"] == own)].set_index("t")
        early, late = mine.loc[1.0], mine.loc[substeps.TIMED]
        parts.append(
            f"{name}, {own} substeps: {number(early['rms'])} at 1 h, {number(late['rms'])} at 10 h (relative "
            f"{number(late['relative'])}), in {number(1e3 * late['seconds'])} ms"
        )
    lost = errors[(errors["lost"] > 0) & (errors["t"] == substeps.TIMED)].groupby("preset")["substeps"].max()
    failed = ", ".join(f"{name} up to {count}" for name, count in lost.items())
    return f"Median errors: {'; '.join(parts)}. Too few substeps throw cells out of the tissue within 10 h: {failed}."


def _heights(enough: pd.DataFrame, heights: pd.DataFrame) -> str:
    parts = []
    for row in enough.sort_values(["preset", "t"], ascending=[False, True]).itertuples():
        least = f"from {row.substeps} substeps on" if row.substeps else f"with none tried, up to {row.finest}"
        parts.append(f"{row.preset}, {row.t:g} h: {least}")
    told = "; ".join(f"{name} {_off(heights, name)}" for name in PRESETS)
    return (
        f"The height is right to {100 * substeps.ENOUGH:g} %, with 95 % confidence over {heights['runs'].max()} seeds "
        f"and with the error of the reference on top: {'; '.join(parts)}. With its own substeps each preset is off at "
        f"{heights['t'].max():g} h by: {told}."
    )


def _off(heights: pd.DataFrame, name: str) -> str:
    """The deviation of the last height with the substeps of the preset."""
    own = (heights["preset"] == name) & (heights["substeps"] == preset(name).numbers().substeps)
    row = heights[own & (heights["t"] == heights["t"].max())].iloc[0]
    mean, low, high = (f"{100 * row[name]:.1f}".replace("-0.0", "0.0") for name in ("deviation", "low", "high"))
    return f"{mean} % [{low}, {high}]"


PART = Part(_run_substeps, _substeps)
