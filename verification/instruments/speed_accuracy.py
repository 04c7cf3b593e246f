"""Measurement of speed against accuracy: every method from coarse to fine settings, on one problem or on several."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from pathlib import Path
from typing import Any, overload

import numpy as np
import pandas as pd

from dincl import InvalidProblem
from dincl.checks import describe
from dincl.study import Study
from verification.instruments.budget import Budget
from verification.instruments.chart import WorkPrecision
from verification.instruments.error_norms import Errors, checked_errors
from verification.instruments.ladders import Ladders
from verification.instruments.measure import REPEATS
from verification.instruments.method import Methods, as_methods
from verification.instruments.orders import Settings, settings_of
from verification.instruments.problem_sets import WorkPrecisionSet, names_of
from verification.instruments.references import proved_words
from verification.instruments.stored import Store, carried_out

# Settings of a method in the smallest form.
SMALLEST = 2


@dataclass(frozen=True, eq=False)
class WorkPrecisionRuns:
    """What ``work_precision`` runs on one problem, apart from what it makes of the rows; the arguments are the same.

    After a run whose largest error is at most ``enough`` no finer setting of its method is tried.
    """

    problem: Any
    methods: Methods
    settings: Settings
    t: Any
    reference: Any
    budget: Budget
    errors: Errors = ("largest", "final", "overlap")
    enough: float | None = None

    def __post_init__(self) -> None:
        if not isinstance(self.budget, Budget):
            raise InvalidProblem(f"budget = {describe(self.budget)}: must be CpuSeconds(...) or DriftEvaluations(...)")

    def study(
        self, name: str = "work_precision", title: str = "Speed against accuracy", smallest: bool = False
    ) -> Study:
        """Return the runs; in the smallest form those of the two coarsest settings of each method."""
        return self._ladders(smallest).study(name, title)

    def _ladders(self, smallest: bool) -> Ladders:
        chosen, norms = as_methods(self.methods), checked_errors(self.errors)
        ladders = {one.label: settings_of(one, self.settings)[: SMALLEST if smallest else None] for one in chosen}
        more = (norms, self.budget, REPEATS, self.enough)
        return Ladders(self.problem, chosen, ladders, self.t, self.reference, *more)

    def result(self, rows: pd.DataFrame) -> WorkPrecision:
        """Return the chart of rows of the study, of the complete one or of some of its runs."""
        ladders = self._ladders(smallest=False)
        table = ladders.sorted(rows)
        looks = {label: look for label, look in ladders.looks.items() if label in set(table["method"])}
        words = proved_words(self.reference, lambda: ladders.known)
        return WorkPrecision(table, tuple(ladders.errors), self.budget, looks, reference=words)


@overload
def work_precision(
    problem: Sequence[Any] | Mapping[str, Any],
    methods: Methods,
    settings: Settings,
    t: Any,
    reference: Any,
    budget: Budget,
    errors: Errors = ...,
    *,
    store: Store = ...,
    executor: Executor | None = ...,
    smallest: bool = ...,
) -> WorkPrecisionSet: ...


@overload
def work_precision(
    problem: Any,
    methods: Methods,
    settings: Settings,
    t: Any,
    reference: Any,
    budget: Budget,
    errors: Errors = ...,
    *,
    store: Store = ...,
    executor: Executor | None = ...,
    smallest: bool = ...,
) -> WorkPrecision: ...


def work_precision(
    problem: Any,
    methods: Methods,
    settings: Settings,
    t: Any,
    reference: Any,
    budget: Budget,
    errors: Errors = ("largest", "final", "overlap"),
    *,
    store: Store = None,
    executor: Executor | None = None,
    smallest: bool = False,
) -> WorkPrecision | WorkPrecisionSet:
    """Run every method from coarse to fine settings until a run exceeds the budget; return errors against cost.

    Parameters
    ----------
    problem, methods, t, reference, errors
        As for ``order_study``. For a list of problems, or a mapping from names to them, ``reference`` is a list or a
        mapping of as many, and ``t`` serves all or is one, too; the result then has a chart for each problem, and their
        averages.
    settings
        Steps or tolerances > 0; or a mapping from labels of methods, or from "dt" and "tol", to them.
    budget
        Of one run: ``CpuSeconds(2.0)`` or ``DriftEvaluations(10**5)``. Wall time is no budget: it depends on what else
        the machine does. A program that never calls the drift is not stopped; after it, nothing finer is tried.
    store, executor
        A Parquet file that makes an interrupted call go on, method by method, for several problems a folder with a file
        for each; who makes the runs: see ``carried_out``.
    smallest
        Only the two coarsest settings of each method.

    Raises
    ------
    InvalidProblem
        For input outside of what is listed.
    """
    if isinstance(problem, list | tuple | Mapping):
        return _on_each(problem, methods, settings, t, reference, budget, errors, store, executor, smallest)
    runs = WorkPrecisionRuns(problem, methods, settings, t, reference, budget, errors)
    return runs.result(carried_out(runs.study(smallest=smallest), store, executor, apart=smallest))


def _on_each(
    problems: Sequence[Any] | Mapping[str, Any],
    methods: Methods,
    settings: Settings,
    t: Any,
    reference: Any,
    budget: Budget,
    errors: Errors,
    store: Store,
    executor: Executor | None,
    smallest: bool,
) -> WorkPrecisionSet:
    named = names_of(problems)
    if not named:
        raise InvalidProblem("problem is an empty list: must hold one or more problems")
    references = _one_each("reference", reference, list(named))
    shared = not isinstance(t, Mapping) and all(np.ndim(one) == 0 for one in np.atleast_1d(np.asarray(t, object)))
    times = dict.fromkeys(named, t) if shared else _one_each("t", t, list(named))
    files = dict.fromkeys(named) if store is None else {name: Path(store) / f"{name}.parquet" for name in named}
    charts = {
        name: work_precision(
            one,
            methods,
            settings,
            times[name],
            references[name],
            budget,
            errors,
            store=files[name],
            executor=executor,
            smallest=smallest,
        )
        for name, one in named.items()
    }
    return WorkPrecisionSet(charts)


def _one_each(argument: str, given: Any, names: list[str]) -> dict[str, Any]:
    """Return name of a problem -> its entry of an argument."""
    if isinstance(given, Mapping) and set(given) == set(names):
        return dict(given)
    if isinstance(given, list | tuple) and len(given) == len(names):
        return dict(zip(names, given, strict=True))
    raise InvalidProblem(f"{argument} = {describe(given)}: must have one entry for each problem: {', '.join(names)}")
