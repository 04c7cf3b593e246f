"""The charts of the instruments, from their tables only."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Mapping, Sequence
from itertools import cycle
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from dincl.plotting import log_ticks
from verification.instruments.cheapest import NOT_TRIED, RESOLVED, accuracy, front
from verification.instruments.error_norms import label as error_label
from verification.instruments.error_norms import reference_error
from verification.instruments.outcome import COLOURS as OUTCOME_COLOURS
from verification.instruments.outcome import Outcome
from verification.site.sheet import GREY, NOTE, Axes, hatch_cells, own_axes, own_figure, patch

Looks = Mapping[str, Mapping[str, Any]]
Floats = NDArray[np.float64]
# One colour for each family (Okabe and Ito's palette, apart from yellow, which is too light for lines).
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#000000", "#6f6f6f")
MARKERS = ("o", "s", "^", "D", "v", "P", "X", "*")
COSTS = {"cpu_seconds": "CPU time of integration [s]", "output_seconds": "CPU time of output [s]"}
# Why a method has no point on a chart, by the status of its coarsest run; of any other status: it failed.
NOT_COUNTED = "not counted"
NOTHING = {"OUT_OF_BUDGET": "too slow", "REFUSED": "refused", "LEFT_OUT": "left out"}
# The colours and words of what belongs to no method.
FRONT: Mapping[str, Any] = {"color": "#d9d9d9", "linewidth": 9.0, "label": "efficient front"}
CROSS: dict[str, Any] = {"marker": "x", "mew": 1.6, "linestyle": "none"}
FAILED = "run that failed"
# Errors below this are rounding; they are drawn on the lower edge.
LOWEST = 1e-16
# The largest ratio of a performance profile, and the part of the picture from one marker of a curve to the next.
MOST, MARK_EVERY = 100.0, 0.18

# A colour and a hatching for each outcome, so that outcomes are told apart without colours, too.
HATCHES: Mapping[str, str] = {
    Outcome.CONVERGED.value: "",
    Outcome.BOUNDED.value: "..",
    Outcome.INACCURATE.value: "---",
    Outcome.INFEASIBLE.value: "////",
    Outcome.UNSTABLE.value: "xxxx",
    Outcome.NOT_TERMINATED.value: "||||",
    Outcome.REFUSED.value: "\\\\\\\\",
}
# Thin and light: the colours lead.
HATCHING: dict[str, Any] = {"edgecolor": "#ffffff99", "linewidth": 0.0}
# Limits over a map, and panels side by side with so many letters in a line of their titles.
INK, PATTERNS = "#22262b", ("-", "--", ":", "-.")
MOST_COLUMNS, TITLE_LETTERS = 4, 24
RATES = {"w1": ("E W1", "o", "-"), "error_y": ("E |y_N - y|", "s", "--")}


def styles(looks: Looks) -> dict[str, dict[str, Any]]:
    """Return label -> keywords of a line: a colour for each family, a marker for each method."""
    families = list(dict.fromkeys(look["family"] for look in looks.values()))
    colours = dict(zip(families, cycle(COLOURS), strict=False))
    found = {}
    for (label, look), marker in zip(looks.items(), cycle(MARKERS), strict=False):
        given = {name: value for name, value in look.items() if name != "family"}
        found[label] = {"color": colours[look["family"]], "marker": marker, "linestyle": "-"} | given
    return found


def cost_label(cost: str) -> str:
    """Return the label of the axis of a cost."""
    return COSTS.get(cost, cost.replace("_", " "))


def draw_orders(
    table: pd.DataFrame, fits: pd.DataFrame, looks: Looks, error: str, setting: str, ax: Axes | None
) -> Axes:
    """Draw errors against settings; rows outside of the fit are hollow, failures crosses.

    ``setting`` is the label of the axis.
    """
    panel = own_axes(ax)
    for label, look in styles(looks).items():
        rows = table[table["method"] == label]
        fit = fits[(fits["method"] == label) & (fits["error"] == error)].iloc[0]
        _line(panel, rows, "setting", rows[error], look, f"{label}: {fit['order']}")
        _failures(panel, rows, "setting", look)
    _floor(panel, table, error)
    panel.set(xlabel=setting, ylabel=error_label(error))
    _legend(panel)
    log_ticks(panel)
    return panel


def draw_work_precision(table: pd.DataFrame, looks: Looks, error: str, cost: str, ax: Axes | None) -> Axes:
    """Draw error against cost, coarse settings left."""
    panel, why = own_axes(ax), absent(table)
    for label, look in styles(looks).items():
        rows = table[table["method"] == label].sort_values("setting", ascending=False)
        if not _line(panel, rows, cost, accuracy(rows, error), look, label + made_of(rows)):
            panel.plot([], [], label=f"{label}: {why.get(label, NOT_COUNTED)}", **look)
        _failures(panel, rows, cost, look)
    _front(panel, front(table, error, cost), cost)
    _floor(panel, table, error)
    panel.set(xlabel=cost_label(cost), ylabel=error_label(error))
    _legend(panel)
    log_ticks(panel)
    return panel


def absent(table: pd.DataFrame) -> dict[str, str]:
    """Return why a method has no run that finished, by its label."""
    ordered = table.sort_values("setting", ascending=False, kind="stable").groupby("method", sort=False)["status"]
    none = {method: status for method, status in ordered if "SUCCESS" not in set(status)}
    return {method: NOTHING.get(status.iloc[0], "failed") for method, status in none.items()}


def made_of(rows: pd.DataFrame) -> str:
    """Return how a method is marked in a legend: by what its steps are made of, "" if that is not known."""
    known = rows["compiled"].dropna() if "compiled" in rows else rows[:0]
    return "" if not len(known) else " (compiled)" if known.all() else " (calls Python)"


def draw_profiles(profile: pd.DataFrame, looks: Looks, cost: str, ax: Axes | None) -> Axes:
    """Draw performance profiles: the share of problems solved within a ratio of the smallest cost, up to MOST."""
    panel = own_axes(ax)
    most = min(2.0 * float(profile["ratio"].max()), MOST) if len(profile) else MOST
    for label, look in styles(looks).items():
        rows = profile[profile["method"] == label]
        x, y = [*rows["ratio"], 2 * most], [*rows["share"], rows["share"].max()]
        panel.step(x, y, where="post", label=label, markevery=MARK_EVERY, **look)
    words = cost_label(cost).partition(" [")[0]
    panel.set(xlabel=f"{words} over the least (ties: 1)", ylabel="share of problems")
    panel.set(xscale="log", xlim=(1.0, most), ylim=(0.0, 1.02))
    _legend(panel)
    log_ticks(panel)
    return panel


def _line(panel: Axes, rows: pd.DataFrame, x: str, y: pd.Series, look: dict[str, Any], label: str) -> bool:
    """Draw a curve, if it has points; zeros stand on the lower edge."""
    done = ((rows["status"] == "SUCCESS") & (rows[x] > 0)).to_numpy()
    if not done.any():
        return False
    values = y.to_numpy(float)[done].clip(LOWEST)
    panel.loglog(rows[x].to_numpy(float)[done], values, label=label, **look)
    if "role" in rows:
        hollow = (rows["role"].to_numpy() != "used")[done]
        outside = {"color": look["color"], "marker": look["marker"], "linestyle": "none", "markerfacecolor": "white"}
        panel.loglog(rows[x].to_numpy(float)[done][hollow], values[hollow], **outside)
    return True


def _failures(panel: Axes, rows: pd.DataFrame, x: str, look: dict[str, Any]) -> None:
    failed = rows[~rows["status"].isin(("SUCCESS", *NOT_TRIED)) & (rows[x] > 0)]
    if len(failed):
        edge = {"color": look["color"], "transform": panel.get_xaxis_transform(), "gid": FAILED}
        panel.plot(failed[x], np.full(len(failed), 0.97), **CROSS | edge)


def _front(panel: Axes, runs: pd.DataFrame, x: str) -> None:
    """Draw a pale band behind the curves that joins the efficient runs."""
    runs = runs[runs[x] > 0]
    panel.loglog(runs[x], runs["accuracy"].clip(lower=LOWEST), solid_capstyle="round", zorder=0.5, **FRONT)


def _legend(panel: Axes) -> None:
    """Place the legend beside the axes, where it hides no point; crosses are named if there are any."""
    if any(line.get_gid() == FAILED for line in panel.lines):
        panel.plot([], [], color=GREY, label=FAILED, **CROSS)
    panel.legend(fontsize="small", frameon=False, loc="upper left", bbox_to_anchor=(1.01, 1.0))


def _floor(panel: Axes, table: pd.DataFrame, error: str) -> None:
    """Shade the errors below the error of the reference."""
    limit = RESOLVED * float(np.nan_to_num(reference_error(table, error)).max())
    low, high = panel.get_ylim()
    if not low < limit < high:
        return
    panel.axhspan(low, limit, color="#efefef", zorder=0)
    text = "not resolved by the reference"
    panel.text(0.02, limit, text, transform=panel.get_yaxis_transform(), va="top", color=GREY, fontsize=NOTE)
    panel.set_ylim(low, high)


def draw_stability(
    table: pd.DataFrame, axes: Sequence[str], labels: Sequence[str], limits: pd.DataFrame, ax: Axes | None
) -> Axes:
    """Draw the outcome of every cell, with a colour and a hatching for each outcome, and the limits as lines.

    ``axes`` are the columns across and up, ``labels`` are theirs; ``limits`` has columns label, x and y.
    """
    panel = own_axes(ax)
    _map(panel, table, axes, limits, _patterns(limits))
    panel.set(xlabel=labels[0], ylabel=labels[1])
    there = list(dict.fromkeys(table["outcome"]))
    lines, words = panel.get_legend_handles_labels()
    handles = [*outcome_handles(there), *lines]
    panel.legend(handles, [*there, *words], fontsize="small", loc="upper left", bbox_to_anchor=(1.01, 1.0))
    return panel


def draw_stability_panels(
    table: pd.DataFrame, axes: Sequence[str], labels: Sequence[str], limits: pd.DataFrame
) -> Axes:
    """Draw a panel for each method, one legend of outcomes below all, one of limits above; return the first panel."""
    methods, look = list(dict.fromkeys(table["method"])), _patterns(limits)
    columns = min(MOST_COLUMNS, len(methods))
    rows = -(-len(methods) // columns)
    with own_figure((9.2, 2.2 * rows + 0.9)) as figure:
        panels = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
        lines: dict[str, Any] = {}
        for panel, method in zip(panels.flat, methods, strict=False):
            _map(panel, table[table["method"] == method], axes, limits[limits["method"] == method], look)
            panel.set_title(textwrap.fill(method, TITLE_LETTERS))
            lines |= {word: line for line, word in zip(*panel.get_legend_handles_labels(), strict=True)}
        for place, panel in enumerate(panels.flat):
            if place >= len(methods):
                panel.set_axis_off()
            if place % columns == 0:
                panel.set_ylabel(labels[1])
            if len(methods) - columns <= place < len(methods):
                panel.set_xlabel(labels[0])
                panel.tick_params(labelbottom=True)
        there = [one.value for one in Outcome if one.value in set(table["outcome"])]
        figure.legend(outcome_handles(there), there, loc="outside lower center", ncols=len(there))
        if lines:
            figure.legend(lines.values(), lines.keys(), loc="outside upper right", ncols=len(lines))
    first: Axes = panels[0, 0]
    return first


def _patterns(limits: pd.DataFrame) -> dict[str, str]:
    """Return the pattern of the line of each limit."""
    return dict(zip(dict.fromkeys(limits["label"]), cycle(PATTERNS), strict=False))


def _map(
    panel: Axes, table: pd.DataFrame, axes: Sequence[str], limits: pd.DataFrame, patterns: Mapping[str, str]
) -> None:
    """Draw the cells of one method, and its limits as lines."""
    x, y = (np.array(sorted(table[name].unique())) for name in axes)
    words = table.pivot(index=axes[1], columns=axes[0], values="outcome").loc[y, x].to_numpy()
    wide, high = is_geometric(x), is_geometric(y)
    across, up = edges(x, wide), edges(y, high)
    draw_outcomes(panel, across, up, words)
    for label, curve in limits.groupby("label", sort=False):
        panel.plot(curve["x"], curve["y"], color=INK, linewidth=1.2, linestyle=patterns[label], label=label)
    panel.set_xscale("log" if wide else "linear")
    panel.set_yscale("log" if high else "linear")
    panel.set(xlim=across[[0, -1]], ylim=up[[0, -1]])
    log_ticks(panel)


def sides(values: Iterable[float], count: int) -> Floats:
    """Return ``count`` places along an axis of a map with cells at these values, from side to side."""
    found = np.array(sorted(set(values)), dtype=np.float64)
    wide = is_geometric(found)
    first, last = edges(found, wide)[[0, -1]]
    places: Floats = np.geomspace(first, last, count) if wide else np.linspace(first, last, count)
    return places


def is_geometric(values: Floats) -> bool:
    """Return whether values > 0 are spaced by ratios rather than by differences."""
    if len(values) < 3 or values[0] <= 0:
        return False
    ratios, steps = values[1:] / values[:-1], np.diff(values)
    return bool(np.std(np.log(ratios)) / np.mean(np.log(ratios)) < np.std(steps) / np.mean(steps))


def edges(values: Floats, logarithmic: bool) -> Floats:
    """Return the sides of cells around ``values``, halfway between them."""
    places = np.log(values) if logarithmic else values
    if len(places) == 1:
        places = np.array([places[0] - 0.5, places[0] + 0.5])
        return np.exp(places) if logarithmic else places
    middle = (places[1:] + places[:-1]) / 2
    ends = [2 * places[0] - middle[0], 2 * places[-1] - middle[-1]]
    found: Floats = np.concatenate((ends[:1], middle, ends[1:]))
    return np.exp(found) if logarithmic else found


def draw_rates(means: pd.DataFrame, fit: pd.DataFrame, ax: Axes | None) -> Axes:
    """Draw means with intervals as bars, the fitted power as a line, for each quantity and time."""
    panel = own_axes(ax)
    for k, row in enumerate(fit.itertuples()):
        what, marker, line = RATES[row.quantity]
        mine = means[(means["quantity"] == row.quantity) & (means["t"] == row.t)]
        colour = COLOURS[k % len(COLOURS)]
        # A lower end that is not positive has no place on a logarithmic axis.
        low = mine["low"].where(mine["low"] > 0, mine["mean"] / 10)
        bars = np.array([mine["mean"] - low, mine["high"] - mine["mean"]])
        panel.errorbar(mine["N"], mine["mean"], yerr=np.nan_to_num(bars), fmt=marker, color=colour, capsize=2.0)
        half = (row.high - row.low) / 2
        label = f"{what} at t = {row.t:g}: power {row.slope:.2f} ± {half:.2f}"
        panel.plot(mine["N"], row.constant * mine["N"] ** row.slope, line, color=colour, label=label)
    panel.set(xscale="log", yscale="log", xlabel="N")
    panel.legend(fontsize="small")
    log_ticks(panel)
    return panel


def draw_outcomes(panel: Axes, x: NDArray[np.float64], y: NDArray[np.float64], words: NDArray[Any]) -> None:
    """Draw the outcome of every cell, (m, n), between the edges x (n + 1,) and y (m + 1,); white: no run."""
    colours = np.array([[rgb(OUTCOME_COLOURS.get(word, "#ffffff")) for word in line] for line in words])
    panel.pcolormesh(x, y, colours, edgecolors="white", linewidth=0.3)
    for word, hatch in HATCHES.items():
        here = words == word
        if hatch and here.any():
            hatch_cells(panel, x, y, here, hatch=hatch, facecolor="none", **HATCHING)
    panel.grid(visible=False)


def outcome_handles(words: Iterable[str]) -> list[Any]:
    """Return the legend entries of these outcomes."""
    return [patch(facecolor=OUTCOME_COLOURS[word], hatch=HATCHES[word], **HATCHING) for word in words]


def rgb(colour: str) -> list[float]:
    """Return red, green and blue in [0, 1] of "#rrggbb"."""
    return [int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)]
