"""A strip one cell wide, around an open cylinder, beside the ring in the plane: the third dimension taken away."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd

from dincl.study import Key, Row, Study
from tissue.files.parameters import Parameters, preset
from tissue.frames.observables import ab_positions, height, nucleus_height
from tissue.runs.simulate import simulate
from verification.beyond.space.growth import roughness
from verification.thesis.chapter3.intervals import over_seeds

COMMON: Mapping[str, object] = {
    "tissue.cells": 80,
    "layer.shape": "circle",
    "layer.side": "outside",
    "layer.perimeter": "130 um",
    "start.nuclei": "own_basal",
    "tissue.diffusion": "0 um^2/h",  # noise would take nuclei out of the plane
    "numerics.t_end": "36 h",
    "numerics.keep": "36 h",
    "types.isolated.cells": 4,
    "types.isolated.place": "apart",
    "types.isolated.divides": False,
}
RING, STRIP = "ring", "strip"
TISSUES: Mapping[str, Mapping[str, object]] = {
    RING: {"layer.closed": True},
    STRIP: {"tissue.dimension": 3, "space.boundary": "open", "space.rows": 1},
}
EVENTS: Mapping[str, Mapping[str, object]] = {
    "[A]": {"types.isolated.a": "12 h"},
    "[B] no INM": {"types.isolated.b": "12 h", "types.isolated.inm": 0},
    "[BP]": {"types.isolated.b": "12 h", "types.isolated.p": "18 h"},
}
# Of one run, with what they are called.
NAMES: Mapping[str, str] = {
    "cells": "cells",
    "height": "height [R_soft]",
    "nuclei": "mean height of nuclei [R_soft]",
    "y_ab": "mean y_AB",
    "spread": "standard deviation of y_AB",
    "rough": "roughness [R_soft]",
    "basal": "EMT cells basally",
    "apical": "EMT cells apically",
}
MEASURED = tuple(NAMES)
EMT = ("basal", "apical")
# Seeds below this one were looked at while the step was being corrected.
FIRST_SEED = 500


@dataclass(frozen=True)
class StripForm:
    """How far the study goes: number of seeds, and sets of events."""

    seeds: int = 300
    events: tuple[str, ...] = tuple(EVENTS)


FULL = StripForm()


def study(form: StripForm) -> Study:
    """Plan one run for each tissue, set of events and seed."""
    names = [(events, tissue) for events in form.events for tissue in TISSUES]
    seeds = range(FIRST_SEED, FIRST_SEED + form.seeds)
    runs = [{"events": one, "tissue": two, "seed": seed} for one, two in names for seed in seeds]
    return Study("space_strip", "Space: strip", ("events", "tissue", "seed"), tuple(runs), run)


def parameters(events: str, tissue: str) -> Parameters:
    """Return the parameters of a run."""
    return preset("published").changed({**COMMON, **TISSUES[tissue], **EVENTS[events]})


def run(key: Key) -> list[Row]:
    """Run one tissue: a row of measures at the end, in R_soft, and shares of the EMT cells; NaN if the run is lost."""
    given = parameters(key["events"], key["tissue"])
    made = simulate(given, key["seed"], throw=False)
    if not made.status:
        return [{**key, **dict.fromkeys(MEASURED, np.nan)}]
    frame, side = made.final, made.final.past.emt.side
    positions = ab_positions(frame)
    told = {"cells": len(frame.cells.x), "height": height(frame), "nuclei": nucleus_height(frame)}
    told |= {"y_ab": float(positions.mean()), "spread": float(positions.std()), "rough": roughness(frame)}
    return [{**key, **told, "basal": float((side < 0).mean()), "apical": float((side > 0).mean())}]


def differences(table: pd.DataFrame) -> pd.DataFrame:
    """Compare strips with rings: for each quantity its mean in rings, and strip less ring with Student's 95 % interval.

    EMT cells by their events, all else over all events: runs of one seed share a start, so their mean counts once.
    """
    rows = []
    for name in MEASURED:
        for events, mine in table.groupby("events") if name in EMT else [("all", table)]:
            wide = mine.pivot(index=["events", "seed"], columns="tissue", values=name).dropna()
            away = over_seeds((wide[STRIP] - wide[RING]).groupby("seed").mean())
            told = {"of": name, "events": events, "ring": wide[RING].mean(), "difference": away.mean}
            counts = {"seeds": wide.index.get_level_values("seed").nunique(), "lost": len(mine) // 2 - len(wide)}
            rows.append(told | {"low": away.low, "high": away.high} | counts)
    return pd.DataFrame(rows)
