"""Times on this machine: PBD per disc and step, substeps of the tissue (``make bench``).

Warm-up (compilation, first neighbour lists) is not timed; of several repeats the best and the median are kept.
``python -m verification.thesis.bench FOLDER`` prints the tables and writes them to FOLDER, by default ``report``.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

import dincl
from dincl.files import replacing
from dincl.scenes import pile
from dincl.steps.grid import Reached, Stepper, TimeGrid
from tissue.files.parameters import Parameters, preset
from tissue.state.running import COUNTERS
from verification.thesis.chapter3.growing import PRESETS, growing_from

SIZES = (1_000, 10_000, 100_000, 1_000_000)
DT = 1e-3
# Disc-steps in one timed repeat: long against the clock, short against the patience of a reader.
DISC_STEPS = 3_000_000
REPEATS = 5
# Steps before timing starts: a pile has landed after 1000, jostling discs have met their neighbours after 500.
LANDED, JOSTLED = 1_000, 500


def pbd_table(sizes: tuple[int, ...] = SIZES) -> pd.DataFrame:
    """Return one row per scene and size: ns per disc and step, candidate pairs and corrections."""
    rows = []
    for n in sizes:
        rows.append(_pbd_row("pile", pile(n), LANDED))
        rows.append(_pbd_row("jostle", jostle(n), JOSTLED))
    return pd.DataFrame(rows)


def jostle(n: int) -> dincl.Problem:
    """Return the discs of ``pile(n)``, each driven into its neighbours in a random direction, alike for all n.

    In a pile the pressure spreads by one layer a step, so that large piles have few contacts for a long time.
    """
    start = pile(n)
    angle = np.random.default_rng(1).uniform(0, 2 * np.pi, n)
    velocity = np.column_stack((np.cos(angle), np.sin(angle)))
    return dincl.Problem(start.x0, lambda t, x: velocity, start.constraints)


def _pbd_row(name: str, problem: dincl.Problem, warm_up: int) -> dict[str, Any]:
    n = len(problem.x0)
    count = max(20, DISC_STEPS // n)
    stepper = dincl.PBD(DT).stepper(problem)
    steps = _Steps(stepper)
    steps.make(warm_up)
    before = replace(stepper.work)
    seconds = np.array([_timed(lambda: steps.make(count)) for _ in range(REPEATS)])
    made = count * REPEATS * n
    return {
        "scene": name,
        "n": n,
        "ns_best": 1e9 * seconds.min() / (count * n),
        "ns_median": 1e9 * float(np.median(seconds)) / (count * n),
        "pairs": (stepper.work.candidate_pairs - before.candidate_pairs) / made,
        "corrections": (stepper.work.constraint_projections - before.constraint_projections) / made,
        "steps_per_list": count * REPEATS / max(1, stepper.work.neighbour_builds - before.neighbour_builds),
    }


class _Steps:
    """Steps of a scheme, one after the other."""

    def __init__(self, stepper: Stepper) -> None:
        self._stepper, self._reached = stepper, Reached(0, stepper.start())

    def make(self, count: int) -> None:
        k, state, _ = self._reached
        self._reached = self._stepper.advance(TimeGrid(DT * 10**9, 10**9), k, k + count, state)


def _timed(action: Callable[[], Any]) -> float:
    began = time.perf_counter()
    action()
    return time.perf_counter() - began


# Numbers of cells of a tissue; hours of growth before timing starts; cell-substeps in one timed repeat.
CELLS, SETTLED, CELL_SUBSTEPS = (60, 120, 1_000, 10_000), 0.5, 400_000


def tissue_table() -> pd.DataFrame:
    """Return one row per preset and number of cells: microseconds per substep, with the load per substep."""
    return pd.DataFrame([_per_substep(name, cells) for cells in CELLS for name in PRESETS])


def wide(name: str, cells: int) -> Parameters:
    """Return a preset with so many cells, as wide as their apical points: as crowded as a grown tissue."""
    parameters = preset(name)
    spacing = parameters.start_numbers().apical_spacing
    return parameters.changed({"tissue.cells": cells, "tissue.width": f"{cells * spacing!r} R_soft"})


def _per_substep(name: str, cells: int) -> dict[str, Any]:
    """Time substeps; second daughters are left out, so that the number of cells stays."""
    run = growing_from(wide(name, cells), 0, two_daughters=0.0)
    dt, substeps = run.numbers.dt, run.numbers.substeps
    run.to(SETTLED)
    steps = max(2, CELL_SUBSTEPS // (cells * substeps))
    before, pairs, seconds = run.held.counts.copy(), run.pairs, []
    for _ in range(REPEATS):
        began = run.seconds
        run.to((run.made + steps) * dt)
        seconds.append((run.seconds - began) / (steps * substeps))
    counts = dict(zip(COUNTERS, run.held.counts - before, strict=True))
    loads = {"pairs": (run.pairs - pairs) / counts["substeps"]}
    loads |= {one: counts[one] / counts["substeps"] for one in ("corrections", "basal_corrections")}
    times = {"us_best": 1e6 * min(seconds), "us_median": 1e6 * float(np.median(seconds)), "status": run.status}
    return {"preset": name, "cells": cells} | times | loads


def main(out: Path) -> None:
    """Measure; print each table and write it to the folder ``out``."""
    out.mkdir(parents=True, exist_ok=True)
    for name, title, table in (
        ("bench_pbd", "PBD: ns per disc and step, with the pairs and corrections per disc and step", pbd_table),
        ("bench_tissue", "Tissue: microseconds per substep, with the load per substep", tissue_table),
    ):
        rows = table()
        print(f"\n{title}\n{rows.to_string(index=False, float_format='{:.3g}'.format, na_rep='')}")
        with replacing(out / f"{name}.csv") as unfinished:
            rows.to_csv(unfinished, index=False)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if sys.argv[1:] else Path("report"))
