"""Where methods fail."""

from __future__ import annotations

from collections.abc import Callable

import pandas as pd

from dincl.study import Study
from verification.instruments.stability import StabilityMap
from verification.methods.stability import cases, few_sweeps, long_steps
from verification.methods.stability.schemes import Map
from verification.site.context import Context

# All maps, in the order of the page, and the studies of this room.
MAPS: tuple[Map, ...] = (
    *(
        few_sweeps.ROW,
        few_sweeps.CROWD_SWEEPS,
        few_sweeps.CROWD_NUMBERS,
        long_steps.DRIFT,
        long_steps.PENALTY,
        long_steps.RADIUS,
        long_steps.SADDLE,
        few_sweeps.SWEEPS_OR_STEPS,
    ),
)
STUDIES: dict[str, Callable[..., Study]] = {
    "stability_cases": cases.study,
    **{f"stability_{one.name}": one.study for one in MAPS},
}
# The caption of the summary of a map.
CELLS = "Cells by outcome."
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
    context.keep("stability_divisions", few_sweeps.divisions(table))


def show(context: Context) -> None:
    """Give the cases, and each map with its limits."""
    places, kinds = places_and_kinds(context.tables["stability_verdicts"])
    context.show("stability_places", context.headed("stability_cases", places), "stability_verdicts")
    context.show("stability_kinds", context.headed("stability_cases", kinds), "stability_verdicts")
    context.numbers["failures"] = f"{places['agrees'].sum()} of {len(places)}"
    counts = context.tables["stability_outcomes"].rename(columns={"method": "Method"})
    for one in MAPS:
        context.draw(f"stability_{one.name}", _found(context, one).draw)
        context.show(one.name, counts[counts["map"] == one.name].drop(columns="map"), "stability_outcomes")
    context.show("divisions", context.tables["stability_divisions"].rename(columns=DIVISIONS), "stability_divisions")


def places_and_kinds(table: pd.DataFrame) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Divide the verdicts: failures of which theory predicts a number, and those of which it predicts the kind only."""
    predicted = table["expected"].notna()
    return table[predicted], table[~predicted].drop(columns=["expected", "found"])


def _found(context: Context, one: Map) -> StabilityMap:
    name = f"stability_{one.name}"
    return one.runs.result(context.tables[name] if name in context.tables else context.rows(name))
