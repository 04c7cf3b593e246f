"""Forecast of a study before it is run: what it can decide, and how long it takes."""

from __future__ import annotations

import heapq
import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import get_args

import numpy as np
import pandas as pd

from dincl.compiled.lanes import WIDTH
from tissue.runs.batch import Batch
from tissue.statistics.categories import What
from tissue.statistics.contrasts import Contrast, MeanContrast, ProportionContrast, RatioContrast
from tissue.statistics.proportions import POWER, quantile
from tissue.statistics.ratios import Ratio
from tissue.study.answers import paired
from tissue.study.plan import TissueStudy, run_seeds
from tissue.study.planned import PlannedComparisons

MAKES_NO_NUMBERS = True

# Correlation of the outcomes of two EMT cells of one run. In the kept studies of chapter 4 with groups of ten cells it
# is below this in 90 % of the ratios from 0.5 % to 99.5 %; in half of them it is below 0.01.
WITHIN_RUN = 0.2
# Ratios near which effects are forecast.
NEAR = (0.05, 0.2, 0.5)
# Seconds that the short runs may take, of all scenarios together, and of each at least.
PATIENCE, LEAST = 20.0, 2.0


def forecast(study: TissueStudy) -> tuple[PlannedComparisons, pd.DataFrame]:
    """Return what is compared, and the least effects that will be shown with a probability of 80 %.

    Where nothing is planned all pairs of scenarios are compared. An effect is shown if |effect| >= (z_level + z_power)
    error, z_level of the corrected level, the error that of independent runs with m cells each, which count as
    m/(1 + (m - 1) WITHIN_RUN).

    Returns
    -------
    plan, table
        ``question``, ``outcome``, ``measure``, and for each ratio of NEAR a column with the least difference, or the
        least ratio; of a number of each run, such as a height, ``spreads``: the least difference in standard deviations
        between runs.
    """
    plan = study.compare or _pairs(list(study.scenarios))
    tables = []
    for near in NEAR:
        blocks = [_block(study, plan, outcome, measure, near) for outcome, measure in plan.blocks]
        factor = quantile(plan.family(blocks).level_of_each) + quantile(2 * POWER - 1)
        found = [(factor * float(np.linalg.norm(one.errors)), one) for block in blocks for one in block]
        tables.append([float(np.exp(size)) if isinstance(one, RatioContrast) else size for size, one in found])
    keys = [(question, *block) for block in plan.blocks for question in plan.contrasts]
    table = pd.DataFrame(keys, columns=["question", "outcome", "measure"])
    proportions = table["outcome"].isin(get_args(What))
    for near, sizes in zip(NEAR, tables, strict=True):
        table[f"{100 * near:g} %"] = pd.Series(sizes).where(proportions)
    table["spreads"] = pd.Series(tables[0]).mask(proportions)
    return plan, table


def effective_cells(study: TissueStudy, scenario: str) -> float:
    """Return as how many independent EMT cells those of one run count: m/(1 + (m - 1) WITHIN_RUN)."""
    cells = sum(group.scenario.cells for group in study.scenarios[scenario].groups() if group.may_leave)
    return cells / (1 + (cells - 1) * WITHIN_RUN) if cells else 0.0


def _pairs(names: list[str]) -> PlannedComparisons:
    contrasts = {f"{first} - {second}": {first: 1.0, second: -1.0} for first, second in paired(names)}
    return PlannedComparisons(get_args(What), ("difference",), "holm", contrasts)


def _block(
    study: TissueStudy, plan: PlannedComparisons, outcome: str, measure: str, near: float
) -> tuple[Contrast, ...]:
    """Return the contrasts as they will be if all ratios are near one number; numbers of runs have a spread of 1."""
    if outcome not in get_args(What):
        spread = np.resize((-1.0, 1.0), study.replicates)
        samples = tuple(spread for _ in plan.scenarios)
        return tuple(MeanContrast(_weights(plan, one), samples) for one in plan.contrasts)
    kind = RatioContrast if measure == "ratio" else ProportionContrast
    sizes = [max(study.replicates * effective_cells(study, name), 1.0) for name in plan.scenarios]
    many = 10_000  # of which ``near`` is a whole number
    ratios = tuple(Ratio(round(near * many), many, min(size, many)) for size in sizes)
    return tuple(kind(_weights(plan, one), ratios) for one in plan.contrasts)


def _weights(plan: PlannedComparisons, question: str) -> tuple[float, ...]:
    return tuple(plan.contrasts[question].get(name, 0.0) for name in plan.scenarios)


@dataclass(frozen=True)
class RunTime:
    """Seconds of one run of a scenario on one core, when as many are made side by side as in a study."""

    seconds: float
    whole: bool  # whether runs were made to their end; else runs cost more, as there are more cells later


class _EnoughError(Exception):
    """The time is over."""


def measured_costs(study: TissueStudy) -> dict[str, RunTime]:
    """Measure the cost of a run of each scenario, by eight of its runs side by side, or by their beginning."""
    limit = max(LEAST, PATIENCE / len(study.scenarios))
    return {name: _cost(study, name, limit) for name in study.scenarios}


def _cost(study: TissueStudy, scenario: str, limit: float) -> RunTime:
    parameters = study.scenarios[scenario]
    seeds = run_seeds(study.seed, scenario, range(WIDTH))
    _compile(Batch(parameters, seeds))
    began, reached, spent = time.perf_counter(), 0.0, 0.0

    def ask() -> None:
        if time.perf_counter() - began > limit:
            raise _EnoughError

    try:
        for t in Batch(parameters, seeds).times(ask):
            reached, spent = t, time.perf_counter() - began
    except _EnoughError:
        pass
    whole = reached >= parameters.t_end
    share = reached / parameters.t_end
    return RunTime((spent / share if share > 0 else limit) / WIDTH, whole)


def _compile(batch: Batch) -> None:
    """Make the first steps, for which machine code is made or read."""
    asked = iter((None,))

    def once() -> None:
        if next(asked, "again") == "again":
            raise _EnoughError

    try:
        for _ in batch.times(once):
            pass
    except _EnoughError:
        pass


def duration(study: TissueStudy, costs: dict[str, RunTime], workers: int) -> float:
    """Return the seconds that a study takes on so many workers [s], which take its pieces one after the other."""
    ends = [0.0] * workers
    for piece in study.pieces():
        heapq.heappush(ends, heapq.heappop(ends) + piece.runs * costs[piece.scenario].seconds)
    return max(ends)


def useful_workers(study: TissueStudy) -> int:
    """Return the number of pieces: more workers than these have nothing to do."""
    return sum(1 for _ in study.pieces())


def worker_numbers(cores: int, most: int) -> Sequence[int]:
    """Return numbers of workers for which the time is of interest: one, this machine's, and more, up to ``most``."""
    return sorted({1, cores, *(number for number in (8, 32, 128) if number < most), most})
