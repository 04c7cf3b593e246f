"""Figures of speed against accuracy in space, from tables only: frozen tissues, and growing ones."""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from verification.page.sheet import GREY, sheet
from verification.thesis.chapter3.figures_daha import METHODS

TISSUES = {"free sheet": "#2e78b7", "slice": "0.25"}
MARKS = "o^sD"


def catch_up(made: pd.DataFrame, path: Path) -> Path:
    """Draw the error of nuclei after dt against the steps in it and against the evaluations of the forces."""
    with sheet(path, 3.4) as figure:
        left, right = figure.subplots(1, 2, sharey=True)
        for method, colour in METHODS.items():
            mine = made[made["method"] == method].sort_values("steps")
            left.loglog(mine["steps"], mine["rms"], "o-", color=colour, label=method)
            right.loglog(mine["calls"], mine["rms"], "o-", color=colour, label=method)
        own, least = made["own"].iloc[0], made["least"].iloc[0]
        for panel in (left, right):
            panel.axhline(own, color=GREY, linewidth=0.9, linestyle=":", label="own error of the reference")
        left.axvline(least, color=GREY, linewidth=0.9, linestyle="--", label="linear limit of explicit Euler")
        left.set(xlabel="steps in dt", ylabel="error of the nuclei [R_soft]", title="Accuracy")
        right.set(xlabel="evaluations of the forces in dt", title="Work and precision")
        handles, labels = left.get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=5)
    return path


def substeps(made: pd.DataFrame, path: Path) -> Path:
    """Draw errors of nuclei and of heights against the substeps in dt, for each time."""
    with sheet(path, 3.8) as figure:
        left, right = figure.subplots(1, 2)
        for tissue, colour in TISSUES.items():
            for (t, mine), mark in zip(made[made["tissue"] == tissue].groupby("t"), MARKS, strict=False):
                look = {"color": colour, "marker": mark, "markersize": 4, "linewidth": 0.9}
                left.loglog(mine["substeps"], mine["rms"], label=f"{tissue}, {t:g} h", **look)
                left.axhline(mine["own"].iloc[0], color=colour, linewidth=0.5, linestyle=":")
            last = made[(made["tissue"] == tissue) & (made["t"] == made["t"].max())]
            ends = 100 * abs(last[["low", "high"]].to_numpy().T - last["height"].to_numpy())
            right.errorbar(last["substeps"], 100 * last["height"], yerr=ends, color=colour, fmt="D-", label=tissue)
        right.axhspan(-1.0, 1.0, color="0.93", zorder=0)
        right.set_xscale("log")
        for panel in (left, right):
            panel.minorticks_off()
            panel.set_xticks(made["substeps"].unique(), made["substeps"].unique())
        left.set(xlabel="substeps in dt", ylabel="error of the nuclei [R_soft]", title="Nuclei")
        right.set(xlabel="substeps in dt", ylabel="height off by [%]", title=f"Height at {made['t'].max():g} h")
        handles, labels = left.get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=4)
    return path
