"""The simplest model that answers a question of a study as the full model does, by paired equivalence tests.

That a difference is not shown does not say that two models answer alike. Here the hypothesis that is refuted is a
difference of at least the tolerance. The unit is the run: cells of one run are not independent.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import nullcontext
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple, get_args

import numpy as np
import pandas as pd
from scipy.special import stdtr, stdtrit

from dincl.checks import describe, integer, number
from dincl.checks import path as checked_path
from dincl.errors import InvalidProblem
from dincl.study import Study
from tissue.files.parameters import Parameters
from tissue.runs.registration import own_code
from tissue.study.categories import CONTROL_SIDES, What, run_values
from tissue.study.estimates import Floats, holm
from tissue.study.outcomes import emt_count, outcomes
from tissue.study.plan import TissueStudy, load_study, outcome_names, run_seeds
from tissue.study.simplifications import KINDS, applicable, simplified
from tissue.study.store import refuse_others

Outcome = str | Callable[[pd.DataFrame, float], pd.Series]
NAME, FULL, AND = "simplify", "the full model", " + "
# Probability that "equivalent" is said of any model that is not; half of it for single ones, half for the combination.
ERROR = 0.05
# Runs of one piece of work; the first replicate of the combination, which no simplification was chosen by.
BLOCK, FRESH = 32, 1_000_000


@dataclass(frozen=True)
class Simplified:
    """Answer of ``simplify``.

    Attributes
    ----------
    table
        One row for each simplification alone, then one for their combination: ``model``, ``verdict``, ``difference``,
        ``low``, ``high`` (simpler minus full, with its interval), ``p`` (adjusted), ``work`` (substeps times cells of a
        run, over those of the full model), ``runs``, ``reason`` (of a model whose runs fail). The verdict is
        "equivalent", "different", where the interval is outside of the tolerance, or "open".
    answer
        The simplifications that together are equivalent; empty: none is shown to be, so take the full model.
    left_out
        The simplifications that were not tried, with the reason.
    """

    table: pd.DataFrame
    answer: tuple[str, ...]
    left_out: Mapping[str, str]

    @property
    def saving(self) -> float:
        """Counted work of a run of the full model over that of the answer; 1 without an answer."""
        mine = self.table.loc[self.table["model"] == AND.join(self.answer), "work"]
        return 1.0 / float(mine.iloc[-1]) if self.answer else 1.0

    def parameters(self, full: Parameters) -> Parameters:
        """Return the parameters of a scenario, simplified as the answer says."""
        return simplified(full, self.answer)


def simplify(
    study: str | os.PathLike[str],
    tolerance: float,
    *,
    outcome: Outcome = "basal",
    scenarios: Sequence[str] = (),
    at: str | None = None,
    runs: int = 256,
    out: str | os.PathLike[str] | None = None,
) -> Simplified:
    """Find the simplest model that answers a question of a study as the full model does.

    Each simplification runs beside the full model with the same seeds, and is decided by the paired differences of its
    runs: two one-sided tests, corrected by Holm. Of those that are equivalent, those that save the most work are
    combined, one of a kind, while their differences add up to at most half of the tolerance; the combination is tested
    with fresh seeds. If it is not equivalent, the answer is the single one that saves the most work. The answer
    is wrong with a probability of at most 5 %.

    Parameters
    ----------
    study
        The file of the study, or the name of one that comes with the program.
    tolerance
        The largest difference that does not matter: of shares a part, 0.03 for 3 points; of lengths um.
    outcome
        "basal", "apical", "below": the share of EMT cells; or a number of a run, such as "height_um"; or a function of
        the table of EMT cells and the end [h], a number for each cell, whose mean over the cells of a run is asked.
    scenarios
        One of the study, or two: the first minus the second. Empty: its first one.
    at
        When it is asked, such as "48 h"; None: at the end.
    runs
        Of each model, 16 at least.
    out
        The folder of the table of runs, new or empty, from which the same call goes on; None: it is not kept.

    Raises
    ------
    InvalidProblem
        If the study or an argument is not in order, ``out`` holds something else, or most runs of the full model fail.
    """
    plan = load_study(study)
    if out is not None:
        refuse_others(checked_path("out", out), "simplification", NAME)
    full = _asked(plan, scenarios, outcome, at)
    shares = not callable(outcome) and outcome in (*get_args(What), *CONTROL_SIDES)
    if number("tolerance", tolerance, positive=True) >= 1 and shares:
        raise InvalidProblem(f"tolerance = {tolerance:g}: must be below 1 for shares, such as 0.03 for 3 points")
    integer("runs", runs, least=16, most=FRESH)
    reasons = applicable(full.values())
    tried = [name for name in KINDS if not reasons[name]]
    texts = {name: parameters.as_toml() for name, parameters in full.items()}
    settings = {"outcome": outcome, "seed": plan.seed, "scenarios": texts, **own_code()}
    run = partial(measure, full, outcome, plan.seed)

    with (
        TemporaryDirectory() if out is None else nullcontext(checked_path("out", out)) as folder,
        ThreadPoolExecutor(len(os.sched_getaffinity(0))) as threads,
    ):

        def decided(models: Sequence[str], first: int) -> list[dict[str, Any]]:
            keys = tuple(
                {"model": model, "scenario": scenario, "first": begin}
                for begin in range(first, first + runs, BLOCK)
                for model in (FULL, *models)
                for scenario in full
            )
            title, unit = f"{len(models)} simplifications", "batches"
            made = Study(NAME, title, ("model", "scenario", "first"), keys, run, settings, unit=unit)
            rows = made.complete(Path(folder), threads)
            return _compared(rows[rows["replicate"] < first + runs], models, list(full), tolerance, shares)

        rows = decided(tried, 0)
        answer = _chosen(rows, tolerance)
        if len(answer) > 1:
            rows += decided([AND.join(answer)], FRESH)
            if rows[-1]["verdict"] != "equivalent":
                answer = answer[:1]
    return Simplified(pd.DataFrame(rows), answer, {name: reason for name, reason in reasons.items() if reason})


def measure(
    scenarios: Mapping[str, Parameters], what: Outcome, seed: int, key: Mapping[str, Any]
) -> list[Mapping[str, Any]]:
    """Run a block of replicates of a model in a scenario: a row for each, with the value NaN for one that failed.

    ``work`` counts substeps times the mean of the numbers of cells at the start and at the end. The seeds are those of
    the scenario, whatever the model.
    """
    names = [] if key["model"] == FULL else key["model"].split(AND)
    parameters = simplified(scenarios[key["scenario"]], names)
    end, steps = parameters.t_end, parameters.t_end / parameters.numerics.dt.value * parameters.numerics.substeps
    replicates = range(key["first"], key["first"] + BLOCK)
    found = outcomes(parameters, replicates, run_seeds(seed, key["scenario"], replicates))
    cells, runs = found.cells.to_pandas(), found.runs.to_pandas()
    if callable(what):
        each = what(cells, end)
        if not (isinstance(each, pd.Series) and len(each) == len(cells) and np.isfinite(each.to_numpy(float)).all()):
            raise InvalidProblem(
                f"outcome returned {describe(each)}: must be a Series of a finite number for each cell"
            )
        values = each.groupby(cells["replicate"]).mean()
    else:
        values = run_values(cells, runs, what, end)
    runs = runs.set_index("replicate")
    work = steps * (emt_count(parameters) + (runs["controls_0h"] + runs[f"controls_{end:g}h"]) / 2)
    status = runs["status"].astype(str)
    return [
        {**key, "replicate": k, "value": values.get(k, np.nan), "work": work[k], "status": status[k]}
        for k in replicates
    ]


class Equivalence(NamedTuple):
    """Mean difference of pairs of runs, and the test that it is smaller than a tolerance."""

    difference: float
    low: float  # interval of the mean: the true one is beyond each end with the probability ``level``
    high: float
    p: float  # of both one-sided tests the larger one


def equivalence(differences: Floats, tolerance: float, *, shares: bool, level: float) -> Equivalence:
    """Test whether two models differ by less than a tolerance e, from their differences in n runs.

    The ends of the interval are d -+ (t s/sqrt(n) + c/n), t the quantile of Student's distribution with n - 1 degrees
    of freedom. For numbers c = 0, which is ``statsmodels.stats.weightstats.ttost_paired``. Shares need more care, as
    rare runs with a large effect may not have been seen at all: with a difference of e, values 0, 1 and -1 have a
    variance of at least e (1 - e), so s^2 is not taken below this, and c = 1/2 is the correction for continuity.

    Parameters
    ----------
    differences
        Finite, of two runs at least.
    tolerance
        > 0, in the same unit; below 1 for shares.
    shares
        Whether outcomes are shares from 0 to 1, or numbers without bounds.
    level
        Probability of each end of the interval.

    Source
    ------
    D. J. Schuirmann, A comparison of the two one-sided tests procedure and the power approach for assessing the
    equivalence of average bioavailability, Journal of Pharmacokinetics and Biopharmaceutics 15 (1987).
    """
    n, mean, variance = len(differences), float(differences.mean()), float(differences.var(ddof=1))
    if shares:
        variance = max(variance, tolerance * (1 - tolerance))
    error, correction = math.sqrt(variance / n), 0.5 / n if shares else 0.0
    margin = tolerance - abs(mean) - correction
    p = float(stdtr(n - 1, -margin / error)) if error else float(margin <= 0)
    half = float(-stdtrit(n - 1, level)) * error + correction
    return Equivalence(mean, mean - half, mean + half, p)


def _asked(plan: TissueStudy, scenarios: Sequence[str], outcome: Outcome, at: str | None) -> dict[str, Parameters]:
    """Return the parameters of the scenarios that are asked, which end when it is asked."""
    names = list(scenarios) or [next(iter(plan.scenarios))]
    if not (len(names) == len({*names}) <= 2 and {*names} <= plan.scenarios.keys()):
        allowed = f"a list of one or two of {', '.join(plan.scenarios)}"
        raise InvalidProblem(f"scenarios = {describe(scenarios)}: must be {allowed}")
    if not callable(outcome) and outcome not in outcome_names():
        raise InvalidProblem(f"outcome = {describe(outcome)}: must be one of {', '.join(outcome_names())}")
    if callable(outcome) or outcome in get_args(What):
        for name in names:
            if not emt_count(plan.scenarios[name]):
                raise InvalidProblem(f"scenario {describe(name)}: must have EMT cells for this outcome")
    ends = {name: at or f"{plan.scenarios[name].t_end!r} h" for name in names}
    return {name: plan.scenarios[name].changed({"numerics.t_end": t, "numerics.keep": t}) for name, t in ends.items()}


def _compared(
    rows: pd.DataFrame, models: Sequence[str], scenarios: Sequence[str], tolerance: float, shares: bool
) -> list[dict[str, Any]]:
    """Return the row of each model, by the runs of which the full model did not fail.

    ``rows``: those of ``measure``. Of two scenarios the value is that of the first minus that of the second.
    """
    table = rows.set_index(["replicate", "model", "scenario"]).unstack(["model", "scenario"])
    values, works = table["value"], table["work"]
    value = {m: values[m, scenarios[0]] - sum(values[m, one] for one in scenarios[1:]) for m in (FULL, *models)}
    work = {m: sum(works[m, one] for one in scenarios).median() for m in (FULL, *models)}
    sound, found = value[FULL].notna(), []
    if sound.sum() < len(sound) / 2:
        _refuse_failed(rows[rows["model"] == FULL])
    for name in models:
        pairs = (value[name] - value[FULL])[sound]
        failed = int(pairs.isna().sum())
        tested = Equivalence(np.nan, np.nan, np.nan, p=1.0)
        if not failed:
            tested = equivalence(pairs.to_numpy(), tolerance, shares=shares, level=ERROR / 2)
        reason = f"{failed} of its runs fail" if failed else ""
        row = {"model": name, "verdict": "", **tested._asdict(), "work": float(work[name] / work[FULL])}
        found.append(row | {"runs": len(pairs), "reason": reason})
    for row, p in zip(found, holm([row["p"] for row in found])[0].tolist(), strict=True):
        outside = row["reason"] or row["low"] > tolerance or row["high"] < -tolerance
        row |= {"p": p, "verdict": "equivalent" if p < ERROR / 2 else "different" if outside else "open"}
    return found


def _refuse_failed(rows: pd.DataFrame) -> None:
    """Say how the runs of the full model fail."""
    failed = rows.loc[rows["value"].isna(), "status"]
    many = f"all {len(rows)}" if len(failed) == len(rows) else f"{len(failed)} of {len(rows)}"
    if (failed == "FOLDED").all():
        raise InvalidProblem(
            f"{many} runs of the full model are folded, so that heights and positions mean nothing: at most half of "
            'them may be; ask at an earlier time, or keep them with numerics.folded = "keep"'
        )
    how = ", ".join(f"{count} {status}" for status, count in failed.value_counts().items())
    raise InvalidProblem(f"{many} runs of the full model fail, {how}: must be half of them at most")


def _chosen(rows: list[dict[str, Any]], tolerance: float) -> tuple[str, ...]:
    """Choose of each kind one that is equivalent, first those that save the most.

    Their differences add up to at most half of the tolerance; the other half is left to the spread of the runs.
    """
    chosen, total = dict[str, str](), 0.0
    enough = [row for row in rows if row["verdict"] == "equivalent"]
    for row in sorted(enough, key=lambda row: (round(row["work"], 2), abs(row["difference"]))):
        kind, larger = KINDS[row["model"]], total + abs(row["difference"])
        if not chosen or (kind not in chosen and larger <= tolerance / 2):
            chosen[kind], total = row["model"], larger
    return tuple(chosen.values())
