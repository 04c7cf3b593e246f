"""Answers of a study: the mean over runs of each scenario, comparisons with intervals, and what was run.

An outcome is a number per run; the share of a scenario is the mean over its runs of the share of a run, so runs count
alike, not cells. All intervals and p-values are those of ``tissue.study.estimates``, for numbers of runs that do not
depend on what was seen.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any, get_args

import numpy as np
import pandas as pd

from dincl.checks import describe, instance
from tissue.files.parameter_files import flat
from tissue.study.categories import EXTREME, What
from tissue.study.estimates import ERROR, Estimate, Floats, estimate, holm
from tissue.study.plan import PlannedComparisons, all_pairs
from tissue.study.read import NoValues, Results

if TYPE_CHECKING:
    from tissue.study.plan import Weights

LARGER, SMALLER, NOT_SHOWN, NO_ANSWER = "larger", "smaller", "not shown", "no answer"
COLUMNS = ["question", "outcome", "measure", "value", "low", "high", "p", "answer", "runs", "needed", "finding"]
# In sentences; others are named by their column.
NAMES = {
    "basal": "basal extrusion",
    "apical": "apical extrusion",
    "below": "the share below all control cells",
    "controls_apical": "apical extrusion of control cells",
    "controls_basal": "basal extrusion of control cells",
}
# What becomes of folded runs in answers, by numerics.folded.
FOLDED = {
    "leave out": "the answers leave these runs out",
    "stop": "these runs stopped there, and the answers leave them out",
    "keep": "the answers have these runs all the same",
}


def folded_remarks(results: Results) -> list[str]:
    """Say of each scenario in how many runs the apical layer was folded, with an example; nothing where it never was.

    Heights and positions mean nothing there, see ``tissue.model.measures``: this goes before all answers.
    """
    remarks, stored = [], results.summary()
    for one in stored[stored["folded"] > 0].itertuples():
        first = next(text for text in results.runs(one.scenario, ["folded"])["folded"] if text != "no")
        becomes = FOLDED[results.parameters(one.scenario).numerics.folded]
        remarks.append(
            f"{one.scenario}: the apical layer was folded in {one.folded} of {one.runs} runs, so that heights and "
            f"positions mean nothing there ({first}); {becomes}"
        )
    return remarks


def scenario_means(results: Results, outcomes: Iterable[str] = tuple(EXTREME)) -> pd.DataFrame:
    """Return the mean over runs of outcomes at the end, for each scenario that has such runs.

    Parameters
    ----------
    results
        Of the study.
    outcomes
        As in ``Results.values``; by default all shares, of EMT cells and of control cells.

    Returns
    -------
    pd.DataFrame
        scenario, outcome, runs [that have a value], value, low, high: the mean with its 95 % interval.
    """
    instance("results", results, Results, "a tissue.study.read.Results")
    rows = []
    for scenario in results.study.scenarios:
        for outcome in outcomes:
            values = _values_or_reason(results, scenario, outcome)
            if not isinstance(values, str):
                mean = estimate([1.0], [values.to_numpy()], EXTREME.get(outcome, 0.0))
                rows.append((scenario, outcome, len(values), float(mean.effect), *map(float, mean.interval())))
    return pd.DataFrame(rows, columns=["scenario", "outcome", "runs", "value", "low", "high"])


def plan_of(results: Results) -> PlannedComparisons | None:
    """Return what a study is to compare: what was planned, else all pairs of up to six scenarios with EMT cells.

    Of more scenarios each is compared with the first one. None if there is nothing to compare.
    """
    if results.study.compare is not None:
        return results.study.compare
    names = list(dict.fromkeys(scenario_means(results, get_args(What))["scenario"]))
    return all_pairs(names) if len(names) > 1 else None


def answer_table(results: Results) -> pd.DataFrame:
    """Answer the comparisons of ``plan_of``: one row for each question, outcome and measure.

    Columns: question, outcome, measure ("difference", "ratio"), value, low, high, p, answer ("larger", "smaller", "not
    shown", "no answer"), runs (of each scenario, the fewest; of paired scenarios those that all have), needed (runs of
    each that would probably show an effect of this size; missing where one is shown, or is none), finding (a sentence).

    p is corrected for all rows by Holm. An effect is shown if p < 0.05; exactly then its interval leaves out no effect.
    Each interval covers with 95 % at least. Scenarios with the same random numbers (``paired`` in the study file) are
    compared run by run. Where a scenario has no value to compare there is no answer, and the sentence says why.
    """
    plan = plan_of(results)
    if plan is None:
        return pd.DataFrame(columns=COLUMNS)
    keys = [(question, *block) for block in plan.blocks for question in plan.contrasts]
    values = {
        (name, outcome): _values_or_reason(results, name, outcome)
        for name in plan.scenarios
        for outcome in plan.outcomes
    }
    paired = results.study.paired
    found = [_contrast(plan.contrasts[question], values, what, measure, paired) for question, what, measure in keys]
    p, levels = holm([1.0 if isinstance(one, str) else float(one[0].p) for one in found])
    rows: dict[tuple[str, ...], dict[str, Any]] = {}
    for key, one, corrected, level in zip(keys, found, p, levels, strict=True):
        row: dict[str, Any] = dict(zip(COLUMNS, key, strict=False))
        rows[key] = row
        if isinstance(one, str):
            row |= {"answer": NO_ANSWER, "runs": 0, "finding": f"No answer to {key[0]}: {one}".replace("?:", "?")}
        else:
            row |= _answer(*one, float(corrected), float(level))
            effect = plan.effects.get(key[0], ())
            # Of an interaction the effect at the level where it is: it comes before.
            simple = rows["{} - {}, {}".format(*effect[:3]), *key[1:]] if len(effect) == 4 else row
            row["finding"] = _finding(row, effect, raises=simple["value"] > 0)
    return pd.DataFrame(list(rows.values()), columns=COLUMNS).astype({"needed": "Int64"})


def _values_or_reason(results: Results, scenario: str, outcome: str) -> pd.Series | str:
    """Return the values of the runs of a scenario, or why there are not enough."""
    try:
        values = results.values(scenario, outcome)
    except NoValues as error:
        return str(error)
    fewest = 1 if outcome in EXTREME else 2
    return values if len(values) >= fewest else f"{describe(scenario)} has fewer than {fewest} runs with {outcome}"


def _contrast(
    weights: Weights, values: Mapping[tuple[str, str], pd.Series | str], outcome: str, measure: str, paired: bool
) -> tuple[Estimate, int] | str:
    """Return the estimate of a contrast with the fewest runs of a scenario, or why there is none."""
    each: dict[str, pd.Series] = {}
    for name in weights:
        one = values[name, outcome]
        if isinstance(one, str):
            return one
        each[name] = one
    if paired:
        table = pd.concat(each, axis=1, join="inner")
        each = {name: table[name] for name in table}
    groups: list[Floats] = [one.to_numpy(np.float64) for one in each.values()]
    runs = min(map(len, groups))
    if runs < 2 and paired:
        return "fewer than two runs with the same random numbers"
    extreme = EXTREME.get(outcome, 0.0)
    return estimate(list(weights.values()), groups, extreme, ratio=measure == "ratio", paired=paired), runs


def _answer(found: Estimate, runs: int, p: float, level: float) -> dict[str, Any]:
    low, high = found.interval(level)
    shown = p < ERROR
    needed = None if shown else found.runs_to_show(runs, level)
    answer = NOT_SHOWN if not shown else LARGER if found.centre > 0 else SMALLER
    interval = {"value": float(found.effect), "low": float(low), "high": float(high)}
    return {**interval, "p": p, "answer": answer, "runs": runs, "needed": needed}


def _finding(row: Mapping[str, Any], effect: tuple[str, ...], *, raises: bool) -> str:
    """Write an answer as a sentence.

    ``effect``: the level or scenario whose effect it is, the one it is compared with, and on request where that is, and
    where the effect is compared with; without any the question says what is compared. ``raises``: whether it is > 0.
    """
    text, what = _effect_text(row), outcome_name(row["outcome"])
    if not effect:
        asked = row["question"] if row["question"].endswith("?") else f"{row['question']}:"
        return f"{asked} {what} {text}{', not shown' * (row['answer'] == NOT_SHOWN)}"
    level, first, *places = effect
    where, *base = places or [""]
    here = f" in {where}" if where else ""
    more = f" more{here} than in {base[0]}" if base else here
    if row["answer"] == NOT_SHOWN:
        return f"It is not shown that {level} changes {what}{more}, against {first}: {text}"
    if row["measure"] == "ratio":
        times = f"a factor that is {text} times as large{here} as in {base[0]}" if base else f"{text}{here}"
        return f"{level} multiplies {what} by {times}, against {first}"
    if base and (row["value"] > 0) != raises:
        more = f" less{here} than in {base[0]}"
    return f"{level} {'raises' if raises else 'lowers'} {what} by {_effect_text(row, size=True)}{more}, against {first}"


def _effect_text(row: Mapping[str, Any], *, size: bool = False) -> str:
    """Return the effect in a row with its interval and unit; ``size``: that of a difference, without its sign."""
    value, low, high = (float(row[key]) for key in ("value", "low", "high"))
    sign, digits, scale, unit = ("" if size else "+"), ".3g", 1, " um" if row["outcome"].endswith("_um") else ""
    if row["measure"] == "ratio":
        sign, digits = "", ".2f"
    elif np.isinf(high):
        return f"{value:+.3g}, no interval: no spread between runs"
    elif row["outcome"] in EXTREME:
        digits, scale, unit = ".1f", 100, " points"
    if size and value < 0:
        value, low, high = -value, -high, -low
    one, two, three = (f"{scale * number:{sign}{digits}}" for number in (value, low, high))
    return f"{one}{unit} [{two}, {three}]"


def outcome_name(outcome: str) -> str:
    """Return the name of an outcome in sentences and on axes."""
    return NAMES.get(outcome, outcome.removesuffix("_um").replace("_", " "))


def answers_shown(results: Results) -> pd.DataFrame:
    """Return the answers as they are printed: texts in the columns ``finding``, ``p`` and ``runs needed``."""
    found = answer_table(results)
    p, needed = found["p"].map("{:.2g}".format, na_action="ignore"), found["needed"].astype("string")
    return pd.DataFrame({"finding": found["finding"], "p": p.fillna(""), "runs needed": needed.fillna("")})


def shares_shown(results: Results) -> pd.DataFrame:
    """Return the means over runs of all shares at the end as they are printed, in per cent, and of how many runs."""
    stored, rows = results.summary().set_index("scenario")["runs"], []
    for row in scenario_means(results).itertuples():
        every = stored[row.scenario]
        share = f"{100 * row.value:.1f} % [{100 * row.low:.1f}, {100 * row.high:.1f}]"
        runs = f"{row.runs}" if row.runs == every else f"{row.runs} of {every}"
        rows.append((row.scenario, row.outcome, share, runs))
    return pd.DataFrame(rows, columns=["scenario", "outcome", "share [95 %]", "runs"])


def how_text(results: Results, plan: PlannedComparisons) -> str:
    """Return for how many comparisons p is corrected, what intervals mean, and whether they may be relied on."""
    many = "1 comparison" if plan.count == 1 else f"{plan.count} comparisons, p corrected for all of them (Holm)"
    planned = "planned" if results.study.compare is not None else "not planned: all pairs of scenarios"
    said = [f"{many}, {planned}", "an effect is shown if p < 0.05, exactly then its interval leaves out no effect"]
    if results.study.replanned:
        said.append("the comparisons were changed when there were runs")
    if not results.complete:
        said.append("runs are missing: to decide by these answers when to stop makes p and intervals wrong")
    elif not results.as_planned:
        said.append("runs were added after others were there: if by what these showed, p and intervals are wrong")
    return "; ".join(said)


def scenario_changes(results: Results) -> pd.DataFrame:
    """Return the keys in which the scenarios differ: one row for each key, one column for each scenario."""
    instance("results", results, Results, "a tissue.study.read.Results")
    values = {name: flat(results.parameters(name).as_dict()) for name in results.study.scenarios}
    table = pd.DataFrame(values, dtype=object).map(str)
    return table[table.nunique(axis=1) > 1].rename_axis("key").reset_index()
