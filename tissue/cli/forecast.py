"""The text of ``tissue study --plan``: the least effects that will be shown, and the time of the runs."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import pandas as pd

from tissue.cli.messages import table

if TYPE_CHECKING:
    from tissue.study.plan import TissueStudy
    from tissue.study.planned import PlannedComparisons

MAKES_NO_NUMBERS = True


def forecast_text(plan: TissueStudy) -> str:
    """Return the least effects that will probably be shown, and the time that the runs take."""
    from tissue.study.forecast import forecast

    compared, effects = forecast(plan)
    runs = f"{plan.replicates} runs of each of {len(plan.scenarios)} scenarios"
    how = f"{'planned' if plan.compare else 'all pairs'}, 95 % for all together ({compared.correction})"
    head = f"{plan.title}\n{runs}; {compared.count} comparisons, {how}"
    return "\n".join([head, _assumed(plan, compared), _effects(effects), _times(plan)])


def _assumed(plan: TissueStudy, compared: PlannedComparisons) -> str:
    """Return how many independent observations a run is taken for."""
    from tissue.study.forecast import WITHIN_RUN, effective_cells

    cells = dict.fromkeys(f"{effective_cells(plan, name):.1f}" for name in compared.scenarios)
    assumed = f"a correlation of {WITHIN_RUN} of the outcomes of two, which 9 of 10 kept ratios of chapter 4 are below"
    return f"The EMT cells of a run count as {', '.join(cells)} independent ones: {assumed}\n"


def _effects(effects: pd.DataFrame) -> str:
    """Return the table of the least effects; columns without numbers are left out."""
    shown = effects.dropna(axis="columns", how="all")
    near = [name for name in shown if str(name).endswith("%")]
    rows = [
        (*row[:3], *(_least(str(name), value, row[2]) for name, value in zip(shown.columns[3:], row[3:], strict=True)))
        for row in shown.to_numpy()
    ]
    heads = [f"near {name}" if name in near else "in spreads between runs" for name in shown.columns[3:]]
    title = "Least effect that is shown with a probability of 80 %"
    title += ", where ratios are near what is above it" if near else ""
    return table(title, ("question", "outcome", "measure", *heads), rows)


def _least(column: str, value: float, measure: str) -> str:
    if pd.isna(value):
        return ""
    if column == "spreads":
        return f"{value:.2f}"
    return f"x {value:.2f}" if measure == "ratio" else f"{100 * value:.1f} points"


def _times(plan: TissueStudy) -> str:
    """Return how long all runs take on this machine and on more workers, measured by a few of them."""
    from tissue.study.forecast import duration, measured_costs, useful_workers, worker_numbers

    costs, cores = measured_costs(plan), len(os.sched_getaffinity(0))
    least = "" if all(one.whole for one in costs.values()) else "at least "
    most, each = useful_workers(plan), sorted(one.seconds for one in costs.values())
    span = f"{each[0]:.2g} s" if each[-1] < 1.1 * each[0] else f"{each[0]:.2g} to {each[-1]:.2g} s"
    rows = [
        (f"{number}{', this machine' * (number == cores)}", least + _long(duration(plan, costs, number)))
        for number in worker_numbers(cores, most)
    ]
    title = f"Time of {plan.runs} runs of {least}{span} each, in {most} pieces: more workers than these do not help"
    return table(title, ("workers", "time"), rows)


def _long(seconds: float) -> str:
    """Return a time in a unit that is read easily."""
    for name, unit in (("days", 86400), ("h", 3600), ("min", 60)):
        if seconds >= 2 * unit:
            return f"{seconds / unit:.1f} {name}"
    return f"{seconds:.1f} s" if seconds < 10 else f"{seconds:.0f} s"
