"""Random scenes: errors and costs of five methods over ladders of settings, and of ``Auto``, which chooses its own."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from scipy.stats import binomtest

import dincl
from dincl.study import Key, Row, Study
from verification.instruments.budget import CpuSeconds, OutOfBudgetError, counted
from verification.instruments.recommend import PROJECTION, usual_methods, usual_projection
from verification.instruments.references import Known, reference
from verification.instruments.speed_accuracy import WorkPrecision, WorkPrecisionRuns, WorkPrecisionSet
from verification.methods.decisions.scenes import RandomScene, scene
from verification.methods.methods import ADAPTIVE, EVENT_DRIVEN, LINEARISED_ACTIVE, MIDPOINT_ACTIVE, PBD
from verification.site.cells import number, percent
from verification.site.context import Context
from verification.site.sheet import legend_below, sheet

AUTO, NO_REFERENCE = "Auto", "NO_REFERENCE"
DRAWN_AS = {
    "PBD": PBD,
    "linearised catch-up": LINEARISED_ACTIVE,
    "midpoint catch-up": MIDPOINT_ACTIVE,
    "event-driven": EVENT_DRIVEN,
    "adaptive catch-up": ADAPTIVE,
}
LOOKS: dict[str, dict[str, Any]] = {
    label: {"family": label, "color": one.colour, "marker": one.marker} for label, one in DRAWN_AS.items()
}
SEEDS, SMALL = range(200), (1, 2, 17, 20)
# Of one run of a method with a ladder, of a run of Auto, and of each way to a reference.
BUDGET, PATIENCE, BRIEFLY = CpuSeconds(0.5), CpuSeconds(30.0), CpuSeconds(7.5)
# Over the error that is asked for: where a ladder ends, errors of references by events and by steps.
ENOUGH, BY_EVENTS, BY_STEPS = 1 / 10, 1 / 100, 1 / 20
# The numbers of steps of a ladder: the first one, the factor, how many. Its tolerances [length].
FIRST, FACTOR, MOST = 4, 2**0.5, 50
TOLERANCES = [0.1 / 2**k for k in range(25)]
# Columns of the instrument that the page reads.
KEPT = ["method", "setting", "status", "largest", "stated", "reference_error"]
KEPT += ["cpu_seconds", "spread", "drift_evaluations"]
COLUMNS = {"cost": "Cost", "error": "Error", "scenes": "Scenes", "method": "Method", "alone": "Cheapest alone"}
COLUMNS |= {"1": "Cheapest or tied", "2": "At most 2 times the least", "10": "10 times", "reached": "Error reached"}
COLUMNS |= {"what": "On random scenes", "count": "Scenes", "of": "of", "share": "Share", "low": "from", "high": "to"}
COLUMNS |= {"over": "CPU time of Auto over", "median": "Median", "most": "At most, in nine of ten scenes"}


def study(smallest: bool = False) -> Study:
    """Return the study: a run for each random scene; in the smallest form the coarsest settings on four small ones."""
    runs, by = tuple({"seed": seed} for seed in (SMALL if smallest else SEEDS)), ("method", "setting")
    return Study(
        "decisions", "Random scenes", ("seed",), runs, partial(run_scene, smallest=smallest), columns=COLUMNS, by=by
    )


def run_scene(key: Key, smallest: bool) -> list[Row]:
    """Return the rows of a scene: one for each method and setting; a single one if there is no reference."""
    given = scene(key["seed"])
    n, d = given.problem.x0.shape
    about = {**key, "particles": n, "dimension": d, "layout": given.layout, "sets": given.sets, "drift": given.drift}
    about |= {"end": float(given.t[-1]), "asked": given.error}
    known = solution(given)
    if known is None:
        return [about | dict.fromkeys(KEPT, np.nan) | {"method": "", "status": NO_REFERENCE}]
    ladders = {"dt": list(steps(float(given.t[-1]))), "tol": TOLERANCES}
    by_hand, enough = usual_methods(given.problem, given.error), ENOUGH * given.error
    hand = WorkPrecisionRuns(given.problem, by_hand, ladders, given.t, known, BUDGET, "largest", enough)
    norms = ("largest", "stated")
    auto = WorkPrecisionRuns(given.problem, {AUTO: dincl.Auto}, [given.error], given.t, known, PATIENCE, norms)
    rows = pd.concat([hand.study(smallest=smallest).rows(), auto.study().rows()])
    return [about | row for row in rows.loc[rows["status"] != "LEFT_OUT", KEPT].to_dict("records")]


def steps(end: float) -> Iterator[float]:
    """Yield steps from coarse to fine that divide the time of a run."""
    count = FIRST
    for _ in range(MOST):
        yield end / count
        count = int(np.ceil(FACTOR * count))


def solution(given: RandomScene) -> Known | None:
    """Return the solution by events, or by halved midpoint steps where there are many; None if it takes too long."""
    projection = usual_projection(given.problem, 1e-2 * PROJECTION * given.error)
    by_steps = lambda dt: dincl.MidpointCatchUp(dt, projection)  # noqa: E731
    for tol, scheme, budget in (
        (BY_EVENTS, None, BRIEFLY),
        (BY_STEPS, by_steps, PATIENCE),
        (BY_STEPS, None, PATIENCE),
    ):
        problem, _ = counted(given.problem, budget)
        try:
            return reference(problem, tol * given.error, scheme)(given.t)
        except (OutOfBudgetError, RuntimeError, dincl.InvalidProblem):
            continue
    return None


def charts(rows: pd.DataFrame) -> tuple[WorkPrecisionSet, dict[str, float]]:
    """Return a chart for each scene that has a reference, and the error that is asked for in it."""
    found, asked = {}, {}
    for seed, mine in rows[rows["method"].isin(LOOKS)].groupby("seed"):
        found[str(seed)] = WorkPrecision(mine, ("largest",), BUDGET, LOOKS, title=f"Random scene {seed}")
        asked[str(seed)] = float(mine["asked"].iloc[0])
    return WorkPrecisionSet(found, "Random scenes", "decisions"), asked


# The page: how often each method is the cheapest, and whether ``Auto`` keeps its promise.

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
