"""The figure of speed against accuracy on frozen tissues in space, from a table only."""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from verification.page.sheet import GREY, sheet
from verification.thesis.chapter3.figures_daha import METHODS


def catch_up(made: pd.DataFrame, path: Path) -> Path:
    """Error of the nuclei after dt against the steps in it, and against the evaluations of the forces."""
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
