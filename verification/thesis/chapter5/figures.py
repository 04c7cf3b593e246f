"""The figures of the mean-field chapter, from tables only."""
# ruff: noqa: RUF001 - formulas for readers are written with Greek letters and minus signs

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from verification.instruments.rates import QUANTILES
from verification.page.sheet import GREY, NOTE, Axes, legend_below, sheet
from verification.thesis.chapter5 import flow_rates, grid_order, stability_constant
from verification.thesis.chapter5.cases import TITLES
from verification.thesis.chapter5.drift import TITLES as DRIFTERS
from verification.thesis.chapter5.methods import METHODS

# Errors below this are rounding, and drawn there.
LOWEST = 1e-16
COSTS = {"seconds": "CPU time [s]", "unknowns": "number of unknowns"}
# Okabe and Ito's, with lines that differ without colours, too.
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#e69f00", "#cc79a7")
DASHES = ("-", "--", "-.", ":", (0, (5, 1, 1, 1, 1, 1)))
MARKERS = ("o", "s", "^", "D", "v")


def motion(table: pd.DataFrame, path: Path) -> Path:
    """Draw a panel for each model: the components of y in colours, the (first) coordinates of particles in grey."""
    names = table["model"].unique()
    with sheet(path, 2.6) as figure:
        for panel, name in zip(figure.subplots(1, len(names), sharex=True, squeeze=False)[0], names, strict=True):
            for component, one in table[table["model"] == name].groupby("component", sort=False):
                if str(component).startswith("y"):
                    number = int(str(component)[1:])
                    look: dict[str, Any] = {"color": COLOURS[number - 1], "linestyle": DASHES[number - 1]}
                    panel.plot(one["t"], one["value"], zorder=3, label=component, **look)
                else:
                    panel.plot(one["t"], one["value"], color=GREY, linewidth=0.6)
            panel.set(title=TITLES[name], xlabel="time t")
        figure.legend(*panel.get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return path


def agreement(table: pd.DataFrame, name: str, path: Path) -> Path:
    """Draw the error of y (solid) and of the multipliers (dotted) against tolerance or step."""
    with sheet(path, 3.8) as figure:
        panels = figure.subplots(1, 2, sharey=True)
        for method, one in table[table["model"] == name].groupby("method", sort=False):
            panel = panels[int(METHODS[method].setting == "dt")]
            _line(panel, one["setting"], one["error_y"], method)
            panel.loglog(one["setting"], one["error_multipliers"], color=METHODS[method].look["color"], linestyle=":")
        tols = np.array([1e-11, 1e-3])
        panels[0].loglog(tols, tols, color=GREY, linewidth=0.9, linestyle=(0, (1, 1.2)))
        panels[0].set(xlabel="tolerance", ylabel=f"error, {TITLES[name]}")
        panels[1].set(xlabel="step dt [time]")
        legend_below(figure, panels, 3)
    return path


def _line(panel: Axes, x: Any, y: Any, method: str, **look: Any) -> None:
    one = METHODS[method]
    given = {"label": one.label} | dict(one.look) | look
    panel.loglog(x, np.maximum(y, LOWEST), **given)


def energy(table: pd.DataFrame, period: float, path: Path) -> Path:
    """Draw the largest change of energy so far, over many periods."""
    with sheet(path, 3.2) as figure:
        panel = figure.subplots()
        tightest = table.groupby("method")["setting"].min()
        for (method, setting), one in table.groupby(["method", "setting"], sort=False):
            largest = np.maximum.accumulate(np.abs(one["change"].to_numpy()))[1:]
            look = {"label": f"{METHODS[method].label}, {METHODS[method].setting} = {setting:g}", "marker": ""}
            look["linestyle"] = "-" if setting == tightest[method] else "--"
            _line(panel, one["t"].to_numpy()[1:] / period, largest, method, **look)
        panel.set(xlabel="periods", ylabel="largest |E − E(0)| so far")
        legend_below(figure, [panel], 3)
    return path


def rates(averages: pd.DataFrame, path: Path) -> Path:
    """Draw means over the repeats against N with their 95 % intervals; open markers are quantile starts."""
    names = averages["model"].unique()
    with sheet(path, 3.4) as figure:
        panels = figure.subplots(1, len(names), squeeze=False)[0]
        for panel, name in zip(panels, names, strict=True):
            mine = averages[averages["model"] == name]
            for k, (quantity, label) in enumerate(flow_rates.QUANTITIES.items()):
                for start, one in mine[mine["quantity"] == quantity].groupby("start"):
                    quantile = start == QUANTILES
                    look: dict[str, Any] = {"color": COLOURS[k], "marker": MARKERS[k]}
                    look |= {"markerfacecolor": "none", "linestyle": "--"} if quantile else {"label": label}
                    half = [one["mean"] - one["low"].clip(lower=one["mean"] / 10), one["high"] - one["mean"]]
                    panel.errorbar(one["N"], one["mean"], yerr=half, capsize=2, **look)
            panel.set(title=TITLES[name], xlabel="number N of particles", xscale="log", yscale="log")
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=3)
    return path


def stability(envelopes: pd.DataFrame, summary: pd.DataFrame, path: Path) -> Path:
    """Draw the largest D(t)/D(0) of all pairs of a kind, and the bound of the proof as far as it fits."""
    names = envelopes["model"].unique()
    with sheet(path, 3.3) as figure:
        panels = figure.subplots(1, len(names), sharey=True, squeeze=False)[0]
        for panel, name in zip(panels, names, strict=True):
            mine = envelopes[envelopes["model"] == name]
            for k, (kind, label) in enumerate(stability_constant.KINDS.items()):
                one = mine[mine["kind"] == kind]
                panel.semilogy(one["t"], one["ratio"], color=COLOURS[k], linestyle=DASHES[k], label=label)
            bound = float(summary.set_index("model").loc[name, "bound"])
            t = np.linspace(0, min(np.log(100.0) / bound, mine["t"].max()), 50)
            panel.semilogy(t, np.exp(bound * t), color=GREY, linestyle="--", label="bound of the proof")
            panel.set(title=TITLES[name], xlabel="time t", ylim=(0.1, 30))
        panels[0].set_ylabel("largest D(t)/D(0)")
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=6)
    return path


def grid(table: pd.DataFrame, path: Path) -> Path:
    """Draw errors against the width of a cell, one panel for each quantity, with a guide of slope 2."""
    with sheet(path, 3.3) as figure:
        panels = figure.subplots(1, len(grid_order.QUANTITIES))
        for panel, (quantity, label) in zip(panels, grid_order.QUANTITIES.items(), strict=True):
            for k, (name, one) in enumerate(table.groupby("model", sort=False)):
                look: dict[str, Any] = {"color": COLOURS[k], "marker": MARKERS[k], "label": TITLES[name]}
                panel.loglog(one["width"], one[quantity], **look)
            widths = np.array([table["width"].min(), table["width"].max()])
            guide = widths**2 * float((table[quantity] / table["width"] ** 2).min()) / 2
            panel.loglog(widths, guide, color=GREY, linewidth=0.9, linestyle=(0, (1, 1.2)))
            panel.text(widths[0], guide[0], "slope 2", color=GREY, fontsize=NOTE, va="top")
            panel.set(title=f"error of {label}", xlabel="width of a cell")
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))
    return path


def cost(table: pd.DataFrame, path: Path) -> Path:
    """Draw the error of y at the end against time and against the number of unknowns, one row for each model."""
    names = table["model"].unique()
    with sheet(path, 3.2 * len(names)) as figure:
        panels = figure.subplots(len(names), 2, sharey=True, squeeze=False)
        for row, name in zip(panels, names, strict=True):
            for method, one in table[table["model"] == name].groupby("method", sort=False):
                for panel, work in zip(row, COSTS, strict=True):
                    _line(panel, one[work], one["error"], method)
                    panel.set(title=TITLES[name], xlabel=COSTS[work])
            row[0].set_ylabel("error of y at the end")
        handles, labels = panels[0][0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=4)
    return path


def drift(table: pd.DataFrame, path: Path) -> Path:
    """Draw the largest |g - c| and |g'| so far against time."""
    with sheet(path, 3.2) as figure:
        panels = figure.subplots(1, 2, sharex=True)
        for k, (method, one) in enumerate(table.groupby("method", sort=False)):
            for panel, column in zip(panels, ("g", "rate"), strict=True):
                look: dict[str, Any] = {"color": COLOURS[k], "linestyle": DASHES[k], "label": DRIFTERS[method]}
                panel.loglog(one["t"], one[column].clip(lower=LOWEST), **look)
        panels[0].set(xlabel="time t", ylabel="largest |g − c| so far")
        panels[1].set(xlabel="time t", ylabel="largest |dg/dX U + dg/dy v| so far")
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=3)
    return path
