"""How often each method is the cheapest on random scenes, and whether ``Auto`` keeps its promise on them."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import pandas as pd
from scipy.stats import binomtest

from verification.methods.decisions.study import AUTO, LOOKS, charts
from verification.site.cells import number, percent
from verification.site.context import Context
from verification.site.sheet import legend_below, sheet

# Ranges of the errors that are asked for [length].
BANDS = ((1e-3, 10**-1.5), (1e-4, 1e-3), (1e-5, 1e-4))
ALL = (BANDS[-1][0], BANDS[0][1])
COSTS: Mapping[str, str] = {"cpu_seconds": "CPU time", "drift_evaluations": "evaluations of the drift"}
# What the CPU time of Auto is divided by -> the methods of which it is the least.
OVER = {
    "the least cost of the five methods": list(LOOKS),
    "the least cost of midpoint catch-up with a fixed step": ["midpoint catch-up"],
    "the least cost of adaptive catch-up": ["adaptive catch-up"],
}
# Shares of scenes that are wanted: true error at most the one asked for, stated error at least the true one. No error
# is larger than so many times the one asked for.
WANTED, BEYOND = {"right": 0.97, "stated": 0.99}, 3.0


def band_words(band: tuple[float, float]) -> str:
    """Return a range of errors in words."""
    return f"{number(band[0])} to {number(float(f'{band[1]:.1g}'))}"


def shares(rows: pd.DataFrame) -> pd.DataFrame:
    """Return a row for each cost, band and method: in which shares of the scenes it is the cheapest, or nearly so.

    ``1``: it is the cheapest or ties with it, ``alone``: nobody ties with it; ``2``, ``10``: its cost is at most so
    many times the least one; ``reached``: it reaches the error at any cost.
    """
    found = []
    profiles, asked = charts(rows)
    for cost, words in COSTS.items():
        every, errors = profiles.ratios(asked, cost=cost), pd.Series(asked)
        for band in (ALL, *BANDS):
            over = every[(errors > band[0]) & (errors <= band[1])]
            alone = (over == 1).sum(axis=1) == 1
            for method in LOOKS:
                row = {"cost": words, "error": band_words(band), "scenes": len(over), "method": method}
                row["alone"] = float(((over[method] == 1) & alone).mean())
                row |= {f"{ratio}": float((over[method] <= ratio).mean()) for ratio in (1, 2, 10)}
                found.append(row | {"reached": float(over[method].notna().mean())})
    return pd.DataFrame(found)


def promise(rows: pd.DataFrame) -> pd.DataFrame:
    """Return a row for each question about ``Auto``: number of scenes, share with its 95 % interval (Wilson)."""
    auto = rows[rows["method"] == AUTO]
    success, over = auto["status"] == "SUCCESS", auto["largest"] / auto["asked"]
    stated = (auto["largest"] <= auto["stated"] + auto["reference_error"])[success]
    asked = {
        "SUCCESS, and the true error is at most the one asked for": success & (over <= 1),
        "Of those with SUCCESS: the true error is at most the one asked for": (over <= 1)[success],
        "Of those with SUCCESS: the stated error is at least the true one": stated,
        f"Of those with SUCCESS: the true error is above {number(BEYOND)} times the one asked for": (over > BEYOND)[
            success
        ],
    }
    found = []
    for what, good in asked.items():
        count, of = int(good.sum()), len(good)
        low, high = binomtest(count, of).proportion_ci(method="wilson")
        found.append({"what": what, "count": count, "of": of, "share": count / of, "low": low, "high": high})
    return pd.DataFrame(found)


def costs_of_auto(rows: pd.DataFrame) -> pd.DataFrame:
    """Return a row for each entry of OVER: number of scenes, median and 90 % quantile of the ratio of CPU times."""
    auto = rows[(rows["method"] == AUTO) & (rows["status"] == "SUCCESS")]
    seconds = auto.set_index(auto["seed"].astype(str))["cpu_seconds"]
    profiles, asked = charts(rows)
    least = profiles.costs(asked)
    ratios = {over: (seconds / least[methods].min(axis=1)).dropna() for over, methods in OVER.items()}
    return pd.DataFrame(
        {"over": over, "scenes": len(one), "median": one.median(), "most": one.quantile(0.9)}
        for over, one in ratios.items()
    )


def draw(rows: pd.DataFrame, path: Path) -> Path:
    """Draw the performance profiles over all scenes, by CPU time and by counted work."""
    profiles, asked = charts(rows)
    with sheet(path, 4.2) as figure:
        panels = figure.subplots(1, len(COSTS), sharey=True)
        for panel, cost in zip(panels, COSTS, strict=True):
            profiles.plot(panel, asked, cost=cost)
            panel.set_title(f"{len(asked)} random scenes")
            if legend := panel.get_legend():
                legend.remove()
        panels[1].set_ylabel("")
        legend_below(figure, panels[:1], len(LOOKS))
    return path


def run(context: Context) -> None:
    """Complete the study; keep how often each method is the cheapest, and what ``Auto`` keeps."""
    rows = context.rows("decisions")
    context.keep("decisions_profile", shares(rows))
    context.keep("decisions_promise", promise(rows))
    context.keep("decisions_cost", costs_of_auto(rows))


def show(context: Context) -> None:
    """Give the performance profile, how often each method is the cheapest, and what ``Auto`` keeps at which cost."""
    rows, found = context.tables["decisions"], context.tables["decisions_profile"]
    context.draw("decisions_profile", draw, rows)
    for name in ("profile", "promise", "cost"):
        context.show(f"decisions_{name}", context.headed("decisions", context.tables[f"decisions_{name}"]))
    by_time = found[(found["error"] == band_words(ALL)) & (found["cost"] == COSTS["cpu_seconds"])]
    context.numbers["speed"] = percent(by_time["1"].max())
