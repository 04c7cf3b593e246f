"""Choices that the thesis leaves open in three dimensions, changed one at a time."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd

from dincl.study import Key, Row, Study
from tissue.files.parameters import Parameters, preset
from tissue.frames.observables import height
from tissue.runs.simulate import simulate
from tissue.study.outcomes import SIDES
from verification.thesis.chapter3.intervals import over_seeds
from verification.tissues.space.growth import basal_extent, roughness
from verification.tissues.space.isolated import INNER, WHOLE, are_inner, counted, with_intervals

# Beside those of the plan ``space_published``: a sheet with a free edge, where those of one division in five stay.
SHEET: Mapping[str, object] = {
    "tissue.dimension": 3,
    "tissue.cells": 196,
    "space.boundary": "open",
    "types.isolated.cells": 9,
    "types.isolated.place": "apart",
    "types.isolated.divides": False,
    "numerics.keep": "54 h",
}
EVENTS: Mapping[str, Mapping[str, object]] = {
    "[A]": {"types.isolated.a": "12 h"},
    "[B] no INM": {"types.isolated.b": "12 h", "types.isolated.inm": 0},
}
AS_SHIPPED, SEEDS = "as shipped", 8
CHOICES: Mapping[str, Mapping[str, object]] = {
    AS_SHIPPED: {},
    "rests at the distance": {"space.new_rest": "distance"},
    "no edge": {"space.boundary": "periodic"},
    "basal neighbours farther": {"tissue.max_basal_distance": "1/2 R_soft"},
    "784 cells": {"tissue.cells": 784, "types.isolated.cells": 36},
    "1,764 cells": {"tissue.cells": 1764, "types.isolated.cells": 81},
}
MEASURED = {"height": "Height / at the start", "basal": "Basal extent / at the start", "rough": "Roughness [R_soft]"}
ENDS = ("lower end, 95 %", "upper end, 95 %")
COLUMNS = {
    "choice": "Choice",
    "events": "Events",
    "part": "Cells",
    "side": "Way out",
    **{
        f"{name}{end}": f"{words}{f', {more}' if more else ''}"
        for name, words in MEASURED.items()
        for end, more in zip(("", "_low", "_high"), ("", *ENDS), strict=True)
    },
    "value": "Ratio",
    "low": "Ratio, lower end, 95 %",
    "high": "Ratio, upper end, 95 %",
    "of": "Number of cells",
    "runs": "Runs",
    "lost": "Runs lost",
}


def study(smallest: bool = False) -> Study:
    """Return one run for each choice, set of events and seed."""
    choices, seeds = ((AS_SHIPPED,), 1) if smallest else (tuple(CHOICES), SEEDS)
    names = [(choice, events) for choice in choices for events in EVENTS]
    runs = tuple({"choice": one, "events": two, "seed": seed} for one, two in names for seed in range(seeds))
    settings = {"sheet": SHEET, "events": EVENTS, "choices": CHOICES}
    key = ("choice", "events", "seed")
    return Study("space_choices", "Space: choices", key, runs, run, settings, COLUMNS, by=("cell",))


def parameters(choice: str, events: str) -> Parameters:
    """Return the parameters of a choice."""
    return preset("published").changed({**SHEET, **CHOICES[choice], **EVENTS[events]})


def run(key: Key) -> list[Row]:
    """Return a row for each EMT cell: where it has begun and ended, and its tissue; one row of a lost run."""
    given = parameters(key["choice"], key["events"])
    made = simulate(given, key["seed"])
    if not made.status:
        return [{**key, "cell": 0, "side": "", "inner": False, **dict.fromkeys(MEASURED, np.nan), "cells": 0}]
    last, first = made.final, made.frames[0]
    about = {"height": height(last) / height(first), "basal": basal_extent(last) / basal_extent(first)}
    about |= {"rough": roughness(last), "cells": len(last.cells.x)}
    return [
        {**key, "cell": k, "side": SIDES[side + 1], "inner": bool(inner), **about}
        for k, (side, inner) in enumerate(zip(last.past.emt.side, are_inner(given), strict=True))
    ]


def ratios(table: pd.DataFrame) -> pd.DataFrame:
    """Return a row for each choice, set of events, part of the cells and side: cells that have left, with intervals.

    The parts are all cells, and those that begin away from the edge if there are some.
    """
    there = _in_order(table[table["side"] != ""])
    parts = pd.concat((there.assign(part=WHOLE), there[there["inner"]].assign(part=INNER)))
    rows = [
        {"choice": choice, "events": events, "part": part, "side": side, **counted(mine["side"] == side, mine["seed"])}
        for (choice, events, part), mine in parts.groupby(["choice", "events", "part"], observed=True)
        for side in (SIDES[0], SIDES[-1])
    ]
    return with_intervals(pd.DataFrame(rows), ["choice", "part"])


def means(table: pd.DataFrame) -> pd.DataFrame:
    """Return a row for each choice: means of relative height, relative basal extent and roughness, with intervals."""
    rows = []
    for choice, mine in _in_order(table).groupby("choice", observed=True):
        runs = mine.groupby(["events", "seed"]).first()
        row: dict[str, Any] = {"choice": choice, "runs": len(runs), "lost": int((runs["side"] == "").sum())}
        for name in MEASURED:
            row[name], row[f"{name}_low"], row[f"{name}_high"] = over_seeds(runs[name].dropna())
        rows.append(row)
    return pd.DataFrame(rows)


def _in_order(table: pd.DataFrame) -> pd.DataFrame:
    """Sort groups of choices in the order of ``CHOICES``."""
    return table.assign(choice=pd.Categorical(table["choice"], list(CHOICES)))
