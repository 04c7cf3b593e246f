"""Where methods fail."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from verification.instruments.outcome import FAR
from verification.instruments.stability import StabilityMap
from verification.methods.stability import cases, penalty, sweeps_or_steps
from verification.methods.stability.catalogue import MAPS
from verification.methods.stability.schemes import Map
from verification.site import cards
from verification.site.context import Context
from verification.site.parts import Follows, Grid, Part, Picture, Section, Text
from verification.site.report import Card, Chapter, Finding

# The caption of the summary of a map.
CELLS = "Cells by outcome."
CASES = "Do methods fail where theory predicts it?"
RULE = (
    f"Outcome of every run, with the limits that theory predicts. Unstable: a coordinate grows by more than {FAR:g} "
    "times, or leaves the finite numbers. Infeasible: an overlap above 0.1 diameters. Converged: an error of at most "
    "0.02 diameters (for the crowds 6 % of the radius of gyration). Refused: coincident centres."
)
DIVISIONS = {
    "method": "Method",
    "total": "Sweeps in all",
    "best": "Sweeps in a step with the least error",
    "error": "Least error [length]",
    "one": "Error with 1 sweep over the least",
    "most": "Error with 64 sweeps over the least",
}


def run(context: Context) -> None:
    """Complete the cases and the maps."""
    words = pd.DataFrame([{"case": one.id, "title": one.title, "theory": one.theory} for one in cases.CASES])
    context.keep("stability_verdicts", words.merge(context.rows("stability_cases"), on="case"))
    counts = [_found(context, one).summaries()[CELLS].assign(map=one.name) for one in MAPS]
    context.keep("stability_outcomes", pd.concat(counts, ignore_index=True))
    table = context.tables["stability_sweeps_or_steps"]
    context.keep("stability_divisions", sweeps_or_steps.divisions(table))


def sections(context: Context) -> Sequence[Section]:
    """Return the cases, and each map with its limits."""
    table = context.tables["stability_verdicts"]
    places, kinds = places_and_kinds(table)
    listed = Section(
        CASES,
        [
            Text(f"{_agreeing(context)}. Limits are found by bisection, without the formula beside them."),
            Grid(context.headed("stability_cases", places), "Limits and sizes.", "stability_verdicts"),
            Grid(context.headed("stability_cases", kinds), "Kinds of failures.", "stability_verdicts"),
            Follows("Where a failure has a formula, choose the step by the formula."),
        ],
    )
    return [listed, *(_section(context, one) for one in MAPS)]


def places_and_kinds(table: pd.DataFrame) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Divide the verdicts: failures of which theory predicts a number, and those of which it predicts the kind only."""
    predicted = table["expected"].notna()
    return table[predicted], table[~predicted].drop(columns=["expected", "found"])


def findings(context: Context) -> Sequence[Finding]:
    """Return how many failures are where and as they were expected."""
    said = _agreeing(context)
    card = context.draw("card_failures", _draw_card, _found(context, penalty.MAP), penalty.SPRINGS)
    beyond = "on a stiff drift PBD is unstable beyond $k dt = 2$, as explicit Euler is"
    return [Finding(f"{said}: {beyond}.", CASES, Card(card, f"{said}.", 2))]


def _agreeing(context: Context) -> str:
    places, kinds = places_and_kinds(context.tables["stability_verdicts"])
    return (
        f"{places['agrees'].sum()} of {len(places)} failures with a predicted place or size are found there, and "
        f"{kinds['agrees'].sum()} of {len(kinds)} others happen as predicted"
    )


def _found(context: Context, one: Map) -> StabilityMap:
    name = f"stability_{one.name}"
    return one.runs.result(context.tables[name] if name in context.tables else context.rows(name))


def _section(context: Context, one: Map) -> Section:
    counts, best = context.tables["stability_outcomes"], context.tables["stability_divisions"]
    mine = counts[counts["map"] == one.name].drop(columns="map").rename(columns={"method": "Method"})
    picture = context.draw(f"stability_{one.name}", _found(context, one).draw)
    parts: list[Part] = [Text(one.said), Picture(picture, RULE), Grid(mine, CELLS, "stability_outcomes", folded=True)]
    if one is sweeps_or_steps.MAP:
        parts.append(Grid(best.rename(columns=DIVISIONS), "Best division of each run.", "stability_divisions"))
    return Section(f"Map: {one.title}", parts)


def _draw_card(found: StabilityMap, method: str, path: Path) -> Path:
    with cards.card(path) as panel:
        found.plot(panel, method)
        panel.legend(handles=[])  # the page explains the colours
    return path


CHAPTER = Chapter(
    "failures",
    "Where methods fail",
    "Where does each method fail, and does it fail where theory says?",
    run,
    sections,
    findings,
    tables=("stability_",),
)
