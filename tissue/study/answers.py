"""Answers of a study: ratios with intervals, differences of scenarios, control cells, and what was run."""

from __future__ import annotations

from itertools import combinations
from typing import Any, get_args

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.special import stdtrit

from dincl.checks import instance, integer
from tissue.files.parameter_files import flat
from tissue.statistics.categories import What, outcome
from tissue.statistics.comparisons import Difference, runs_needed
from tissue.statistics.proportions import LEVEL, corrected
from tissue.statistics.ratios import Ratio, as_ratio, ratio, ratio_of_runs
from tissue.study.read import Results

# Scenarios beyond which each is compared with the first one alone.
MOST_PAIRED = 6
# A corrected p-value below this is a difference.
FOUND = 1 - LEVEL


def scenario_ratios(results: Results) -> pd.DataFrame:
    """Count the EMT cells of each stored scenario that are extruded, or below all control cells, at the end.

    Columns: scenario, outcome ("basal", "apical", "below"), count, of [cells], effective [cells], runs [with such
    cells], value, low, high; Wilson's 95 % intervals on the effective number of cells.
    """
    rows: list[tuple[Any, ...]] = []
    for scenario in _stored(results):
        end = results.parameters(scenario).t_end
        cells = results.cells(scenario, ["replicate", f"ab_{end:g}h", f"below_{end:g}h"])
        for what, one in end_ratios(cells, end).items():
            counts = one.count, one.of, one.size, cells["replicate"].nunique()
            rows.append((scenario, what, *counts, one.value, *one.interval()))
    return pd.DataFrame(
        rows, columns=["scenario", "outcome", "count", "of", "effective", "runs", "value", "low", "high"]
    )


def end_ratios(cells: pd.DataFrame, end: float) -> dict[What, Ratio]:
    """Return the ratios of EMT cells of a scenario that are extruded, or below all control cells, at the end [h]."""
    whats: tuple[What, ...] = get_args(What) if len(cells) else ()
    return {what: ratio(outcome(cells, what, end), cells["replicate"]) for what in whats}


def end_shares(cells: pd.DataFrame, end: float) -> dict[What, NDArray[np.float64]]:
    """Return the same ratios of the cells of each run, in the order of the runs."""
    whats: tuple[What, ...] = get_args(What) if len(cells) else ()
    runs = cells["replicate"].to_numpy()
    return {what: outcome(cells, what, end).groupby(runs).mean().to_numpy(np.float64) for what in whats}


def scenario_differences(ratios: pd.DataFrame, replicates: int) -> pd.DataFrame:
    """Compare scenarios: all pairs of up to six, else each with the first one.

    Given are the table of ``scenario_ratios`` and how many replicates a scenario has. Columns: outcome, first, second
    (scenarios), difference, low, high (of their ratios, Newcombe's 95 % interval), p (Holm's, over all rows), differ
    (p < 0.05), needed (runs of each that would probably show a difference of this size, without correction for others;
    missing where one is shown, or none is there).
    """
    instance("ratios", ratios, pd.DataFrame, "the table of scenario_ratios")
    replicates = integer("replicates", replicates, least=1)
    found = ratios.set_index(["scenario", "outcome"])
    pairs = paired(list(dict.fromkeys(ratios["scenario"])))
    rows: list[dict[str, Any]] = []
    for what in get_args(What):
        for first, second in pairs:
            one = Difference(as_ratio(found.loc[(first, what)]), as_ratio(found.loc[(second, what)]))
            low, high = one.interval()
            row = {"outcome": what, "first": first, "second": second, "difference": one.value, "low": low, "high": high}
            rows.append(row | {"p": one.p_value(), "needed": _needed(one, replicates)})
    table = pd.DataFrame(rows, columns=["outcome", "first", "second", "difference", "low", "high", "p", "needed"])
    table["p"] = corrected(table["p"].astype(float))
    table.insert(7, "differ", table["p"] < FOUND)
    table["needed"] = table["needed"].astype("Int64").mask(table["differ"])
    return table


def paired(names: list[str]) -> list[tuple[str, str]]:
    """Return the scenarios that are compared without a plan: all pairs of up to six, else each with the first one."""
    return list(combinations(names, 2)) if len(names) <= MOST_PAIRED else [(names[0], other) for other in names[1:]]


def control_shares(results: Results) -> pd.DataFrame:
    """Return the control cells above the apical layer and below the basal layer at the end, as parts of all.

    Columns: scenario, side, runs, mean, low, high: over all control cells of runs that did not fail, with Wilson's 95 %
    interval on their effective number.
    """
    rows = []
    for scenario in _stored(results):
        end = results.parameters(scenario).t_end
        runs = results.runs(scenario)
        for side in ("apical", "basal"):
            counted = len(shares_of(runs, side, end))
            if counted > 1:
                one = control_ratio(runs, side, end)
                rows.append((scenario, side, counted, one.value, *one.interval()))
    return pd.DataFrame(rows, columns=["scenario", "side", "runs", "mean", "low", "high"])


def shares_of(runs: pd.DataFrame, side: str, end: float) -> NDArray[np.float64]:
    """Return for each run that did not fail the share of control cells outside on the "apical" or "basal" side."""
    outside, cells = _control_counts(runs, side, end)
    return outside / cells


def control_ratio(runs: pd.DataFrame, side: str, end: float) -> Ratio:
    """Return the ratio of control cells outside on a side, of all of two or more runs that did not fail."""
    return ratio_of_runs(*_control_counts(runs, side, end))


def _control_counts(runs: pd.DataFrame, side: str, end: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return for each run that did not fail how many control cells are outside on a side, and how many there are."""
    sound = runs[(runs["status"] == "SUCCESS") & (runs[f"controls_{end:g}h"] > 0)]
    return sound[f"controls_{side}_{end:g}h"].to_numpy(float), sound[f"controls_{end:g}h"].to_numpy(float)


def mean_and_half(values: NDArray[np.float64]) -> tuple[Any, Any]:
    """Compute the mean over the first axis, of length n > 1, and half of Student's 95 % interval."""
    n = len(values)
    return values.mean(axis=0), stdtrit(n - 1, 0.5 + LEVEL / 2) * values.std(axis=0, ddof=1) / np.sqrt(n)


def scenario_changes(results: Results) -> pd.DataFrame:
    """Return the keys in which the scenarios differ: one row for each key, one column for each scenario."""
    instance("results", results, Results, "a tissue.study.read.Results")
    values = {name: flat(results.parameters(name).as_dict()) for name in results.study.scenarios}
    table = pd.DataFrame(values, dtype=object).map(str)
    return table[table.nunique(axis=1) > 1].rename_axis("key").reset_index()


def _stored(results: Results) -> list[str]:
    instance("results", results, Results, "a tissue.study.read.Results")
    summary = results.summary()
    return list(summary.loc[summary["runs"] > 0, "scenario"])


def _needed(one: Difference, replicates: int) -> int | None:
    each = min(one.first.size, one.second.size) / replicates
    return runs_needed(one.first.value, one.second.value, cells_per_run=each)
