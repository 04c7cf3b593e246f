"""Growth of the height for several dampings."""

from __future__ import annotations

import pandas as pd

from verification.page.report import Context, Grid, Picture, Section, Text, number
from verification.thesis.chapter3 import figures as figures_tissue
from verification.thesis.chapter3 import growth
from verification.thesis.chapter3.growing import PRESETS
from verification.thesis.chapter3.sections.part import Part, named

RATIOS = {
    "preset": "Preset",
    "mu": "μ [h]",
    "substeps": "Substeps",
    "ratio": "Height at 48 h / at the start",
    "low": "from",
    "high": "to",
    "least": "Least",
    "largest": "Largest",
    "runs": "Runs",
    "lost": "Lost",
}
DOUBLING = {"preset": "Preset", "kind": "Substeps", "mu": "μ that doubles the height [h]", "low": "from", "high": "to"}


def _run_growth(context: Context) -> None:
    table = growth.study(context.form(growth.SHORT, growth.FULL)).complete(context.folder, context.executor)
    context.tables["tissue_growth"] = table
    context.keep("tissue_ratios", growth.ratios(table))
    context.keep("tissue_doubling", growth.doubling(table))


def _growth(context: Context) -> Section:
    table, ratios, doubling = (context.tables[f"tissue_{name}"] for name in ("growth", "ratios", "doubling"))
    picture = context.draw("tissue_growth", figures_tissue.growth, table, growth.fine(table))
    return Section(
        "Growth of the height",
        [
            Text(_doubles(doubling, ratios, table["t"].max())),
            Picture(
                picture,
                "Mean height of the apical layer (Figures 14 to 16); bands from the least to the largest of the seeds. "
                "A cross: from here on runs are lost.",
            ),
            Grid(named(doubling, DOUBLING), "Damping that doubles the height, 95 % intervals.", "tissue_doubling"),
            Grid(named(ratios, RATIOS), "Growth in 48 h, means with 95 % intervals.", "tissue_ratios"),
        ],
    )


def _doubles(doubling: pd.DataFrame, ratios: pd.DataFrame, end: float) -> str:
    told = "; ".join(
        f"{row.preset}, substeps {row.kind}: μ = {number(row.mu)} [{number(row.low)}, {number(row.high)}] h"
        for row in doubling.sort_values("preset", ascending=False).itertuples()
    )
    lost = ratios[ratios["lost"] > 0].sort_values("mu")
    failed = "; ".join(
        f"{row.preset}, μ = {row.mu:g} h, {row.substeps} substeps: {row.lost} of {row.runs}"
        for row in lost.itertuples()
    )
    return (
        f"The height doubles within {end:g} h at: {told}. {_beside_the_thesis(doubling, ratios)}"
        + (f"Runs lost, their cells thrown out: {failed}. " if failed else "")
        + "A smaller μ means a larger h/μ, so that substeps that are enough for one damping are not for another: the "
        "fine runs keep h/μ below a bound."
    )


def _beside_the_thesis(doubling: pd.DataFrame, ratios: pd.DataFrame) -> str:
    """Which preset behaves as Figures 14 to 16 do; nothing if none comes near a doubling."""
    least, most = ratios["mu"].min(), ratios["mu"].max()
    if doubling["mu"].isna().all():
        return ""
    nearest = doubling.loc[(doubling["mu"] / least - 1).abs().idxmin(), "preset"]
    slow = ratios[ratios["mu"] == most].groupby("preset")["ratio"].last()
    grown = ", ".join(f"{name} {slow[name]:.2f}" for name in PRESETS)
    return (
        f"The thesis has it double at μ = {least:g} (Figure 16) and grow by less than half with the other method, "
        f"which is like μ = {most:g} (Figures 14, 15): the {nearest} preset comes nearest to that (at μ = {most:g} "
        f"heights are multiplied by: {grown}). "
    )


PART = Part(_run_growth, _growth)
