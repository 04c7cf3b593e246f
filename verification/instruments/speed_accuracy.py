"""Measurement of speed against accuracy: every method from coarse to fine settings, on one problem or on several."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, overload

import numpy as np
import pandas as pd

from dincl import InvalidProblem
from dincl.checks import describe
from verification.instruments.budget import Budget
from verification.instruments.chart import WorkPrecision
from verification.instruments.error_norms import Errors, checked_errors
from verification.instruments.measure import REPEATS, measure
from verification.instruments.method import Method, Methods, as_methods
from verification.instruments.orders import checked_settings
from verification.instruments.problem_sets import WorkPrecisionSet, names_of
from verification.instruments.references import Known, known_at

Settings = Sequence[float] | Mapping[str, Sequence[float]]


@overload
def work_precision(
    problem: Sequence[Any] | Mapping[str, Any],
    methods: Methods,
    settings: Settings,
    t: Any,
    reference: Any,
    budget: Budget,
    errors: Errors = ...,
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
) -> WorkPrecision: ...


def work_precision(
    problem: Any,
    methods: Methods,
    settings: Settings,
    t: Any,
    reference: Any,
    budget: Budget,
    errors: Errors = ("largest", "final", "overlap"),
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

    Raises
    ------
    InvalidProblem
        For input outside of what is listed.
    """
    if isinstance(problem, list | tuple | Mapping):
        return _on_each(problem, methods, settings, t, reference, budget, errors)
    if not isinstance(budget, Budget):
        raise InvalidProblem(f"budget = {describe(budget)}: must be CpuSeconds(...) or DriftEvaluations(...)")
    chosen, norms = as_methods(methods), checked_errors(errors)
    known = known_at(reference, t, between="dense" in norms, problem=problem)
    rows = [
        row
        for method in chosen
        for row in rows_of(problem, method, settings_of(method, settings), known, norms, budget)
    ]
    looks = {method.label: {"family": method.family} | dict(method.look) for method in chosen}
    return WorkPrecision(pd.DataFrame(rows), tuple(norms), budget, looks, reference=known.words)


def _on_each(
    problems: Sequence[Any] | Mapping[str, Any],
    methods: Methods,
    settings: Settings,
    t: Any,
    reference: Any,
    *rest: Any,
) -> WorkPrecisionSet:
    named = names_of(problems)
    if not named:
        raise InvalidProblem("problem is an empty list: must hold one or more problems")
    references = _one_each("reference", reference, list(named))
    shared = not isinstance(t, Mapping) and all(np.ndim(one) == 0 for one in np.atleast_1d(np.asarray(t, object)))
    times = dict.fromkeys(named, t) if shared else _one_each("t", t, list(named))
    charts = {
        name: work_precision(one, methods, settings, times[name], references[name], *rest)
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


def rows_of(
    problem: Any, method: Method, settings: Sequence[float], known: Known, errors: Errors, budget: Budget
) -> list[dict[str, Any]]:
    """Return the rows of one method in the table of the chart."""
    rows = measure(problem, method, settings, known, errors, budget, REPEATS)
    return [{"method": method.label, "family": method.family} | row for row in rows]


def settings_of(method: Method, settings: Settings) -> tuple[float, ...]:
    """Return the settings of one method, from coarse to fine."""
    if not isinstance(settings, Mapping):
        return checked_settings(settings)
    name = method.label if method.label in settings else method.setting
    if name not in settings:
        raise InvalidProblem(f"settings has no entry {method.label!r} or {method.setting!r}, which this method needs")
    return checked_settings(settings[name])
