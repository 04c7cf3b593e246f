"""Seconds of the tissue kernel: per substep and number of cells, per simulated hours, and with two threads.

Loading and compiling are apart: the first steps of every run are thrown away.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import pandas as pd

from dincl.compiled.lanes import WIDTH
from dincl.study import Key, Row, Study
from tissue.files.parameters import Parameters, preset
from tissue.quasi_steady.run import simulate_quasi_steady
from tissue.runs.simulate import simulate, simulate_many
from tissue.state.running import COUNTERS
from verification.thesis.chapter3.growing import PRESETS, growing_from, until

SIZES = (60, 120, 1_000, 10_000)
# Hours of growth before timing starts, and repeats of which the best is taken.
SETTLED, REPEATS = 0.5, 5
# Cell-substeps in one timed repeat: long against the clock, short against the patience of a reader.
CELL_SUBSTEPS = 400_000
HOURS = (10.0, 48.0)
# Lots of eight runs of 10 h that each thread makes.
LOTS = 3


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
    """Return microseconds per substep as a study, for the report; two of its runs are made at once."""
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


def substep_table(sizes: tuple[int, ...]) -> pd.DataFrame:
    """Return the rows of ``per_substep`` for all presets and sizes, one after the other on a quiet machine."""
    keys = [{"preset": name, "cells": cells} for cells in sizes for name in PRESETS]
    return pd.DataFrame([row for key in keys for row in per_substep(key, CELL_SUBSTEPS)])


def abreast_table(end: float) -> pd.DataFrame:
    """Return microseconds per substep of one of eight replicates abreast, from runs to ``end`` and a fifth of it [h].

    Second daughters are left out, so that the number of cells stays.
    """
    rows = []
    for name in PRESETS:
        both = [wide(name, 60).changed(until(t) | {"tissue.two_daughters": 0}) for t in (end / 5, end)]
        simulate_many(both[0], [0])
        seconds = [[_timed(partial(simulate_many, one, range(WIDTH))) for one in both] for _ in range(REPEATS)]
        short, long = np.min(seconds, axis=0)
        numbers = both[0].numbers()
        substeps = WIDTH * 0.8 * end / numbers.dt * numbers.substeps
        rows.append({"preset": name, "cells": 60, "us_abreast": 1e6 * (long - short) / substeps})
    return pd.DataFrame(rows)


def run_table(hours: tuple[float, ...]) -> pd.DataFrame:
    """Return one row for each preset and length of a simulation: seconds of a run alone and of one of eight abreast,
    means over the same eight seeds.

    The ratio is the median of pairs measured one after the other, the seconds are the best.
    """
    rows = []
    for name in PRESETS:
        for end in hours:
            parameters = preset(name).changed(until(end))
            made = simulate_many(parameters, range(WIDTH))[0]
            pairs = [
                (_timed(partial(_each, parameters)), _timed(partial(simulate_many, parameters, range(WIDTH))))
                for _ in range(REPEATS)
            ]
            alone, abreast = np.min(pairs, axis=0) / WIDTH
            times = {"s_alone": alone, "s_abreast": abreast, "ratio": float(np.median([a / b for a, b in pairs]))}
            substeps = made.stats["substeps"]
            rows.append({"preset": name, "hours": end} | times | {"us_substep_abreast": 1e6 * abreast / substeps})
    return pd.DataFrame(rows)


def thread_table(lots: int) -> pd.DataFrame:
    """Return one row for each preset: throughput of two threads over that of one, each with 8 ``lots`` runs of 10 h."""
    rows = []
    for name in PRESETS:
        parameters = preset(name).changed(until(10.0))

        def some(parameters: Parameters = parameters) -> None:
            simulate_many(parameters, range(lots * WIDTH))

        def both(some: Callable[[], None] = some) -> None:
            with ThreadPoolExecutor(2) as pool:
                for made in [pool.submit(some), pool.submit(some)]:
                    made.result()

        some()
        one, two = (min(_timed(action) for _ in range(REPEATS)) for action in (some, both))
        rows.append({"preset": name, "s_one": one, "s_two": two, "throughput_ratio": 2 * one / two})
    return pd.DataFrame(rows)


def _each(parameters: Parameters) -> None:
    """Simulate eight seeds one after the other, as ``simulate_many`` does side by side."""
    for seed in range(WIDTH):
        simulate(parameters, seed)


def daha_table(end: float) -> pd.DataFrame:
    """Time the thesis preset by PBD and by DAHA in turn, with rest lengths ≥ 0, so that DAHA reaches the end [h]."""
    parameters = preset("thesis").changed({"rules.floor_rest_length": True} | until(end))
    simulate_quasi_steady(parameters.changed(until(0.1)), 0)
    pbd, daha = [], []
    for _ in range(REPEATS):
        pbd.append(_timed(lambda: simulate(parameters, 0)))
        daha.append(_timed(lambda: simulate_quasi_steady(parameters, 0)))
    ratios = np.array(daha) / np.array(pbd)
    return pd.DataFrame([{"s_pbd": min(pbd), "s_daha": min(daha), "ratio": np.median(ratios), "least": ratios.min()}])


def tables(
    sizes: tuple[int, ...] = SIZES, hours: tuple[float, ...] = HOURS, lots: int = LOTS
) -> dict[str, tuple[str, pd.DataFrame]]:
    """Return all tables of the tissue by the name of their file, with what they show."""
    kernel_rows = substep_table(sizes)
    return {
        "bench_tissue": ("Tissue: microseconds per substep, with the load per substep", kernel_rows),
        "bench_tissue_growth": ("Tissue: exponent of the time in the number of cells", growth(kernel_rows)),
        "bench_tissue_abreast": ("Tissue: microseconds per substep, one of eight abreast", abreast_table(hours[0])),
        "bench_tissue_runs": (
            "Tissue: seconds of a whole simulation, alone and as one of eight abreast",
            run_table(hours),
        ),
        "bench_tissue_threads": ("Tissue: two threads, each with as many runs as the one", thread_table(lots)),
        "bench_tissue_daha": ("Tissue: seconds by PBD and by DAHA, and their ratio", daha_table(hours[0])),
    }


def _timed(action: Callable[[], Any]) -> float:
    began = time.perf_counter()
    action()
    return time.perf_counter() - began
