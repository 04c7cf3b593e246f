"""What the text leaves open in three dimensions, one choice at a time: what depends on it?

``python -m verification.thesis.space.choices FOLDER`` makes the runs that are missing in FOLDER, in half an hour on two
cores, and ``verification/thesis/data/space_choices.parquet``.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np
import pandas as pd

from dincl.study import Key, Row, Study, workers
from tissue.files.parameters import Parameters, preset
from tissue.first_order import simulate
from tissue.model.observables import height
from tissue.study.outcomes import SIDES
from tissue.study.ratios import ratio
from verification.thesis.chapter3.intervals import over_seeds
from verification.thesis.kept import DATA, keep
from verification.thesis.space.growth import roughness

FILE = DATA / "space_choices.parquet"
SEEDS = 24
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
AS_SHIPPED = "as shipped"
CHOICES: Mapping[str, Mapping[str, object]] = {
    AS_SHIPPED: {},
    "margin 0": {"space.flip_margin": 0},
    "margin 0.3": {"space.flip_margin": 0.3},
    "rests at the distance": {"space.new_rest": "distance"},
    "no edge": {"space.boundary": "periodic"},
}


def study() -> Study:
    """One run for each choice, set of events and seed."""
    runs = [{"choice": one, "events": two, "seed": k} for one in CHOICES for two in EVENTS for k in range(SEEDS)]
    return Study("space_choices", "Space: choices", ("choice", "events", "seed"), tuple(runs), run)


def parameters(choice: str, events: str) -> Parameters:
    """Those of a choice."""
    return preset("published").changed({**SHEET, **CHOICES[choice], **EVENTS[events]})


def run(key: Key) -> list[Row]:
    """One row for each EMT cell: where it has ended, beside the tissue; none of a run that is lost."""
    made = simulate(parameters(key["choice"], key["events"]), key["seed"])
    if not made.status:
        return [dict(key) | {"side": "", "height": np.nan, "rough": np.nan, "cells": 0}]
    last, first = made.final, made.frames[0]
    about = {"height": height(last) / height(first), "rough": roughness(last), "cells": len(last.cells.x)}
    return [dict(key) | {"side": SIDES[side + 1]} | about for side in last.past.emt.side]


def summed(table: pd.DataFrame) -> Iterator[dict[str, object]]:
    """One row for each choice and set of events: ratios of cells that left, and means over the runs; with intervals."""
    for (choice, events), every in table.groupby(["choice", "events"], sort=False):
        mine = every[every["side"] != ""]
        told: dict[str, object] = {"choice": choice, "events": events}
        for side in (SIDES[0], SIDES[-1]):
            found = ratio(mine["side"] == side, mine["seed"])
            told |= {side: found.value} | dict(zip((f"{side}_low", f"{side}_high"), found.interval(), strict=True))
        runs = mine.groupby("seed").first()
        for name in ("height", "rough"):
            mean = over_seeds(runs[name])
            told |= {name: mean.mean, f"{name}_low": mean.low, f"{name}_high": mean.high}
        yield told | {"of": len(mine), "runs": len(runs), "lost": int((every["side"] == "").sum())}


def table() -> pd.DataFrame:
    """The kept table."""
    return pd.read_parquet(FILE)


def main(folder: Path) -> None:
    """Complete the study, and keep its ratios and means."""
    with workers() as executor:
        rows = study().complete(folder, executor)
    keep(pd.DataFrame(summed(rows)), FILE, main)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
