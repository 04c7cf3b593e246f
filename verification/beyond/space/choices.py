"""Choices that the thesis leaves open in three dimensions, changed one at a time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd

from dincl.study import Key, Row, Study
from tissue.files.parameters import Parameters, preset
from tissue.frames.observables import height
from tissue.runs.simulate import simulate
from tissue.study.outcomes import SIDES
from verification.beyond.space.counted import counted, with_intervals
from verification.beyond.space.edge import INNER, WHOLE, are_inner
from verification.beyond.space.growth import basal_extent, roughness
from verification.thesis.chapter3.intervals import over_seeds

# Beside those of the study ``space_published``: a sheet with a free edge, where those of one division in five stay.
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
MEASURED = ("height", "basal", "rough")
AS_SHIPPED = "as shipped"
CHOICES: Mapping[str, Mapping[str, object]] = {
    AS_SHIPPED: {},
    "margin 0": {"space.flip_margin": 0},
    "margin 0.3": {"space.flip_margin": 0.3},
    "rests at the distance": {"space.new_rest": "distance"},
    "no edge": {"space.boundary": "periodic"},
    "basal neighbours farther": {"tissue.max_basal_distance": "1/2 R_soft"},
    "784 cells": {"tissue.cells": 784, "types.isolated.cells": 36},
    "1,764 cells": {"tissue.cells": 1764, "types.isolated.cells": 81},
}


@dataclass(frozen=True)
class ChoicesForm:
    """How far the study goes: number of seeds, and the choices."""

    seeds: int = 8
    choices: tuple[str, ...] = tuple(CHOICES)


FULL = ChoicesForm()


def study(form: ChoicesForm) -> Study:
    """Plan one run for each choice, set of events and seed."""
    names = [(choice, events) for choice in form.choices for events in EVENTS]
    runs = [{"choice": one, "events": two, "seed": seed} for one, two in names for seed in range(form.seeds)]
    return Study("space_choices", "Space: choices", ("choice", "events", "seed"), tuple(runs), run)


def parameters(choice: str, events: str) -> Parameters:
    """Return the parameters of a choice."""
    return preset("published").changed({**SHEET, **CHOICES[choice], **EVENTS[events]})


def run(key: Key) -> list[Row]:
    """Return a row for each EMT cell: where it has begun and ended, beside the tissue; none of a run that is lost."""
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
        told: dict[str, object] = {"choice": choice, "runs": len(runs), "lost": int((runs["side"] == "").sum())}
        for name in MEASURED:
            mean = over_seeds(runs[name].dropna())
            told |= {name: mean.mean, f"{name}_low": mean.low, f"{name}_high": mean.high}
        rows.append(told)
    return pd.DataFrame(rows)


def _in_order(table: pd.DataFrame) -> pd.DataFrame:
    """Sort groups of choices in the order of ``CHOICES``."""
    return table.assign(choice=pd.Categorical(table["choice"], list(CHOICES)))
