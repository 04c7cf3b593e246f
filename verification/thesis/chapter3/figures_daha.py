"""The figures of DAHA and of catch-up, from tables only."""
# ruff: noqa: RUF001 - labels for readers are written with Greek letters

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from verification.instruments.charts import draw_outcomes, edges, outcome_handles
from verification.instruments.outcome import Outcome
from verification.page.sheet import GREY, Axes, legend_below, sheet
from verification.thesis.chapter3 import daha_limits
from verification.thesis.chapter3.daha import DOUBLED_CASE, PBD_SUBSTEPS, TERMINATING
from verification.thesis.chapter3.daha_limits import OUTCOMES

Floats = NDArray[np.float64]
CASES = {TERMINATING: ("#0072b2", "α of Table 4"), DOUBLED_CASE: ("#d55e00", "α doubled, as (3.26) has it")}
# Drawn as the outcome of the other maps that comes nearest to it.
LIKE = (Outcome.CONVERGED, Outcome.INFEASIBLE, Outcome.NOT_TERMINATED, Outcome.UNSTABLE)
DRAWN = {word: outcome.value for word, outcome in zip(OUTCOMES, LIKE, strict=True)}
METHODS = {"PBD": "#d55e00", "LinearisedCatchUp": "#0072b2", "MidpointCatchUp": "#009e73"}
# The range of iterations that Figure 11 is about.
ITERATIONS = np.geomspace(1e2, 1e5, 60)


def iterations(table: pd.DataFrame, case: str, path: Path) -> Path:
    """Draw Figure 11: iterations per step for each tolerance, and where the runs ended that did not terminate."""
    mine = table[(table["kind"] == "step") & (table["case"] == case)]
    with sheet(path, 3.0) as figure:
        left, right = figure.subplots(1, 2)
        for (eps, rows), colour in zip(mine.groupby("eps"), ("#009e73", "#0072b2", "#d55e00"), strict=False):
            done = rows["terminated"].astype(bool)
            label = f"ε = {eps:.0e}"
            left.hist(rows.loc[done, "iterations"], ITERATIONS, color=colour, alpha=0.5, label=label)
            right.semilogy(rows.loc[done, "t"], rows.loc[done, "iterations"], ".", color=colour, markersize=3)
            right.semilogy(rows.loc[~done, "t"], rows.loc[~done, "iterations"], "x", color=colour)
        left.set(xscale="log", xlabel="iterations in a step", ylabel="steps", title="Steps that terminated")
        right.set(xlabel="time [h]", ylabel="iterations in a step", title="In time; crosses: not terminated")
        legend_below(figure, [left], 3)
    return path


def damping(table: pd.DataFrame, fits: pd.DataFrame, path: Path) -> Path:
    """Draw the distance of nuclei and the heights of PBD against mu, means with intervals; dashed: the best fit."""
    few = min(PBD_SUBSTEPS)
    last = table["t"].max()
    shown = table[(table["kind"] == "pbd") & (table["t"] == last) & (table["substeps"] == few)]
    with sheet(path, 3.3) as figure:
        left, right = figure.subplots(1, 2)
        for case, (colour, label) in CASES.items():
            mine = shown[shown["case"] == case].sort_values("mu")
            _with_intervals(left, mine, ("relative", "low", "high"), colour, label)
            _with_intervals(right, mine, ("height", "height_low", "height_high"), colour, label)
            fit = fits[(fits["case"] == case) & (fits["t"] == last) & (fits["substeps"] == few)]
            for panel, column in ((left, "mu"), (right, "equal")):
                for mu in fit[column].dropna():
                    panel.axvline(mu, color=colour, linestyle="--", linewidth=0.9)
        right.axhline(0.0, color=GREY, linewidth=0.9)
        ticks = sorted(set(shown["mu"]) - {0.1333, 0.15})
        for panel in (left, right):
            panel.set(xscale="log", xlabel="μ of PBD [h]")
            panel.set_xticks(ticks, [f"{mu:g}" for mu in ticks])
            panel.minorticks_off()
        left.set(title="Nuclei: distance to DAHA [%]", ylim=(0, None))
        right.set_title("Height above that of DAHA [%]")
        legend_below(figure, [right], 2)
    return path


def _with_intervals(panel: Axes, rows: pd.DataFrame, names: tuple[str, str, str], colour: str, label: str) -> None:
    mean, low, high = (100 * rows[name].to_numpy() for name in names)
    reach = np.array([mean - low, high - mean])
    panel.errorbar(rows["mu"], mean, reach, color=colour, marker="o", label=label, elinewidth=1.0, capsize=2)


def limits(tables: dict[str, pd.DataFrame], path: Path) -> Path:
    """Draw the outcome of one step over (alpha, beta) and (gamma, c), and the linear limit of alpha."""
    seed = min(min(table["method"]) for table in tables.values())
    style = {"axes.grid": False, "axes.spines.top": True, "axes.spines.right": True}
    with sheet(path, 3.9, **style) as figure:
        panels = figure.subplots(1, len(daha_limits.PLANES))
        for panel, plane in zip(panels, daha_limits.PLANES, strict=True):
            mine = tables[plane.name]
            mine = mine[mine["method"] == seed]
            x, y = (edges(np.sort(mine[name].unique()), logarithmic=True) for name in "xy")
            words = mine.assign(word=mine["outcome"].map(DRAWN)).pivot(index="y", columns="x", values="word")
            draw_outcomes(panel, x, y, words.to_numpy())
            panel.set(xscale="log", yscale="log", xlabel=plane.x.label, ylabel=plane.y.label, title=plane.title)
            panel.plot(1.0, 1.0, "o", color="#22262b", markersize=5)
            if plane is daha_limits.PLANES[0]:
                panel.axvline(mine["limit"].iloc[0], color="#22262b", linewidth=1.4)
        line, dot = panels[0].lines[1], panels[0].lines[0]
        names = [*DRAWN, "linear limit", "Table 4"]
        figure.legend([*outcome_handles(DRAWN.values()), line, dot], names, loc="outside lower center", ncols=6)
    return path


def catch_up(made: pd.DataFrame, path: Path) -> Path:
    """Draw the error of the nuclei after dt against the steps in dt, and against the seconds."""
    with sheet(path, 3.4) as figure:
        left, right = figure.subplots(1, 2, sharey=True)
        for method, colour in METHODS.items():
            mine = made[made["method"] == method].sort_values("steps")
            left.loglog(mine["steps"], mine["rms"], "o-", color=colour, label=method)
            right.loglog(1e3 * mine["seconds"], mine["rms"], "o-", color=colour, label=method)
        own, least = made["own"].iloc[0], made["least"].iloc[0]
        for panel in (left, right):
            panel.axhline(own, color=GREY, linewidth=0.9, linestyle=":", label="own error of the reference")
        left.axvline(least, color=GREY, linewidth=0.9, linestyle="--", label="linear limit of explicit Euler")
        left.set(xlabel="steps in dt", ylabel="error of the nuclei [R_soft]", title="Accuracy")
        right.set(xlabel="milliseconds for dt", title="Work and precision")
        handles, labels = left.get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=5)
    return path
