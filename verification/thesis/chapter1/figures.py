"""The figures of the chapter on geometry, from tables only."""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from verification.page.sheet import GREY, legend_below, sheet

# Column, label, colour, marker, line.
CONSTANTS = (
    ("measured", "measured, an upper bound", "#d55e00", "o", "none"),
    ("row", "straight row, an upper bound", "#0072b2", "", "-"),
    ("proved", "proved, a lower bound", "#009e73", "", "-"),
    ("from_gamma", "of a row, from the inverse triangle inequality", GREY, "", "-"),
    ("printed_plane", "printed, d = 2", "#cc79a7", "", "--"),
    ("printed_space", "printed, d = 3", "#cc79a7", "", ":"),
)
DISTANCES = (
    ("inclusion", "to F - N", "#009e73", "o"),
    ("sweep", "to one sweep of half-spaces", "#0072b2", "s"),
    ("tangent", "to the projection on T", "#d55e00", "^"),
)
COLOURS = ("#009e73", "#0072b2", "#d55e00", "#cc79a7", "#6f6f6f")


def constants(table: pd.DataFrame, path: Path) -> Path:
    """Draw all constants of prox-regularity against the number of discs."""
    with sheet(path, 3.6) as figure:
        panel = figure.subplots()
        for column, label, colour, marker, line in CONSTANTS:
            known = table[table[column] > 0]
            panel.loglog(known["count"], known[column], color=colour, marker=marker, linestyle=line, label=label)
        panel.set(xlabel="number N of discs of radius 1/2", ylabel="constant of prox-regularity [length]")
        ticks = table["count"].to_list()
        panel.set_xticks(ticks, [str(tick) for tick in ticks])
        panel.minorticks_off()
        figure.legend(loc="outside right center")
    return path


def consistency(steps: pd.DataFrame, settled: pd.DataFrame, shown: str, path: Path) -> Path:
    """Draw the velocity of one step of ``shown`` against dt, and of the k-th step of all against k."""
    with sheet(path, 3.8) as figure:
        left, right = figure.subplots(1, 2)
        mine = steps[steps["configuration"] == shown]
        for column, label, colour, marker in DISTANCES:
            left.loglog(mine["dt"], mine[column], color=colour, marker=marker, label=label)
        left.set(title=f"One step, {shown}", xlabel="step dt [time]", ylabel="distance of the velocity [length/time]")
        for (name, rows), colour in zip(settled.groupby("configuration", sort=False), COLOURS, strict=True):
            positive = rows[rows["tangent"] > 0]
            right.semilogy(positive["step"], positive["tangent"], color=colour, label=name)
        right.set(title="The k-th step", xlabel="k", ylabel="distance to the projection [length/time]")
        legend_below(figure, (left, right), 3)
    return path
