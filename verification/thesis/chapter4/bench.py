"""The cost of a heterogeneous study: per run, for two sizes, one and two threads, with storage and statistics."""

from __future__ import annotations

import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from tempfile import TemporaryDirectory

import pandas as pd

from tissue.study.plan import PART
from tissue.study.run import carry_out
from verification.thesis.chapter4 import summaries
from verification.thesis.chapter4.studies import shortened

STUDY = "table5_35"
# Parts of a study that each thread makes; those of a larger one tell whether the cost per run grows.
PARTS, LARGER = 2, 8
# Runs of one population, and what they took the thesis on six cores [min]; the aim on two cores.
RUNS, THESIS, AIM = 50_000, 45.0, 12.0


def study_table(parts: int = PARTS, larger: int = LARGER) -> pd.DataFrame:
    """One row for each number of threads and of parts for each: seconds of runs and storage, milliseconds per run."""
    _seconds(1, 1)  # compiles
    sizes = [(1, parts), (2, parts), (2, larger)]
    rows = []
    for threads, each in sizes:
        seconds, statistics = _seconds(threads, each)
        runs = threads * each * PART
        rows.append(
            {
                "threads": threads,
                "runs": runs,
                "s": seconds,
                "ms_per_run": 1e3 * seconds / runs,
                "s_statistics": statistics,
            }
        )
    return pd.DataFrame(rows)


def extrapolated(table: pd.DataFrame) -> pd.DataFrame:
    """Minutes of one population of 50,000 runs on two cores, its ratio to the aim and to the thesis, and what two
    threads make of one.

    Runs and storage are counted by the largest sample, statistics as linear in the cells, which they are at most.
    """
    one, two, most = (table.iloc[k] for k in range(3))
    minutes = (most.s + most.s_statistics) * RUNS / most.runs / 60
    return pd.DataFrame(
        [
            {
                "runs": RUNS,
                "min": minutes,
                "of_aim": minutes / AIM,
                "of_thesis": minutes / THESIS,
                "core_minutes_of_thesis": 2 * minutes / (6 * THESIS),
                "throughput_ratio": one.ms_per_run / two.ms_per_run,
                "larger_over_smaller": most.ms_per_run / two.ms_per_run,
            }
        ]
    )


def tables() -> dict[str, tuple[str, pd.DataFrame]]:
    """The tables by the name of their file, with what they show."""
    runs = study_table()
    return {
        "bench_emt": ("EMT: a heterogeneous study, runs and storage, and statistics", runs),
        "bench_emt_population": ("EMT: one population of Table 5, extrapolated to two cores", extrapolated(runs)),
    }


def _seconds(threads: int, parts: int) -> tuple[float, float]:
    """Of the runs with their storage, and of the statistics of a population."""
    study = shortened(STUDY, threads * parts * PART)
    with TemporaryDirectory() as folder, ThreadPoolExecutor(threads) as pool:
        began = time.perf_counter()
        results = {STUDY: carry_out(study, Path(folder) / "out", pool)}
        made = time.perf_counter()
        summaries.category_ratios(results)
        summaries.conditional(results)
        return made - began, time.perf_counter() - made
