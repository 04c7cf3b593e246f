"""The figures of the chapter on the tissue, from tables only."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from verification.instruments.charts import edges
from verification.page.sheet import GREY, NOTE, Axes, legend_below, sheet
from verification.thesis.chapter3.beyond import SETTLED
from verification.thesis.chapter3.disturbed import PART
from verification.thesis.chapter3.growth import DOUBLED
from verification.thesis.chapter3.maps import GROWING, LABELS, PLANES
from verification.thesis.chapter3.substeps import ENOUGH, FEW, TIMED

Floats = NDArray[np.float64]
# Dark to light along something that increases: times, dampings, disturbances.
SHADES = ("#0b2f5b", "#0072b2", "#009e73", "#b8a200", "#e07b39", "#b8443c")
PRESET = {"thesis": "#d55e00", "published": "#0072b2"}
LOST = "#3a3a42"
# Times of the figure of accuracy, and the widest errors that are drawn [h], [R_soft].
SHOWN = (0.1, 1.0, 2.0, 5.0, 10.0)
# Ticks of times [ms], of deviations of the height [%], of distances [R_soft].
MILLISECONDS = (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000)
PERCENT = (-1, 0, 1, 2, 5, 10, 20)
DISTANCES = (0.2, 0.5, 1)
# Amplitudes of jitter between which the maps are coloured [R_soft].
CALM, WILD = 1e-6, 1.0


def accuracy(errors: pd.DataFrame, noise: pd.DataFrame, path: Path) -> Path:
    """Draw the median error of the nuclei against the seconds for 10 h, one line for each time."""
    with sheet(path, 3.9) as figure:
        panels = figure.subplots(1, len(LABELS), sharey=True)
        for panel, (name, label) in zip(panels, LABELS.items(), strict=True):
            mine = errors[errors["preset"] == name].sort_values("substeps")
            lost = mine.loc[(mine["t"] == TIMED) & (mine["lost"] > 0), "substeps"]
            mine = mine[~mine["substeps"].isin(lost)]
            for t, colour in zip(SHOWN, SHADES, strict=False):
                _resolved(panel, mine[mine["t"] == t], colour, f"t = {t:g} h")
            lowest = mine[mine["t"] == SHOWN[0]]
            for row in lowest.itertuples():
                place = (1e3 * row.seconds, row.rms)
                panel.annotate(
                    str(row.substeps), place, (0, -11), textcoords="offset points", ha="center", fontsize=NOTE
                )
            level = PART * float(noise[(noise["preset"] == name) & (noise["t"] == SHOWN[-1])]["median"].median())
            words = f"half the distance of runs with other noise, t = {SHOWN[-1]:g} h"
            panel.axhline(level, color=GREY, linewidth=0.9, linestyle=":", label=words)
            panel.set(
                title=label, xlabel="milliseconds for 10 h, with the number of substeps", xscale="log", yscale="log"
            )
            low, high = panel.get_xlim()
            _plain(panel, [tick for tick in MILLISECONDS if low <= tick <= high])
        panels[0].set(ylabel="error of the nuclei, root mean square [R_soft]")
        panels[0].margins(y=0.12)
        legend_below(figure, panels, 6)
    return path


def _resolved(panel: Axes, rows: pd.DataFrame, colour: str, label: str) -> None:
    """Draw a line; markers are hollow where the reference itself is no better."""
    hollow = (rows["rms"] <= rows["own"]).to_numpy()
    panel.plot(1e3 * rows["seconds"], rows["rms"], color=colour, label=label)
    for some, face in ((rows[hollow], "white"), (rows[~hollow], colour)):
        panel.plot(1e3 * some["seconds"], some["rms"], "o", color=colour, markerfacecolor=face)


def heights(table: pd.DataFrame, path: Path) -> Path:
    """Draw the deviation of the height from the reference against the substeps, with intervals; crosses: lost runs."""
    with sheet(path, 3.3) as figure:
        panels = figure.subplots(1, len(LABELS), sharey=True)
        highest = 100 * float(table["high"].max())
        for panel, (name, label) in zip(panels, LABELS.items(), strict=True):
            panel.axhspan(-100 * ENOUGH, 100 * ENOUGH, color="#e7f0e4", zorder=0)
            times = sorted(table["t"].unique())
            for t, colour, shift in zip(times, (SHADES[1], SHADES[4]), (0.97, 1.03), strict=True):
                mine = table[(table["preset"] == name) & (table["t"] == t)].sort_values("substeps")
                low, high = mine["deviation"] - mine["low"], mine["high"] - mine["deviation"]
                panel.errorbar(
                    shift * mine["substeps"],
                    100 * mine["deviation"],
                    100 * np.array([low, high]),
                    color=colour,
                    marker="o",
                    label=f"t = {t:g} h",
                    elinewidth=1.0,
                    capsize=2,
                )
                lost = mine[mine["lost"] > 0]
                panel.plot(shift * lost["substeps"], np.full(len(lost), highest), "x", color=colour)
            panel.set(title=label, xlabel="substeps in dt", xscale="log")
            panel.set_yscale("symlog", linthresh=2, linscale=1.5)
            _plain(panel, table[table["preset"] == name]["substeps"])
        panels[0].set_ylabel("height off by [%]")
        panels[0].set_yticks(PERCENT, [f"{value:g}" for value in PERCENT])
        legend_below(figure, panels, 6)
    return path


def disturbances(medians: pd.DataFrame, path: Path) -> Path:
    """Draw the distance of two runs against time: median over the seeds, and the largest as a dashed line."""
    runs = sorted(medians.groupby(["preset", "substeps"]), key=lambda run: (list(LABELS).index(run[0][0]), run[0][1]))
    columns = min(3, len(runs))
    with sheet(path, 2.9 * -(-len(runs) // columns) + 0.4) as figure:
        panels = figure.subplots(-(-len(runs) // columns), columns, sharex=True, sharey=True, squeeze=False)
        for panel, ((name, substeps), mine) in zip(panels.flat, runs, strict=False):
            for (size, one), colour in zip(mine.groupby("size"), SHADES, strict=False):
                label = "other noise" if np.isinf(size) else f"{size:.0e} apart at the start"
                panel.plot(one["t"], one["median"], color=colour, label=label)
                panel.plot(one["t"], one["largest"], color=colour, linestyle="--", linewidth=0.8)
            panel.set(title=f"{LABELS[name]}, {substeps} substeps", yscale="log", xlabel="time [h]")
        for panel in panels.flat[len(runs) :]:
            panel.set_axis_off()
        for panel in panels[:, 0]:
            panel.set_ylabel("distance of the nuclei [R_soft]")
        legend_below(figure, panels.flat, 6)
    return path


def growth(table: pd.DataFrame, finest: pd.Series, path: Path) -> Path:
    """Draw the height over the first one against time: means with bands from the least to the largest of the seeds."""
    with sheet(path, 6.2) as figure:
        panels = figure.subplots(2, len(LABELS), sharex=True, sharey=True)
        for column, (name, label) in enumerate(LABELS.items()):
            mine = table["preset"] == name
            own = int(table[mine]["substeps"].min())
            for row, (rows, word) in enumerate(
                ((table[mine & (table["substeps"] == own)], f"{own} substeps"), (table[mine & finest], "fine substeps"))
            ):
                _bands(panels[row, column], rows)
                panels[row, column].set_title(f"{label}, {word}")
        end = table["t"].max()
        for panel in panels.flat:
            panel.axhline(DOUBLED, color=GREY, linewidth=0.9, linestyle=":", label="doubled")
            panel.set(xlim=(0, end), xticks=np.arange(0, end + 1, 12))
        for panel in panels[:, 0]:
            panel.set_ylabel("height / height at the start")
        for panel in panels[1]:
            panel.set_xlabel("time [h]")
        legend_below(figure, panels.flat, 6)
    return path


def _bands(panel: Axes, rows: pd.DataFrame) -> None:
    """Draw one line for each damping; where seeds are lost it ends."""
    for (mu, mine), colour in zip(rows.groupby("mu"), SHADES, strict=False):
        grouped = mine.groupby("t")["ratio"]
        t, whole = np.array(list(grouped.groups)), (grouped.count() == mine["seed"].nunique()).to_numpy()
        panel.fill_between(t, grouped.min(), grouped.max(), where=whole, color=colour, alpha=0.2, linewidth=0)
        panel.plot(t, grouped.mean().where(whole), color=colour, label=f"μ = {mu:g} h")
        if not whole.all():
            last = np.flatnonzero(whole)[-1]
            panel.plot(t[last], grouped.mean().iloc[last], "x", color=colour, markersize=7, mew=1.6, clip_on=False)


def maps(tables: dict[str, pd.DataFrame], path: Path) -> Path:
    """Draw the amplitude of the jitter in every cell of every map, dark where cells were lost, and the linear limit."""
    with sheet(path, 5.4, **{"axes.grid": False, "axes.spines.top": True, "axes.spines.right": True}) as figure:
        panels = figure.subplots(2, 2 * len(LABELS))
        pairs = [(plane, name) for plane in PLANES for name in LABELS]
        for panel, (plane, name) in zip(panels.flat, pairs, strict=True):
            mine = tables[plane.name]
            panel.set(xscale="log", yscale="log")
            shown = _amplitudes(panel, mine[mine["method"] == name])
            state = "growing" if plane in GROWING else "at rest"
            panel.set(title=f"{LABELS[name]}, {state}", xlabel=plane.x.label, ylabel=plane.y.label)
            panel.minorticks_off()
            if plane in GROWING:
                values = plane.x.values
                _plain(panel, (values[0], values[len(values) // 2], values[-1]))
                panel.set_yticks(FEW, [str(value) for value in FEW])
        figure.colorbar(shown, ax=panels, label="mean amplitude of the jitter [R_soft]", shrink=0.7, aspect=35)
        line, square = panels[0, 0].lines[0], panels[0, 0].plot([], [], "s", color=LOST, markersize=7)[0]
        figure.legend([line, square], ["linear limit", "cells lost"], loc="outside lower center", ncols=2)
    return path


def _amplitudes(panel: Axes, rows: pd.DataFrame) -> Any:
    grid = rows.pivot(index="y", columns="x", values="amplitude")
    x, y = (edges(values.to_numpy(np.float64), logarithmic=True) for values in (grid.columns, grid.index))
    panel.set_facecolor(LOST)
    look: dict[str, Any] = {"cmap": "YlOrRd", "norm": "log", "edgecolors": "white", "linewidth": 0.3}
    mesh = panel.pcolormesh(x, y, grid.clip(CALM, WILD).to_numpy(), **look)
    mesh.set_clim(CALM, WILD)
    limit = rows.groupby("y")["limit"].first()
    panel.plot(limit, limit.index, color="#22262b", linewidth=1.4)
    panel.set(xlim=(x[0], x[-1]), ylim=(y[0], y[-1]))
    return mesh


def jitter(summary: pd.DataFrame, path: Path) -> Path:
    """Draw mean amplitude, share of cells beyond the limit, and least distance of nuclei to their ends against h/mu."""
    with sheet(path, 3.3) as figure:
        panels = figure.subplots(1, 3, sharex=True)
        for name, colour in PRESET.items():
            mine = summary[(summary["preset"] == name) & (summary["lost"] < summary["runs"])].sort_values("scale")
            look: dict[str, Any] = {"color": colour, "marker": "o"}
            panels[0].loglog(mine["scale"], mine["mean"], label=LABELS[name], **look)
            panels[1].semilogx(mine["scale"], 100 * mine["beyond"], **look)
            panels[2].loglog(mine["scale"], mine["least"], **look)
        mine = summary.sort_values("scale")
        panels[2].loglog(mine["scale"], mine["reach"], color=GREY, linestyle="--", label=r"$\sqrt{\alpha h/\mu}$")
        panels[0].set_title(f"Mean amplitude [R_soft], t ≥ {SETTLED:g} h")
        panels[1].set_title("Cells at or beyond the limit [%]")
        panels[2].set_title("Least distance to an end [R_soft]")
        for panel in panels:
            panel.set_xlabel("h/μ")
            panel.minorticks_off()
        panels[2].set_yticks(DISTANCES, [f"{value:g}" for value in DISTANCES])
        legend_below(figure, panels, 3)
    return path


def _plain(panel: Axes, values: Iterable[float]) -> None:
    """Draw ticks at these values, written out."""
    ticks = sorted(set(values))
    panel.set_xticks(ticks, [f"{value:g}" if value >= 1 else f"{value:.3g}" for value in ticks])
    panel.minorticks_off()
