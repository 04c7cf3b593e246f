"""The simplest model that answers a question: simplifications beside the full model, decided by equivalence tests."""

from __future__ import annotations

import os
import time
from collections.abc import Mapping, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from contextlib import nullcontext
from dataclasses import dataclass
from functools import partial
from itertools import groupby
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, get_args

import numpy as np
import pandas as pd

from dincl.checks import path as checked_path
from dincl.compiled.lanes import WIDTH
from dincl.errors import InvalidProblem
from dincl.study import Study
from tissue.files.parameters import Parameters
from tissue.statistics.categories import What, outcome
from tissue.statistics.equivalence import ERROR, LOOKS, Equivalence, equivalence
from tissue.study.outcomes import outcomes
from tissue.study.plan import TissueStudy, load_study, run_seeds
from tissue.study.planned import SHARES
from tissue.study.question import ModelQuestion, asked
from tissue.study.simplifications import AND, KINDS, applicable, simplified

FULL = "the full model"
# Runs of one piece of work; the first run of a combination, whose seeds no simplification alone was decided by.
BLOCK, FRESH = LOOKS[0], 1_000_000
COLUMNS = ["model", "parts", "step", "verdict", "bias", "low", "high", "runs", "missing", "cpu", "work", "reason"]


@dataclass(frozen=True)
class Simplified:
    """Answer of ``simplify``.

    Attributes
    ----------
    question
        What was asked.
    table
        One row for each simplification alone, then for each combination that was tried, in this order. ``model``,
        ``parts`` (of a combination), ``step`` ("alone", "together"), ``verdict`` ("enough", "not enough", "open", "left
        out"), ``bias``, ``low``, ``high`` (simpler minus full, with the interval that decides), ``runs`` of each,
        ``missing`` runs until it will probably be decided, ``cpu`` and ``work``: CPU time and counted work of a run
        over those of the full model, ``reason`` why it was left out or is not enough.
    answer
        The simplifications that together are enough; empty: none is, and the full model is needed.
    """

    question: ModelQuestion
    table: pd.DataFrame
    answer: tuple[str, ...]

    @property
    def model(self) -> str:
        """The answer as one name, that of its row."""
        return AND.join(self.answer)

    @property
    def saving(self) -> tuple[float, float]:
        """CPU time and counted work of a run of the full model over those of the answer."""
        if not self.answer:
            return 1.0, 1.0
        row = self.table[self.table["model"] == self.model].iloc[-1]
        return 1 / float(row["cpu"]), 1 / float(row["work"])

    def parameters(self, full: Parameters) -> Parameters:
        """Return the simplest parameters that are enough, of those of a scenario."""
        return simplified(full, self.answer)


def simplify(
    study: str | os.PathLike[str],
    tolerance: float | None = None,
    *,
    outcome: str | None = None,
    scenarios: Sequence[str] | None = None,
    at: str | None = None,
    runs: int | None = None,
    out: str | os.PathLike[str] | None = None,
) -> Simplified:
    """Find the simplest model that answers a question of a study as the full model does.

    Each simplification runs beside the full model with the same seeds, and is decided by the paired differences of runs
    (``tissue.statistics.equivalence``). One looks after 64, 128, ... runs, at most ``runs``, and stops a model once it
    is decided; "enough" is said of one whose bias is the tolerance in at most 5 % of the cases. Those that are enough
    are combined, the cheapest of each kind, and the combination runs with fresh seeds, up to twice as many. While it is
    not enough, the one with the largest bias is dropped. The k-th combination has 5 %/2^k as its error, so that the
    answer is wrong in at most 5 % of the cases.

    Parameters
    ----------
    study
        The file of the study, or the name of one that comes with the program.
    tolerance, outcome, scenarios, at, runs
        As of ``ModelQuestion``; "at" with its unit, such as "48 h". None: as its section [simplify] says, or "basal" of
        the first scenario at the end, with at most 1,024 runs. The tolerance must be given in one of the two.
    out
        The folder of the table of runs, from which the same call goes on; None: it is not kept.

    Raises
    ------
    InvalidProblem
        If the study or the question is not in order, or runs of the full model fail.
    """
    plan = load_study(study)
    given = {"outcome": outcome, "scenarios": scenarios, "tolerance": tolerance, "at": at, "runs": runs}
    question = asked(plan, {name: value for name, value in given.items() if value is not None})
    with (
        TemporaryDirectory() if out is None else nullcontext(checked_path("out", out)) as folder,
        ThreadPoolExecutor(len(os.sched_getaffinity(0))) as threads,
    ):
        return _answer(_Runs(plan, question, Path(folder), threads))


def measure(
    scenarios: Mapping[str, Parameters], what: str, seed: int, key: Mapping[str, Any]
) -> list[Mapping[str, Any]]:
    """Run a block of replicates of a model in a scenario: a row for each, NaN for one that failed.

    ``seconds`` is CPU time of this thread for one of eight runs side by side; ``work`` counts substeps times the mean
    of the numbers of cells at the start and at the end.
    """
    names = [] if key["model"] == FULL else key["model"].split(AND)
    parameters = simplified(scenarios[key["scenario"]], names)
    numerics, rows = parameters.numerics, list[Mapping[str, Any]]()
    steps = parameters.t_end / numerics.dt.value * numerics.substeps
    followed = sum(group.scenario.cells for group in parameters.groups() if group.may_leave)
    for first in range(key["first"], key["first"] + BLOCK, WIDTH):
        replicates = range(first, first + WIDTH)
        began = time.thread_time()
        cells, runs, _ = outcomes(parameters, replicates, run_seeds(seed, key["scenario"], replicates))
        seconds = (time.thread_time() - began) / WIDTH
        values = _values(cells.to_pandas(), runs.to_pandas(), what, parameters.t_end)
        table = runs.to_pandas().set_index("replicate")
        mean = followed + (table["controls_0h"] + table[f"controls_{parameters.t_end:g}h"]).astype(float) / 2
        rows += [
            {**key, "replicate": k, "value": values.get(k, np.nan), "seconds": seconds, "work": steps * mean[k]}
            for k in replicates
        ]
    return rows


def _values(cells: pd.DataFrame, runs: pd.DataFrame, what: Any, end: float) -> dict[int, float]:
    """Return the outcome of each run that did not fail, by its replicate."""
    sound = runs[runs["status"] == "SUCCESS"].set_index("replicate")
    if what in get_args(What):
        found = outcome(cells, what, end).groupby(cells["replicate"]).mean()
        found = found[found.index.isin(sound.index)]
    elif what in SHARES:
        found = sound[f"controls_{SHARES[what]}_{end:g}h"] / sound[f"controls_{end:g}h"]
    else:
        found = sound[f"{what}_{end:g}h"]
    return {int(k): float(value) for k, value in found.items()}


class _Runs:
    """Runs of models of a question, made as they are needed, in one table that can be resumed."""

    def __init__(self, plan: TissueStudy, question: ModelQuestion, folder: Path, executor: Executor) -> None:
        self.question, self._seed, self._folder, self._executor = question, plan.seed, folder, executor
        self.scenarios = {name: question.of(plan.scenarios[name]) for name in question.scenarios}
        self._rows = pd.DataFrame()

    def complete(self, models: Sequence[str], first: int, runs: int) -> None:
        """Make the first so many runs of some models and of the full one, from a replicate on."""
        keys = tuple(
            {"model": model, "scenario": scenario, "first": begin}
            for begin in range(first, first + runs, BLOCK)
            for model in (FULL, *models)
            for scenario in self.scenarios
        )
        run = partial(measure, self.scenarios, self.question.outcome, self._seed)
        texts = {name: parameters.as_toml() for name, parameters in self.scenarios.items()}
        settings = {"outcome": self.question.outcome, "seed": self._seed, "scenarios": texts}
        title = f"{len(models)} simpler models, look after {runs} runs, by {BLOCK}"
        study = Study("simplify", title, ("model", "scenario", "first"), keys, run, settings)
        self._rows = (
            study.complete(self._folder, self._executor).set_index(["model", "scenario", "replicate"]).sort_index()
        )

    def compared(self, model: str, first: int, runs: int, level: float) -> dict[str, Any]:
        """Return the row of a model: verdict, bias with its interval, cost."""
        sides = {name: self._combined(name, first, runs) for name in (FULL, model)}
        full, simple = sides[FULL]["value"], sides[model]["value"]
        pairs = (simple - full)[full.notna()]
        if len(pairs) < BLOCK // 2:
            raise InvalidProblem(f"{len(full) - len(pairs)} of {len(full)} runs of the full model fail: must be fewer")
        cost = {
            name: float(sides[model][column].median() / sides[FULL][column].median())
            for name, column in (("cpu", "seconds"), ("work", "work"))
        }
        row: dict[str, Any] = {"model": model, "parts": model.count(AND) + 1, "runs": len(pairs), **cost, "reason": ""}
        if failed := int(pairs.isna().sum()):
            return {**row, "verdict": "not enough", "reason": f"{failed} of its runs fail"}
        one = equivalence(pairs.to_numpy(float), self.question.tolerance, shares=self.question.shares, level=level)
        return {**row, **_said(one)}

    def _combined(self, model: str, first: int, runs: int) -> pd.DataFrame:
        """Return value, seconds and work of each run: of one scenario, or of the first minus the second of two.

        Seconds and work are those of both together.
        """
        each = [self._rows.loc[(model, name)].loc[first : first + runs - 1] for name in self.scenarios]
        values = each[0]["value"] if len(each) == 1 else each[0]["value"] - each[1]["value"]
        return pd.DataFrame({"value": values, **{name: sum(one[name] for one in each) for name in ("seconds", "work")}})


def _said(one: Equivalence) -> dict[str, Any]:
    return {"verdict": one.verdict, "bias": one.bias, "low": one.low, "high": one.high, "missing": one.missing}


def _decided(runs: _Runs, models: Sequence[str], first: int, most: int, error: float) -> list[dict[str, Any]]:
    """Look at the models again and again, until they are decided or have all of their runs."""
    found: dict[str, dict[str, Any]] = {}
    for look in LOOKS:
        open_ones = [model for model in models if found.get(model, {"verdict": "open"})["verdict"] == "open"]
        if not open_ones or look > most:
            break
        runs.complete(open_ones, first, look)
        found |= {model: runs.compared(model, first, look, error / len(LOOKS)) for model in open_ones}
    return [found[model] for model in models]


def _answer(runs: _Runs) -> Simplified:
    """Decide each simplification alone, then combinations, by backward elimination."""
    reasons, most = applicable(runs.scenarios.values()), runs.question.runs
    alone = _decided(runs, [name for name, reason in reasons.items() if not reason], 0, most, ERROR)
    rows = [{**row, "step": "alone"} for row in alone]
    enough = sorted((row for row in alone if row["verdict"] == "enough"), key=lambda row: KINDS[row["model"]])
    each = [min(ones, key=lambda row: row["cpu"]) for _, ones in groupby(enough, key=lambda row: KINDS[row["model"]])]
    left, error = {row["model"]: abs(row["bias"]) for row in each}, ERROR
    answer: tuple[str, ...] = ()
    while left and not answer:
        names, error = tuple(name for name in KINDS if name in left), error / 2
        (row,) = _decided(runs, [AND.join(names)], FRESH, 2 * most, error)
        rows.append({**row, "step": "together"})
        if row["verdict"] == "enough":
            answer = names
        else:
            del left[max(left, key=lambda name: left[name])]
    rows += [
        {"model": name, "parts": 1, "step": "alone", "verdict": "left out", "reason": reason}
        for name, reason in reasons.items()
        if reason
    ]
    table = pd.DataFrame(rows, columns=COLUMNS).astype({"missing": "Int64", "runs": "Int64"})
    return Simplified(runs.question, table, answer)
