"""Speed against accuracy."""
# ruff: noqa: RUF001 - formulas for readers are written with Greek letters and minus signs

from __future__ import annotations

import pandas as pd

from verification.page.report import Context, Grid, Picture, Section, Text, number
from verification.thesis.chapter3.sections.part import Part
from verification.thesis.chapter5 import cost, figures
from verification.thesis.chapter5.cases import TITLES
from verification.thesis.chapter5.methods import LABELS
from verification.thesis.chapter5.sections.words import form, listed, named

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
    table = cost.study(context.full).complete(*where)
    context.tables["meanfield_cost"] = table
    context.tables["meanfield_side"] = cost.side_study().complete(*where)
    context.keep("meanfield_cost_times", cost.seconds_to(table, TARGETS))


def _section(context: Context) -> Section:
    table, times, sides = (context.tables[f"meanfield_{name}"] for name in ("cost", "cost_times", "side"))
    picture = context.draw("meanfield_cost", figures.cost, table)
    return Section(
        "Speed against accuracy: particles, characteristics, PDE, moments",
        [
            Text(_words(times)),
            Text(_sides(sides)),
            Picture(picture, "Error of y at the end against seconds and unknowns, from coarse settings to fine ones."),
            Grid(named(times, TIMES), "Seconds to an error (—: not reached in time).", "meanfield_cost_times"),
            Grid(named(sides, SIDES), "One right-hand side of the ODE.", "meanfield_side"),
            Grid(named(table, RUNS), "All runs.", form("meanfield_cost", context.full), folded=True),
        ],
    )


def _words(times: pd.DataFrame) -> str:
    told = []
    for name, mine in times.groupby("model", sort=False):
        for target in TARGETS:
            reached = mine[mine[f"{target:g}"].notna()].sort_values(f"{target:g}")
            if len(reached):
                first = reached.iloc[0]
                seconds = number(first[f"{target:g}"])
                told.append(f"{TITLES[str(name)]} to {number(target)}: {LABELS[first['method']]}, {seconds} s")
    enough = f"{cost.ENOUGH:g} s ({cost.FULL_ENOUGH:g} s in the complete form)"
    return (
        f"The question is y at t = {cost.T[-1]:g} for a smooth density. Cheapest: {listed(told)}. Particles at "
        "quantiles carry an error of about N^(−1.2) whatever solves them, so that tolerances are tied to N; "
        "characteristics put the same particles at Gauss points, and converge as fast as their tolerance; moments, "
        f"where they close, need four unknowns. From coarse to fine until a run takes {enough}; the best of "
        f"{cost.REPEATS}, compiling apart."
    )


def _sides(sides: pd.DataFrame) -> str:
    told = listed([f"{TITLES[row.model]} {number(row.reading)}" for row in sides.itertuples()])
    paired = sides[sides["pairs"].notna()]
    pairs = listed([f"{number(row.pairs)} times as long" for row in paired.itertuples()])
    return (
        f"One right-hand side with N = {sides['N'].max()} takes, in passes over the array: {told}. The sum over all "
        f"pairs of {cost.PAIRED} particles by NumPy takes {pairs} as the interpolation of the interaction, from which "
        f"it differs by {listed([number(row.pairs_off) for row in paired.itertuples()])}."
    )


PART = Part(_run, _section)
