"""Section on speed against accuracy."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd

from verification.instruments.budget import CpuSeconds
from verification.instruments.chart import WorkPrecision
from verification.page.context import Context
from verification.page.parts import Chart, Follows, Grid, Picture, Section, Text
from verification.page.prose import fill
from verification.thesis.chapter3.sections.part import Part
from verification.thesis.chapter5 import cost, figures
from verification.thesis.chapter5.cases import TITLES
from verification.thesis.chapter5.methods import LABELS, METHODS
from verification.thesis.chapter5.sections.words import COLUMNS, PROSE, named

TARGETS = (1e-3, 1e-6, 1e-9)

# Rerun on the machine of the reader, until a run takes so many seconds.
AGAIN = cost.CostForm(0.05, 1, cost.SETTINGS)


def _run(context: Context) -> None:
    study, sides = cost.study(context.form(cost.FULL)), cost.side_study(context.form(cost.SIDE))
    table = context.paced(study.name, context.rows_of(study, cost.study(AGAIN), ("setting",)))
    context.tables["meanfield_cost"] = table
    side = context.rows_of(sides, sides.only(lambda key: key["model"] == "straight"))
    context.tables["meanfield_side"] = context.paced(sides.name, side)
    context.keep("meanfield_cost_times", cost.seconds_to(table, TARGETS))


def _section(context: Context) -> Section:
    table, times, sides = (context.tables[f"meanfield_{name}"] for name in ("cost", "cost_times", "side"))
    picture = context.draw("meanfield_cost", figures.cost, table)
    said = fill(PROSE / "cost.html", **_values(times, sides))
    return Section(
        "Which is cheapest: particles, characteristics, PDE or moments?",
        [
            Text(said["cheapest"]),
            Text(said["sides"]),
            Chart(*_interactive(table), said["interactive"], Picture(picture, said["picture"])),
            Grid(named(times, COLUMNS["cost_times"]), said["times"], "meanfield_cost_times"),
            Grid(named(sides, COLUMNS["side"]), said["side"], "meanfield_side"),
            Grid(named(table, COLUMNS["cost"]), said["runs"], "meanfield_cost", folded=True),
            Follows(said["follows"]),
        ],
    )


def _interactive(table: pd.DataFrame) -> tuple[str, str]:
    """Return the chart of all models, and the script that it needs."""
    from verification.instruments.interactive import draw_chart, script

    # As everywhere a finer run has a smaller setting: 1/N and 1/cells.
    fineness = table["setting"].where(table["method"].isin(cost.TOLERATED), 1 / table["setting"])
    runs = table.rename(columns={"error": "final", "seconds": "cpu_seconds"}).assign(setting=fineness)
    runs = runs.assign(method=runs["method"].map(LABELS), status="SUCCESS", spread=np.nan, reference_error=0.0)
    charts = {}
    for name, mine in runs.groupby("model", sort=False):
        there = [one for one in METHODS.values() if one.label in set(mine["method"])]
        looks = {one.label: {"family": one.family} | dict(one.look) for one in there}
        charts[str(name)] = WorkPrecision(mine, ("final",), CpuSeconds(cost.FULL.enough), looks, TITLES[name])
    return draw_chart(charts, ("cpu_seconds", "unknowns")), script()


def _values(times: pd.DataFrame, sides: pd.DataFrame) -> dict[str, Any]:
    return {
        "end": cost.T[-1],
        "cheapest": _cheapest(times),
        "enough": cost.FULL.enough,
        "finest": min(TARGETS),
        "repeats": cost.REPEATS,
        "largest": sides["N"].max(),
        "titles": TITLES,
        "labels": LABELS,
        "sides": list(sides.itertuples()),
        "paired": cost.PAIRED,
        "pairs": list(sides[sides["pairs"].notna()].itertuples()),
    }


def _cheapest(times: pd.DataFrame) -> list[dict[str, Any]]:
    """Find the cheapest method for each model and each error that was reached."""
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
