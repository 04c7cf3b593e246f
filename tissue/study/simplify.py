"""The simplest model that answers a question: simplifications beside the full model, decided by equivalence tests."""

from __future__ import annotations

import os
import time
from collections.abc import Mapping, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from contextlib import nullcontext
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, cast, get_args

import numpy as np
import pandas as pd

from dincl.checks import path as checked_path
from dincl.compiled.lanes import WIDTH
from dincl.errors import InvalidProblem
from dincl.study import Study
from tissue.files.parameters import Parameters
from tissue.statistics.categories import What, outcome
from tissue.statistics.equivalence import LOOKS, equivalence
from tissue.study.elimination import AND, Row, Simplest, compared, search
from tissue.study.outcomes import outcomes
from tissue.study.plan import TissueStudy, load_study, run_seeds
from tissue.study.planned import SHARES
from tissue.study.question import ModelQuestion, Outcome, asked
from tissue.study.simplifications import KINDS, applicable, simplified

FULL = "the full model"
# Runs of one piece of work; the first run of a combination, whose seeds no simplification alone was decided by.
BLOCK, FRESH = LOOKS[0], 1_000_000


@dataclass(frozen=True)
class Simplified(Simplest):
    """Answer of ``simplify``: the simplest model, and the question that it answers."""

    question: ModelQuestion

    def parameters(self, full: Parameters) -> Parameters:
        """Return the simplest parameters that are enough, of those of a scenario."""
        return simplified(full, self.answer)


def simplify(
    study: str | os.PathLike[str],
    tolerance: float | None = None,
    *,
    outcome: Outcome | None = None,
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
    question = asked(plan, {name: value for name, value in given.items() if value is not None}, str(study))
    with (
        TemporaryDirectory() if out is None else nullcontext(checked_path("out", out)) as folder,
        ThreadPoolExecutor(len(os.sched_getaffinity(0))) as threads,
    ):
        runs_made = _Runs(plan, question, Path(folder), threads)
        found = search(runs_made, KINDS, applicable(runs_made.scenarios.values()))
        return Simplified(found.table, found.answer, question)


def measure(
    scenarios: Mapping[str, Parameters], what: Outcome, seed: int, key: Mapping[str, Any]
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


def _values(cells: pd.DataFrame, runs: pd.DataFrame, what: Outcome, end: float) -> dict[int, float]:
    """Return the outcome of each run that did not fail, by its replicate."""
    sound = runs[runs["status"] == "SUCCESS"].set_index("replicate")
    if not isinstance(what, str) or what in get_args(What):
        each = outcome(cells, cast(What, what), end) if isinstance(what, str) else what(cells, end)
        found = each.groupby(cells["replicate"]).mean()
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
        settings = {"outcome": self.question.name, "seed": self._seed, "scenarios": texts}
        title = f"{len(models)} simpler models, look after {runs} runs, by {BLOCK}"
        calls = (self.question.outcome,) if callable(self.question.outcome) else ()
        study = Study("simplify", title, ("model", "scenario", "first"), keys, run, settings, calls)
        self._rows = (
            study.complete(self._folder, self._executor).set_index(["model", "scenario", "replicate"]).sort_index()
        )

    def decide(self, models: Sequence[str], error: float, *, again: bool) -> list[Row]:
        """Look at the models again and again, until they are decided or have all of their runs."""
        first, most = (FRESH, 2 * self.question.runs) if again else (0, self.question.runs)
        found: dict[str, Row] = {}
        for look in LOOKS:
            open_ones = [model for model in models if found.get(model, {"verdict": "open"})["verdict"] == "open"]
            if not open_ones or look > most:
                break
            self.complete(open_ones, first, look)
            found |= {model: self.compared(model, first, look, error / len(LOOKS)) for model in open_ones}
        return [found[model] for model in models]

    def compared(self, model: str, first: int, runs: int, level: float) -> Row:
        """Return the row of a model: verdict, bias with its interval, cost."""
        sides = {name: self._combined(name, first, runs) for name in (FULL, model)}
        full, simple = sides[FULL]["value"], sides[model]["value"]
        pairs = (simple - full)[full.notna()]
        if len(pairs) < BLOCK // 2:
            raise InvalidProblem(f"{len(full) - len(pairs)} of {len(full)} runs of the full model fail: must be fewer")
        one, reason = None, ""
        if failed := int(pairs.isna().sum()):
            reason = f"{failed} of its runs fail"
        else:
            one = equivalence(pairs.to_numpy(float), self.question.tolerance, shares=self.question.shares, level=level)
        cpu, work = (
            float(sides[model][column].median() / sides[FULL][column].median()) for column in ("seconds", "work")
        )
        return compared(model, one, cpu=cpu, work=work, runs=len(pairs), reason=reason)

    def _combined(self, model: str, first: int, runs: int) -> pd.DataFrame:
        """Return value, seconds and work of each run: of one scenario, or of the first minus the second of two.

        Seconds and work are those of both together.
        """
        each = [self._rows.loc[(model, name)].loc[first : first + runs - 1] for name in self.scenarios]
        values = each[0]["value"] if len(each) == 1 else each[0]["value"] - each[1]["value"]
        return pd.DataFrame({"value": values, **{name: sum(one[name] for one in each) for name in ("seconds", "work")}})
