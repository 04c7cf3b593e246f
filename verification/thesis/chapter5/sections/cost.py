"""Speed against accuracy."""

from __future__ import annotations

from typing import Any

import pandas as pd

from verification.page.parts import Grid, Picture, Section, Text, number
from verification.page.prose import fill
from verification.page.report import Context
from verification.thesis.chapter3.sections.part import Part
from verification.thesis.chapter5 import cost, figures
from verification.thesis.chapter5.cases import TITLES
from verification.thesis.chapter5.methods import LABELS
from verification.thesis.chapter5.sections.words import PROSE, form, named

TARGETS = (1e-3, 1e-6, 1e-9)
TIMES = {"model": "Model", "method": "Method"} | {f"{target:g}": f"s to {number(target)}" for target in TARGETS}
TIMES |= {"best": "Best error", "most": "Most unknowns"}
RUNS = {
    "model": "Model",
    "method": "Method",
    "setting": "N, tol or cells",
    "unknowns": "Unknowns",
    "seconds": "Seconds",
    "error": "Error of y",
}
SIDES = {
    "model": "Model",
    "N": "N",
    "seconds": "Seconds",
    "reading": "over one pass of X.sum()",
    "twin": "NumPy takes times as long",
    "off": "NumPy apart",
    "pairs": "All pairs take times as long",
    "pairs_off": "All pairs apart",
}


def _run(context: Context) -> None:
    where = context.folder, context.executor
    table = cost.study(context.form(cost.SHORT, cost.FULL)).complete(*where)
    context.tables["meanfield_cost"] = table
    context.tables["meanfield_side"] = cost.side_study(context.form(cost.SIDE)).complete(*where)
    context.keep("meanfield_cost_times", cost.seconds_to(table, TARGETS))


def _section(context: Context) -> Section:
    table, times, sides = (context.tables[f"meanfield_{name}"] for name in ("cost", "cost_times", "side"))
    picture = context.draw("meanfield_cost", figures.cost, table)
    said = fill(PROSE / "cost.html", **_values(times, sides))
    return Section(
        "Speed against accuracy: particles, characteristics, PDE, moments",
        [
            Text(said["cheapest"]),
            Text(said["sides"]),
            Picture(picture, said["picture"]),
            Grid(named(times, TIMES), said["times"], "meanfield_cost_times"),
            Grid(named(sides, SIDES), said["side"], "meanfield_side"),
            Grid(named(table, RUNS), said["runs"], form("meanfield_cost", context.full), folded=True),
        ],
    )


def _values(times: pd.DataFrame, sides: pd.DataFrame) -> dict[str, Any]:
    return {
        "end": cost.T[-1],
        "cheapest": _cheapest(times),
        "enough": cost.SHORT.enough,
        "full_enough": cost.FULL.enough,
        "repeats": cost.REPEATS,
        "largest": sides["N"].max(),
        "titles": TITLES,
        "labels": LABELS,
        "sides": list(sides.itertuples()),
        "paired": cost.PAIRED,
        "pairs": list(sides[sides["pairs"].notna()].itertuples()),
    }


def _cheapest(times: pd.DataFrame) -> list[dict[str, Any]]:
    """For each model and error, where one was reached."""
    found = []
    for name, mine in times.groupby("model", sort=False):
        for target in TARGETS:
            reached = mine[mine[f"{target:g}"].notna()].sort_values(f"{target:g}")
            if len(reached):
                first = reached.iloc[0]
                seconds = first[f"{target:g}"]
                found.append({"model": name, "target": target, "method": first["method"], "seconds": seconds})
    return found


PART = Part(_run, _section)
