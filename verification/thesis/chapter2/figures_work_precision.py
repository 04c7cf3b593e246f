"""The chart of speed against accuracy, from its table only."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from verification.page.sheet import GREY, Axes, sheet
from verification.thesis.chapter2.cheapest import NOT_TRIED, RESOLVED, accuracy
from verification.thesis.chapter2.methods import METHODS, Method

# Errors below this are rounding; they are drawn on the lower edge [length].
LOWEST = 1e-11
AXES = {"seconds": "seconds", "drift_evaluations": "evaluations of the drift"}


def chart(table: pd.DataFrame, scene: str, path: Path) -> Path:
    """Largest error in time against time and against counted work; runs that failed as crosses on the upper edge."""
    rows = table[table["scene"] == scene]
    lowest = max(float(np.nanmin(accuracy(rows))), LOWEST) / 3
    with sheet(path, 4.4) as figure:
        panels = figure.subplots(1, len(AXES), sharey=True)
        for panel, (work, label) in zip(panels, AXES.items(), strict=True):
            for method in [METHODS[name] for name in METHODS if name in set(rows["method"])]:
                _line(panel, rows[rows["method"] == method.name], method, work)
            _unresolved(panel, rows, lowest)
            panel.set(xlabel=label, xscale="log", yscale="log")
        panels[0].set(ylabel="largest error in time", ylim=(lowest, 10))
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=4)
    return path


def _line(panel: Axes, rows: pd.DataFrame, method: Method, work: str) -> None:
    """From coarse to fine settings; a method none of whose runs arrived has crosses, and no place in the legend."""
    rows = rows.sort_values("setting", ascending=False)
    done, failed = rows[rows["status"] == "SUCCESS"], rows[~rows["status"].isin(("SUCCESS", *NOT_TRIED))]
    look: dict[str, Any] = {"color": method.colour, "marker": method.marker, "ls": method.line}
    if method.line != "-":
        look["markerfacecolor"] = "none"
    if len(done):
        panel.plot(done[work], accuracy(done).clip(lower=LOWEST), label=method.label, **look)
    for place in failed.loc[failed[work] > 0, work]:
        panel.plot(place, 0.97, "x", color=method.colour, transform=panel.get_xaxis_transform(), markersize=6, mew=1.6)


def _unresolved(panel: Axes, rows: pd.DataFrame, lowest: float) -> None:
    """Where the reference itself is no better."""
    limit = max(RESOLVED * float(np.nanmax(rows["reference_error"])), LOWEST)
    if limit < lowest:
        return
    panel.axhspan(lowest, limit, color="#efefef", zorder=0)
    text = "rounding" if limit == LOWEST else f"not resolved: error of the reference {limit / RESOLVED:.0e}"
    top = limit / 1.2
    panel.text(0.02, top, text, transform=panel.get_yaxis_transform(), va="top", color=GREY, fontsize=7)
