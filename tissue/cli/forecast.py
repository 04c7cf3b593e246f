"""Forecast of a study before it is run, ``tissue study --plan``: the effects that it can show."""

from __future__ import annotations

from typing import get_args

import numpy as np
import pandas as pd

from tissue.cli.messages import table
from tissue.study.categories import What
from tissue.study.estimates import ERROR, POWER
from tissue.study.outcomes import emt_count
from tissue.study.plan import PlannedComparisons, TissueStudy, all_pairs

# Correlation of the outcomes of two EMT cells of one run. In the kept studies of chapter 4 with groups of ten cells it
# is below this in 90 % of the ratios from 0.5 % to 99.5 %; in half of them it is below 0.01.
WITHIN_RUN = 0.2
# Shares near which effects are forecast.
NEAR = (0.05, 0.2, 0.5)
PAIRS = (
    "no correlation of runs with the same random numbers: if it is r, the least effects are sqrt(1 - r) times as large"
)


def forecast(study: TissueStudy) -> tuple[PlannedComparisons, pd.DataFrame]:
    """Return what is compared, and the least effects that will be shown with a probability of 80 %.

    The standard error of sum w_i mean_i with n runs of each scenario is sqrt(sum w_i^2 s_i^2/n). The share of a run
    with m EMT cells has the variance s^2 = p (1 - p) (1 + (m - 1) WITHIN_RUN)/m. The test is Student's, of two samples
    with 2 n - 2 degrees of freedom, or of the n differences of paired runs, at 5 % over the number of comparisons, the
    first step of Holm.

    Returns
    -------
    plan, table
        ``question``, ``outcome``, ``measure``, and for each share of NEAR a column with the least difference, or the
        least ratio; of other numbers, such as a height, ``spreads``: the least difference in standard deviations
        between runs.
    """
    from statsmodels.stats.power import TTestIndPower, TTestPower

    plan = study.compare or all_pairs(study.scenarios)
    runs, level = max(2, study.replicates), ERROR / max(1, plan.count)
    if study.paired:
        errors = TTestPower().solve_power(nobs=runs, alpha=level, power=POWER)
    else:
        errors = TTestIndPower().solve_power(nobs1=runs, alpha=level, power=POWER) / np.sqrt(2)
    rows = []
    for outcome, measure in plan.blocks:
        for question, weights in plan.contrasts.items():
            row: dict[str, object] = {"question": question, "outcome": outcome, "measure": measure}
            w = np.array(list(weights.values()))
            if outcome not in get_args(What):
                row["spreads"] = errors * float(np.linalg.norm(w))
            else:
                # At least one cell, so that a share has a spread.
                cells = np.array([max(1, emt_count(study.scenarios[name])) for name in weights])
                for p in NEAR:
                    spreads = np.sqrt(p * (1 - p) * (1 + (cells - 1) * WITHIN_RUN) / cells)
                    least = errors * float(np.linalg.norm(w * spreads))
                    # A share is at most 1: no larger effect can be.
                    effect, most = (np.exp(least / p), 1 / p) if measure == "ratio" else (least, 1.0)
                    row[f"{100 * p:g} %"] = effect if effect <= most else np.inf
            rows.append(row)
    columns = ["question", "outcome", "measure", *(f"{100 * p:g} %" for p in NEAR), "spreads"]
    return plan, pd.DataFrame(rows, columns=columns)


def forecast_text(study: TissueStudy) -> str:
    """Return the least effects that will probably be shown, and what is assumed."""
    compared, effects = forecast(study)
    how = f"{'planned' if study.compare else 'all pairs'}, p corrected for all of them (Holm)"
    assumed = [f"a correlation of {WITHIN_RUN} of the outcomes of two EMT cells of a run", *([PAIRS] * study.paired)]
    head = (
        f"{study.title}\n{study.replicates} runs of each of {len(study.scenarios)} scenarios; {compared.count} "
        f"comparisons, {how}\nAssumed: {'; '.join(assumed)}.\n"
    )
    shown = effects.dropna(axis="columns", how="all")
    heads = [name if name == "spreads" else f"near {name}" for name in shown.columns[3:]]
    rows = [(*row[:3], *(_least(row[2], *one) for one in zip(heads, row[3:], strict=True))) for row in shown.to_numpy()]
    title = "Least effect that is shown with a probability of 80 %, near some shares, or in spreads between runs"
    return f"{head}\n{table(title, ('question', 'outcome', 'measure', *heads), rows)}"


def _least(measure: str, column: str, value: float) -> str:
    if pd.isna(value):
        return ""
    if np.isinf(value):
        return "none"
    if column == "spreads":
        return f"{value:.2f}"
    return f"x {value:.2f}" if measure == "ratio" else f"{100 * value:.1f} points"
