"""Time of a substep of the tissue, by the number of cells."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np
import pandas as pd

from dincl.study import Key, Row, Study
from tissue.files.parameters import Parameters, preset
from tissue.state.running import COUNTERS
from verification.thesis.chapter3.growing import PRESETS, growing_from

SIZES = (60, 120, 1_000, 10_000)
# Hours of growth before timing starts, which also compile the kernels, and repeats of which the best is taken.
SETTLED, REPEATS = 0.5, 5
# Cell-substeps in one timed repeat: long against the clock, short against the patience of a reader.
CELL_SUBSTEPS = 400_000


@dataclass(frozen=True)
class KernelForm:
    """Numbers of cells; cell-substeps in one timed repeat."""

    sizes: tuple[int, ...]
    cell_substeps: int = CELL_SUBSTEPS


FULL = KernelForm(SIZES)


def wide(name: str, cells: int) -> Parameters:
    """Return a preset with so many cells, as wide as their apical points: as crowded as a grown tissue."""
    parameters = preset(name)
    spacing = parameters.start_numbers().apical_spacing
    return parameters.changed({"tissue.cells": cells, "tissue.width": f"{cells * spacing!r} R_soft"})


def per_substep(key: Key, cell_substeps: int) -> list[Row]:
    """Return microseconds per substep: best and median of the repeats, with the load under which they were measured.

    Second daughters are left out, so that the number of cells stays.
    """
    run = growing_from(wide(key["preset"], key["cells"]), 0, two_daughters=0.0)
    dt, substeps = run.numbers.dt, run.numbers.substeps
    run.to(SETTLED)
    steps = max(2, cell_substeps // (key["cells"] * substeps))
    before, pairs, seconds = run.held.counts.copy(), run.pairs, []
    for _ in range(REPEATS):
        began = run.seconds
        run.to((run.made + steps) * dt)
        seconds.append((run.seconds - began) / (steps * substeps))
    counts = dict(zip(COUNTERS, run.held.counts - before, strict=True))
    made = counts["substeps"]
    loads = {"pairs": (run.pairs - pairs) / made}
    loads |= {name: counts[name] / made for name in ("corrections", "basal_corrections")}
    row = {"us_best": 1e6 * min(seconds), "us_median": 1e6 * float(np.median(seconds)), "status": run.status}
    return [dict(key) | row | loads]


def kernel(form: KernelForm) -> Study:
    """Return microseconds per substep as a study; two of its runs are made at once."""
    return Study(
        name="tissue_kernel",
        title="Tissue: kernel",
        key=("preset", "cells"),
        runs=tuple({"preset": name, "cells": cells} for cells in sorted(form.sizes, reverse=True) for name in PRESETS),
        run=partial(per_substep, cell_substeps=form.cell_substeps),
    )


def growth(table: pd.DataFrame) -> pd.DataFrame:
    """Return one row for each preset: p of the time per substep ~ cells^p, the slope of the logarithms."""
    groups = table.groupby("preset")
    return pd.DataFrame([{"preset": name, "exponent": _slope(mine["cells"], mine["us_best"])} for name, mine in groups])


def _slope(x: pd.Series, y: pd.Series) -> float:
    return float(np.polyfit(np.log(x), np.log(y), 1)[0])
