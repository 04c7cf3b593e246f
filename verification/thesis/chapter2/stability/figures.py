"""The figures of the stability chapter, from tables only."""

from __future__ import annotations

import math
from collections.abc import Iterable
from pathlib import Path
from textwrap import fill
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from verification.instruments.charts import draw_outcomes, edges, outcome_handles
from verification.page import cards
from verification.page.sheet import GREY, NOTE, Axes, Figure, polygon, sheet
from verification.thesis.chapter2.stability.contestants import CONTESTANTS
from verification.thesis.chapter2.stability.decades import METHODS
from verification.thesis.chapter2.stability.outcome import FAR, OVERLAP, WORDS
from verification.thesis.chapter2.stability.plane import Plane

Floats = NDArray[np.float64]
LINES = ("-", "--", ":", "-.")
INK = "#22262b"
MOST_COLUMNS = 4
# So few heights are all written beside the axis.
FEW = 7
# Letters of a line of a title, and the units of axes; the others are numbers without one.
TITLE_LETTERS = 20
UNITS = {"step dt": "time", "rate k": "1/time", "speed of a jaw": "length/time", "half distance c": "length"}


def plane(table: pd.DataFrame, drawn: Plane, path: Path) -> Path:
    """Draw one panel for each method: the outcome of every cell, and the limits of theory as lines."""
    columns = min(MOST_COLUMNS, len(drawn.methods))
    rows = math.ceil(len(drawn.methods) / columns)
    with sheet(path, 2.2 * rows + 0.8, **{"axes.grid": False, "axes.spines.top": True}) as figure:
        panels = np.atleast_2d(figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False))
        for panel, (method, label) in zip(panels.flat, drawn.methods.items(), strict=False):
            _cells(panel, table[table["method"] == method], drawn)
            _lines(panel, method, drawn)
            panel.set_title(fill(label, TITLE_LETTERS))
        for panel in panels.flat[len(drawn.methods) :]:
            panel.set_axis_off()
        for panel in panels[:, 0]:
            panel.set_ylabel(_with_unit(drawn.y.label))
        for panel in list(panels.flat)[max(0, len(drawn.methods) - columns) : len(drawn.methods)]:
            panel.set_xlabel(_with_unit(drawn.x.label))
            panel.tick_params(labelbottom=True)
        _legend(figure, panels.flat[: len(drawn.methods)])
    return path


def card(table: pd.DataFrame, drawn: Plane, method: str, path: Path) -> Path:
    """Draw the map of one method for the first page."""
    with cards.card(path) as panel:
        _cells(panel, table[table["method"] == method], drawn)
        _lines(panel, method, drawn)
        panel.set(xlabel=_with_unit(drawn.x.label), ylabel=_with_unit(drawn.y.label), title=drawn.methods[method])
    return path


def _with_unit(label: str) -> str:
    return f"{label} [{UNITS[label]}]" if label in UNITS else label


def _cells(panel: Axes, rows: pd.DataFrame, drawn: Plane) -> None:
    x, y = (np.array(sorted(rows[name].unique())) for name in ("x", "y"))
    outcomes = rows.pivot(index="y", columns="x", values="outcome").loc[y, x].to_numpy()
    wide, high = edges(x, drawn.x.logarithmic), edges(y, drawn.y.logarithmic)
    draw_outcomes(panel, wide, high, outcomes)
    panel.set(xlim=(wide[0], wide[-1]), ylim=(high[0], high[-1]))
    panel.set_xscale("log" if drawn.x.logarithmic else "linear")
    panel.set_yscale("log" if drawn.y.logarithmic else "linear")
    if len(y) <= FEW:
        panel.set_yticks(y, [f"{value:g}" for value in y])
        panel.set_yticks([], minor=True)


def _lines(panel: Axes, method: str, drawn: Plane) -> None:
    low, high = panel.get_ylim()
    heights = np.geomspace(low, high, 200) if drawn.y.logarithmic else np.linspace(low, high, 200)
    for line, look in zip(drawn.lines, LINES, strict=False):
        if method in line.methods and line.x is None:
            panel.axhline(line.height, color=INK, linewidth=1.2, label=line.label, linestyle=look)
        elif method in line.methods and line.x is not None:
            panel.plot(line.x(heights), heights, color=INK, linewidth=1.2, label=line.label, linestyle=look)


def _legend(figure: Figure, panels: Iterable[Axes]) -> None:
    panels = list(panels)
    figure.legend(outcome_handles(WORDS), list(WORDS), loc="outside lower center", ncols=len(WORDS))
    lines = {
        label: handle for panel in panels for handle, label in zip(*panel.get_legend_handles_labels(), strict=True)
    }
    if lines:
        figure.legend(lines.values(), lines.keys(), loc="outside upper right", ncols=len(lines))


def decades(table: pd.DataFrame, path: Path) -> Path:
    """Draw growth and largest overlap against six decades of dt; runs that did not end well as crosses on top."""
    with sheet(path, 3.6) as figure:
        panels = figure.subplots(1, 2, sharex=True)
        for index, name in enumerate(METHODS):
            rows = table[table["method"] == name].sort_values("dt")
            failed = (rows["status"] != "SUCCESS").to_numpy()
            one = CONTESTANTS[name]
            look: dict[str, Any] = {"color": one.colour, "marker": one.marker, "label": one.label}
            look |= {"markerfacecolor": "none", "markersize": 9 - 0.6 * index}
            for panel, quantity, lowest, highest in (
                (panels[0], "growth", 0.9, 1e3),
                (panels[1], "overlap", 1e-8, 1e2),
            ):
                panel.loglog(rows["dt"], rows[quantity].clip(lowest, highest).where(~failed), **look)
                panel.plot(rows["dt"][failed], np.full(failed.sum(), highest), "x", color=one.colour)
        panels[0].set(ylabel="largest coordinate / at the start", xlabel="step dt [time]")
        panels[1].set(ylabel="largest overlap [diameters]", xlabel="step dt [time]")
        for panel, limit, word in ((panels[0], FAR, "unstable"), (panels[1], OVERLAP, "infeasible")):
            panel.axhline(limit, color=GREY, linewidth=0.9, linestyle=":")
            panel.text(0.01, limit, word, transform=panel.get_yaxis_transform(), va="bottom", color=GREY, fontsize=NOTE)
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=4)
    return path


def pacman(runs: pd.DataFrame, half: float, path: Path) -> Path:
    """Draw the set with its mouth, and for every step the two runs that start together at its tip."""
    with sheet(path, 3.2, **{"axes.grid": False}) as figure:
        panels = figure.subplots(1, runs["dt"].nunique(), sharey=True)
        angle = np.linspace(half, 2 * np.pi - half, 200)
        body = np.vstack(([[0.0, 0.0]], np.column_stack((np.cos(angle), np.sin(angle)))))
        for panel, (dt, mine) in zip(np.atleast_1d(panels), runs.groupby("dt", sort=False), strict=True):
            polygon(panel, body, facecolor="#f2d479", edgecolor="#8c7426", linewidth=1.0)
            for _side, one in mine.groupby("side"):
                panel.plot(one["x"], one["y"], "o-", color=INK, markersize=2.5, linewidth=1.0)
            panel.set(
                title=f"dt = {dt:g}", xlim=(-1.05, 1.05), ylim=(-1.05, 1.05), aspect="equal", xticks=[], yticks=[]
            )
            panel.spines[:].set_visible(False)
    return path
