"""Performance profiles on random scenes: how often each method is the cheapest, or costs little more."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from verification.instruments.cheapest import LEAST_SPREAD, Runs, cost_of
from verification.instruments.problem_sets import profiles
from verification.page import cards
from verification.page.parts import number
from verification.page.sheet import GREY, Axes, sheet
from verification.thesis.chapter2.methods import ADAPTIVE, EVENT_DRIVEN, LINEARISED_ACTIVE, MIDPOINT_ACTIVE, PBD

# Ranges of the errors that are asked for [length]: a column of the figure for each, and all errors, for the table.
BANDS = ((1e-3, 10**-1.5), (1e-4, 1e-3), (1e-5, 1e-4))
ALL = (BANDS[-1][0], BANDS[0][1])
# Column of the study -> words for a cost.
COSTS: Mapping[str, str] = {"seconds": "CPU time", "drift_evaluations": "evaluations of the drift"}
# Costs are a tie up to the first ratio; the other ones are columns of the table.
RATIOS = (LEAST_SPREAD, 2.0, 10.0)
# Figures end at this ratio.
MOST = 100.0
LOOKS: Mapping[str, Mapping[str, Any]] = {
    "PBD": PBD.look,
    "linearised catch-up": LINEARISED_ACTIVE.look,
    "midpoint catch-up": MIDPOINT_ACTIVE.look,
    "event-driven": EVENT_DRIVEN.look,
    "adaptive catch-up": ADAPTIVE.look,
}


def costs(table: pd.DataFrame, cost: str) -> pd.DataFrame:
    """Return the cost of the error that is asked for: one row a scene, one column a method, NaN if not reached.

    The index has the seed and the error that is asked for. Scenes without a reference, and those on which no method
    reaches the error, are left out. The rule is that of the chart: ``cheapest.cost_of``.
    """
    found: dict[tuple[int, float], dict[str, float]] = {}
    methods = table[table["method"].isin(LOOKS)]
    for (seed, asked, method), rows in methods.groupby(["seed", "asked", "method"]):
        done = rows[rows["status"] == "SUCCESS"].sort_values("setting", ascending=False)
        runs = Runs(done["error"].to_numpy(float), done[cost].to_numpy(float), np.ones(len(done)))
        price = cost_of(runs, asked).value if len(done) else math.inf
        found.setdefault((seed, asked), {})[method] = price
    index = pd.MultiIndex.from_tuples(found, names=["seed", "asked"])
    rows = pd.DataFrame(list(found.values()), index, columns=list(LOOKS), dtype=float)
    return rows.replace(np.inf, np.nan).dropna(how="all")


def in_band(rows: pd.DataFrame, band: tuple[float, float]) -> pd.DataFrame:
    """Return the rows of ``costs`` with an error above the first bound, and at most the second one."""
    asked = rows.index.get_level_values("asked")
    return rows[(asked > band[0]) & (asked <= band[1])]


def shares(table: pd.DataFrame) -> pd.DataFrame:
    """Return a row for each cost, band and method: in which shares of the scenes it is the cheapest, or nearly so.

    ``alone``: all other methods cost more than LEAST_SPREAD times as much. The columns named after RATIOS: its cost is
    at most so many times the least one. ``reached``: it reaches the error at any cost.
    """
    found = []
    for cost, words in COSTS.items():
        every = costs(table, cost)
        for band in (ALL, *BANDS):
            rows = in_band(every, band)
            ratios = rows.div(rows.min(axis=1), axis=0).fillna(np.inf)
            for method in LOOKS:
                others = ratios.drop(columns=method).min(axis=1)
                row: dict[str, Any] = {"cost": words, "error": band_words(band), "scenes": len(rows), "method": method}
                row["alone"] = float((others > LEAST_SPREAD * ratios[method]).mean())
                row |= {f"{ratio:g}": float((ratios[method] <= ratio).mean()) for ratio in RATIOS}
                found.append(row | {"reached": float(np.isfinite(ratios[method]).mean())})
    return pd.DataFrame(found)


def band_words(band: tuple[float, float]) -> str:
    """Return a range of errors in words."""
    return f"{number(band[0])} to {number(float(f'{band[1]:.1g}'))}"


def draw(table: pd.DataFrame, path: Path) -> Path:
    """Draw a panel for each cost and band: the share of scenes solved within a ratio of the least cost."""
    with sheet(path, 5.6) as figure:
        panels = figure.subplots(len(COSTS), len(BANDS), sharex=True, sharey=True)
        for row, (cost, words) in zip(panels, COSTS.items(), strict=True):
            every = costs(table, cost)
            for panel, band in zip(row, BANDS, strict=True):
                rows = in_band(every, band)
                _draw(panel, profiles(rows))
                panel.set_title(f"error {band_words(band)}, {len(rows)} scenes")
                panel.set_xlabel(f"{words} over the least")
            row[0].set_ylabel("share of scenes")
        handles, labels = panels[0, 0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))
    return path


def draw_card(table: pd.DataFrame, path: Path) -> Path:
    """Draw the profiles by CPU time over all errors."""
    with cards.card(path) as panel:
        _draw(panel, profiles(costs(table, "seconds")))
        panel.set(xlabel="CPU time over the least", ylabel="share of random scenes")
        panel.legend(fontsize=7.5, ncols=3, loc="lower center", bbox_to_anchor=(0.5, 1.0))
    return path


def _draw(panel: Axes, profile: pd.DataFrame) -> None:
    panel.axvspan(1.0, LEAST_SPREAD, color=GREY, alpha=0.25, linewidth=0, label=f"tie: ratio up to {LEAST_SPREAD:g}")
    for method, look in LOOKS.items():
        rows = profile[profile["method"] == method]
        x, y = [*rows["ratio"], 2 * MOST], [*rows["share"], rows["share"].max()]
        line = {"color": look["color"], "marker": look["marker"], "markevery": 0.18}
        panel.step(x, y, where="post", label=method, **line)
    panel.set(xscale="log", xlim=(1.0, MOST), ylim=(0.0, 1.0))
