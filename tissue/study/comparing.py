"""Answers to the comparisons that a study planned: of a fixed number of runs, or valid at any time."""

from __future__ import annotations

import math
from functools import cache
from typing import TYPE_CHECKING, Any, get_args

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from dincl.errors import InvalidProblem
from tissue.statistics.categories import What, outcome
from tissue.statistics.contrasts import Contrast, Family, MeanContrast, ProportionContrast, RatioContrast
from tissue.statistics.proportions import LEVEL, POWER, quantile
from tissue.statistics.ratios import Ratio, ratio
from tissue.statistics.sequences import bounded, runs_to_decide, unbounded
from tissue.study.answers import control_ratio, paired, scenario_ratios, shares_of
from tissue.study.planned import SHARES, PlannedComparisons

if TYPE_CHECKING:
    from collections.abc import Mapping

    from tissue.study.planned import Measure, Weights
    from tissue.study.read import Results

Floats = NDArray[np.float64]
COLUMNS = ["question", "outcome", "measure", "value", "low", "high", "p", "answer", "runs", "needed"]
LARGER, SMALLER, NOT_SHOWN = "larger", "smaller", "not shown"
DECIDED, OPEN = "decided", "open"


class RunValues:
    """Outcomes at the end of the runs of a study, of each scenario: runs without a gap from the first one on."""

    def __init__(self, results: Results) -> None:
        self._results = results
        summary = results.summary()
        self._stored = set(summary.loc[summary["runs"] > 0, "scenario"])
        # Several contrasts share a scenario: each of its tables is read once.
        self.ratio = cache(self._ratio)
        self._hits = cache(self._read_hits)
        self._runs = cache(self._read_runs)

    def runs(self, scenario: str) -> int:
        """Return how many runs did not fail."""
        return len(self.numbers(scenario, "replicate"))

    def _ratio(self, scenario: str, what: str) -> Ratio:
        """Return the share of EMT cells with an outcome, or of control cells outside."""
        if what in SHARES:
            return control_ratio(self._runs(scenario), SHARES[what], self._end(scenario))
        hits = self._hits(scenario, what)
        return ratio(hits, hits.index.to_series())

    def shares(self, scenario: str, what: str) -> Floats:
        """Return the share of the cells of each run with an outcome, or a number of each run; empty without runs."""
        if scenario not in self._stored or self._runs(scenario).empty:
            return np.empty(0)
        self.check(scenario)
        if what not in get_args(What):
            return self.numbers(scenario, what)
        found: Floats = self._hits(scenario, what).groupby(level=0).mean().to_numpy(np.float64)
        return found

    def check(self, scenario: str) -> None:
        """Refuse a scenario of which all runs failed."""
        runs = self._runs(scenario)
        if len(runs) and (runs["status"] != "SUCCESS").all():
            ends = ", ".join(map(str, runs["status"].unique()))
            raise InvalidProblem(f"all {len(runs)} runs of {scenario!r} failed: {ends}")

    def numbers(self, scenario: str, what: str) -> Floats:
        """Return a number of each run that did not fail, such as "height_um"."""
        runs, end = self._runs(scenario), self._end(scenario)
        if what in SHARES:
            return shares_of(runs, SHARES[what], end)
        column = what if what == "replicate" else f"{what}_{end:g}h"
        found: Floats = runs.loc[runs["status"] == "SUCCESS", column].to_numpy(np.float64)
        return found

    def _read_hits(self, scenario: str, what: Any) -> pd.Series:
        """Return for each cell whether it has an outcome, by its replicate."""
        end = self._end(scenario)
        cells = self._results.cells(scenario, ["replicate", f"ab_{end:g}h", f"below_{end:g}h"])
        cells = cells[cells["replicate"].isin(self._runs(scenario)["replicate"])]
        if cells.empty:
            raise InvalidProblem(f"scenario = {scenario!r}: must have EMT cells in runs that did not fail")
        return outcome(cells, what, end).set_axis(cells["replicate"])

    def _read_runs(self, scenario: str) -> pd.DataFrame:
        runs = self._results.runs(scenario)
        return runs[runs["replicate"] == np.arange(len(runs))]

    def _end(self, scenario: str) -> float:
        return self._results.parameters(scenario).t_end


def plan_of(results: Results) -> PlannedComparisons | None:
    """Return what a study is to compare.

    Without a plan it is nothing; as long as runs come in, all pairs: differences with intervals of a fixed number of
    runs (``tissue.study.answers.scenario_differences``) would be looked at again and again.
    """
    if results.study.compare is not None or results.as_planned:
        return results.study.compare
    pairs = paired(list(dict.fromkeys(scenario_ratios(results)["scenario"])))
    contrasts = {f"{first} - {second}": {first: 1.0, second: -1.0} for first, second in pairs}
    return PlannedComparisons(get_args(What), ("difference",), "simultaneous", contrasts) if pairs else None


def planned_answers(results: Results) -> pd.DataFrame:
    """Answer the comparisons of ``plan_of``, corrected for each other.

    Columns: question, outcome, measure ("difference", "ratio"), value, low, high, p, answer, runs (of each scenario,
    the fewest), needed (runs of each that would probably show an effect of this size; missing where it is shown, or is
    none). No rows without a plan.

    Of a study with all of the runs that it was planned with, intervals and p-values are those of a fixed number of
    runs, and the answer is "larger", "smaller" (than no effect) or "not shown". While runs still come in, or after more
    were added than planned, intervals are valid at any time, there is no p-value, and the answer is "larger, decided",
    "smaller, decided" or "open".

    Raises
    ------
    InvalidProblem
        If nothing of a scenario that is compared is stored yet, or no run of it has what is compared.
    """
    plan = plan_of(results)
    if plan is None:
        return pd.DataFrame(columns=COLUMNS)
    rows = _fixed(plan, RunValues(results)) if results.as_planned else _any_time(plan, RunValues(results))
    return pd.DataFrame(rows, columns=COLUMNS).astype({"needed": "Int64", "p": float})


def answers_or_reason(results: Results) -> tuple[pd.DataFrame, str]:
    """Return ``planned_answers``; or none, and the sentence that says why there are none."""
    try:
        return planned_answers(results), ""
    except InvalidProblem as error:
        return pd.DataFrame(columns=COLUMNS), f"No answers: {error}"


def effect_text(row: Mapping[str, Any]) -> str:
    """Return the effect in a row of ``planned_answers`` with its interval and unit."""
    value, low, high = (float(row[key]) for key in ("value", "low", "high"))
    if row["runs"] == 0:
        return "no run yet"
    if row["measure"] == "ratio":
        return f"x {value:.2f} [{low:.2f}, {high:.2f}]"
    if row["outcome"] in (*get_args(What), *SHARES):
        return f"{100 * value:+.1f} [{100 * low:+.1f}, {100 * high:+.1f}] points"
    if not pd.isna(row["p"]) and np.isinf(high):
        return f"{value:+.3g}, no interval: no spread between runs"
    return f"{value:+.3g} [{low:+.3g}, {high:+.3g}]"


def correction_text(results: Results, plan: PlannedComparisons) -> str:
    """Return for how many comparisons intervals and answers are corrected, how, and for which numbers of runs."""
    if plan.count == 1:
        many = "one planned comparison, 95 %"
    elif results.as_planned:
        how = "simultaneous" if plan.correction == "simultaneous" else "Holm; intervals: Bonferroni"
        many = f"{plan.count} planned comparisons, 95 % for all together ({how})"
    else:
        many = f"{plan.count} comparisons, 95 % for all together (Bonferroni)"
    if results.replanned:
        many += "; they were changed when there were runs"
    return many if results.as_planned else f"{many}; runs still come in or were added: valid at any time"


def _fixed(plan: PlannedComparisons, source: RunValues) -> list[tuple[Any, ...]]:
    """Return the rows for a number of runs that was fixed beforehand."""
    blocks = [
        tuple(contrast(plan.scenarios, weights, source, *block) for weights in plan.contrasts.values())
        for block in plan.blocks
    ]
    family = plan.family(blocks)
    keys = [(question, *block) for block in plan.blocks for question in plan.contrasts]
    each = [one for block in blocks for one in block]
    runs = min(source.runs(name) for name in plan.scenarios)
    return [(*key, *_row(one, p, family, runs)) for key, one, p in zip(keys, each, family.p_values(), strict=True)]


def contrast(scenarios: list[str], weights: Weights, source: RunValues, what: Any, measure: Measure) -> Contrast:
    """Return a contrast of the scenarios, with weight 0 for those that are not part of it."""
    each = tuple(weights.get(name, 0.0) for name in scenarios)
    for name in scenarios:
        source.check(name)
    if what not in get_args(What):
        samples = tuple(source.numbers(name, what) for name in scenarios)
        if few := [name for name, values in zip(scenarios, samples, strict=True) if len(values) < 2]:
            raise InvalidProblem(f"scenario = {few[0]!r}: must have two runs that did not fail, to compare {what}")
        if what not in SHARES:
            return MeanContrast(each, samples)
    kind = RatioContrast if measure == "ratio" else ProportionContrast
    return kind(each, tuple(source.ratio(name, what) for name in scenarios))


def _row(one: Contrast, p: float, family: Family, runs: int) -> tuple[Any, ...]:
    low, high = one.interval(family.level_of_each)
    shown = p < 1 - family.level if family.correction == "holm" else not low <= one.null <= high
    answer = NOT_SHOWN if not shown else LARGER if one.value > one.null else SMALLER
    size = abs(np.log(one.value) if one.null == 1 else one.value)
    error = float(np.linalg.norm(one.errors))
    factor = quantile(family.level_of_each) + quantile(2 * POWER - 1)
    needed = None if shown or size == 0 or error == 0 else int(np.ceil(runs * (factor * error / size) ** 2))
    return one.value, low, high, p, answer, runs, needed


def _any_time(plan: PlannedComparisons, source: RunValues) -> list[tuple[Any, ...]]:
    """Return the rows for a number of runs that may depend on what was seen; each at the level of all comparisons."""
    level = 1 - (1 - LEVEL) / plan.count
    rows = []
    for what, measure in plan.blocks:
        for question, weights in plan.contrasts.items():
            values = {name: source.shares(name, what) for name in weights}
            row = (_ratio_so_far if measure == "ratio" else _difference_so_far)(weights, values, what, level)
            rows.append((question, what, measure, *row))
    return rows


def _difference_so_far(weights: Weights, values: dict[str, Floats], what: str, level: float) -> tuple[Any, ...]:
    """Enclose the mean of sum w_i x_i of runs with one number."""
    runs = min(map(len, values.values()))
    each = np.sum([weights[name] * one[:runs] for name, one in values.items()], axis=0)
    positive = math.fsum(weight for weight in weights.values() if weight > 0)
    shares = what in (*get_args(What), *SHARES)
    low, high = bounded(each, -positive, positive, level) if shares else unbounded(each, level)
    still = runs > 0 and np.ptp(each) == 0
    if still and not shares:
        low, high = -math.inf, math.inf  # as of MeanContrast
    value, spread = (float(each.mean()), float(each.std())) if runs else (math.nan, math.nan)
    decided = low > 0 or high < 0
    needed = None if decided or still or not runs else runs_to_decide(abs(value), spread, level)
    needed = None if needed is None else max(needed, runs + 1)
    return value, low, high, None, _state(value, 0.0, decided=decided), runs, needed


def _ratio_so_far(weights: Weights, values: dict[str, Floats], what: str, level: float) -> tuple[Any, ...]:
    """Enclose the product of p_i^w_i by an interval of each p_i, all of which cover with ``level``."""
    runs, each = min(map(len, values.values())), 1 - (1 - level) / len(values)
    low, high, logarithm = 0.0, 0.0, 0.0
    with np.errstate(divide="ignore"):
        for name, weight in weights.items():
            ends = weight * np.log(bounded(values[name][:runs], level=each))
            low, high = low + float(ends.min()), high + float(ends.max())
            logarithm += weight * math.log((float(values[name][:runs].sum()) + 0.5) / (runs + 0.5))
    value = math.exp(logarithm) if runs else math.nan
    decided = low > 0 or high < 0
    return value, math.exp(low), math.exp(high), None, _state(value, 1.0, decided=decided), runs, None


def _state(value: float, null: float, *, decided: bool) -> str:
    return f"{LARGER if value > null else SMALLER}, {DECIDED}" if decided else OPEN
