"""Where methods fail."""
# ruff: noqa: RUF001 - formulas for readers are written with Greek letters and minus signs

from __future__ import annotations

import pandas as pd

from verification.page.report import Context, Grid, Picture, Section, Text, number
from verification.thesis.chapter2.stability.figures import plane
from verification.thesis.chapter3.sections.part import Part
from verification.thesis.chapter5 import drift, failures, figures, maps
from verification.thesis.chapter5.sections.words import listed

CASES = {
    "title": "Case",
    "solver": "Solver",
    "predicted": "Predicted",
    "found": "Found",
    "agrees": "Agrees",
    "seconds": "Seconds",
}
CAPTIONS = (
    "LinearFibre over 100 steps, from near its rest. Unstable: more than twice as far from rest as at the start; "
    "converged: error at most 2 % of the amplitude.",
    "StraightFibre over one period. Refused: stopped with a Status that says singular, or a vanishing step.",
)
GROWTH = {
    "method": "Method",
    "power_g": "|g − c| ~ t^p, p [95 %]",
    "end_g": "at the end",
    "power_rate": "|g'| ~ t^p, p [95 %]",
    "end_rate": "at the end ",
}


def _run(context: Context) -> None:
    where = context.folder, context.executor
    context.keep("meanfield_failed", failures.named(failures.study().complete(*where)))
    found = []
    for one in maps.PLANES:
        context.tables[one.name] = maps.study(one, context.full).complete(*where)
        found.append(maps.agreement(context.tables[one.name], one))
    context.keep("meanfield_maps", pd.concat(found, ignore_index=True))
    table = drift.study(context.full).complete(*where)
    context.tables["meanfield_drift"] = table
    context.keep("meanfield_drift_growth", drift.growth(table))


def _section(context: Context) -> Section:
    found, growth = context.tables["meanfield_failed"], context.tables["meanfield_drift_growth"]
    picture = context.draw("meanfield_drift", figures.drift, context.tables["meanfield_drift"])
    drawn = [context.draw(one.name, plane, context.tables[one.name], one) for one in maps.PLANES]
    return Section(
        "Where the mean-field solvers fail",
        [
            Text(_words(found)),
            Grid(found[list(CASES)].rename(columns=CASES), "Predicted and found.", "meanfield_failed"),
            Text(_maps(context.tables["meanfield_maps"])),
            *(Picture(path, caption) for path, caption in zip(drawn, CAPTIONS, strict=True)),
            Text(_drift(growth, float(context.tables["meanfield_drift"]["t"].max()))),
            Picture(picture, "WavyFibre with five particles; values below 10⁻¹⁶ are drawn there."),
            Grid(growth[list(GROWTH)].rename(columns=GROWTH), "Drift of the constraint.", "meanfield_drift_growth"),
        ],
    )


def _words(found: pd.DataFrame) -> str:
    off = listed([f"{row.title} ({row.solver})" for row in found[~found["agrees"]].itertuples()])
    return (
        f"{len(found)} failures that can be predicted, each provoked: {int(found['agrees'].sum())} end as predicted, "
        f"at the predicted place, with a Status or a refusal that says why; not so: {off}. No result holds a number "
        "that is not finite. Close to dg/dX without full rank every solver stops before it: y → 0 (all particles in "
        "one point), det F(y) → 0, a fold of g."
    )


def _maps(found: pd.DataFrame) -> str:
    told = listed([f"{row.map}, {row.method}: {row.right} of {row.cells}" for row in found.itertuples()])
    return (
        "Two maps with limits from theory. RATTLE on a stiff spring is Verlet's scheme, which grows beyond dt ω = 2, "
        "and a composition of its steps beyond a limit of its own. A StraightFibre pushed fast enough reaches y = 0, "
        "where dg/dX has no rank, and all solvers stop; slower, all come back. Cells, away from the limits by 5 %, "
        f"that failed exactly where they should: {told}."
    )


def _drift(growth: pd.DataFrame, end: float) -> str:
    naive = growth[growth["power_g"] != "—"]
    told = listed(
        [f"{row.method}: |g − c| with power {row.power_g}, |g'| with {row.power_rate}" for row in naive.itertuples()]
    )
    kept = listed([f"{row.method} {number(row.end_g)}" for row in growth[growth["power_g"] == "—"].itertuples()])
    return (
        "The equations of index 1, integrated as they are, forget the constraint: errors add up in g', and these in g. "
        f"Until t = {end:g} the drift grows, measured, {told}. Others at t = {end:g}: {kept}."
    )


PART = Part(_run, _section)
