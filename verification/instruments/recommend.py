"""The cheapest method for an error on a problem: a table of forecasts from short runs."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, cast

import numpy as np
import pandas as pd

from dincl import InvalidProblem, Problem, RunOutcome, Scheme
from dincl.checks import describe, number
from dincl.checks import times as checked_times
from dincl.schemes.auto import Choice
from dincl.schemes.pilots import Candidate, candidates
from verification.instruments.method import Failure, Method, Methods, SchemeOf, as_methods, attempted, made_scheme
from verification.instruments.result import Result

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from verification.page.sheet import Axes

# The order that a method of the user may have at most.
MOST_ORDER = 2


@dataclass(frozen=True, eq=False, repr=False)
class Recommendation(Result):
    """Forecasts of several methods for one error, the cheapest first.

    Attributes
    ----------
    table
        One row for each method: ``method``, ``setting`` (dt or tol), the predicted ``error`` with its interval ``low``
        to ``high`` [length], the predicted ``cpu_seconds`` of the run, ``drift_evaluations`` and ``runs`` of its pilot
        runs, ``why`` it is out.
    error
        The error asked for [length].
    """

    table: pd.DataFrame
    error: float
    title: str = "Recommended methods"
    name: str = "recommendation"

    @property
    def best(self) -> str:
        """The label of the cheapest method; "" if none reaches the error."""
        first = self.table.iloc[0]
        return str(first["method"]) if np.isfinite(first["cpu_seconds"]) else ""

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the predicted cost of each method that reaches the error."""
        from dincl.drawing import log_ticks
        from verification.page.sheet import own_axes

        panel = own_axes(ax)
        there = self.table[np.isfinite(self.table["cpu_seconds"])].iloc[::-1]
        panel.barh(there["method"], there["cpu_seconds"])
        panel.set(title=f"{self.title} for an error of {self.error:g}", xlabel="predicted CPU time [s]", xscale="log")
        log_ticks(panel)
        return panel

    def summaries(self) -> dict[str, pd.DataFrame]:
        """Return the forecasts."""
        return {f"Forecasts for an error of {self.error:g}.": self.table}

    def __repr__(self) -> str:
        lines = [
            f"  {row.method}: " + (row.why or f"{row.setting:.3g}, {row.cpu_seconds:.2g} s")
            for row in self.table.itertuples()
        ]
        return "\n".join([f"Recommendation for an error of {self.error:g}: {self.best or 'none'}", *lines])


def recommend(problem: Problem, error: float, t: ArrayLike, methods: Methods | None = None) -> Recommendation:
    """Recommend a method and its setting for an error, by short runs of each method.

    Parameters
    ----------
    problem
        The dincl.Problem.
    error
        Greatest error max_i |X_i - exact| at the output times [length].
    t
        Output times, (K,), increasing.
    methods
        As for ``order_study``, only schemes; None: those of ``dincl.Auto``. The setting of a method is dt, or tol for
        one that takes the error itself.

    Raises
    ------
    InvalidProblem
        For input outside of what is listed.
    """
    if not isinstance(problem, Problem):
        raise InvalidProblem(f"problem = {describe(problem)}: must be a dincl.Problem")
    wanted, times = number("error", error, positive=True), checked_times("t", t)
    if times[-1] == 0:
        raise InvalidProblem(f"t = {describe(t)}: must be increasing times >= 0, the last one > 0")
    chosen = candidates(problem, wanted) if methods is None else tuple(map(_candidate, as_methods(methods)))
    choice = Choice(problem, times, wanted, chosen)
    choice.refine()
    runs = {pilot.candidate.label: pilot.outcomes for pilot in choice.pilots}
    rows: list[dict[str, Any]] = []
    spent = {pilot.candidate.label: pilot.seconds[-1] for pilot in choice.pilots if pilot.seconds and pilot.is_done()}
    # The cost of the whole run, also where a pilot run has the error already.
    forecasts = [found._replace(seconds=spent.get(found.label, found.seconds)) for found in choice.forecasts]
    for found in sorted(forecasts, key=lambda one: one.seconds):
        made = runs.get(found.label, [])
        rows.append(
            {"method": found.label, "setting": found.setting, "error": found.error, "low": found.low}
            | {"high": found.high, "cpu_seconds": found.seconds, "runs": len(made)}
            | {"drift_evaluations": sum(one.stats.drift_evaluations for one in made), "why": found.why}
        )
    return Recommendation(pd.DataFrame(rows), wanted)


def _candidate(method: Method) -> Candidate:
    if method.scheme is None:
        raise InvalidProblem(f"method {method.label!r}: must be a function setting -> Scheme, not a program")
    return Candidate(method.label, partial(_guarded, method), 0 if method.setting == "tol" else MOST_ORDER)


@dataclass(frozen=True)
class _Guarded(Scheme):
    """A scheme of the user, whose run raises InvalidProblem for any Exception: a method that fails is out, no more."""

    label: str
    scheme: Scheme

    def run(self, problem: Problem, times: NDArray[np.float64]) -> RunOutcome:
        found = _passed(attempted(self.scheme.run, problem, times), self.label)
        if not isinstance(found, RunOutcome):
            raise InvalidProblem(f"method {self.label!r}: its run returned {describe(found)}: must be a RunOutcome")
        return found


def _guarded(method: Method, setting: float) -> Scheme:
    made = _passed(attempted(cast("SchemeOf", method.scheme), setting), method.label)
    return _Guarded(method.label, made_scheme(method.label, made, f"{setting:g}"))


def _passed(found: Any, label: str) -> Any:
    if isinstance(found, Failure):
        raise InvalidProblem(f"method {label!r} {found.status}: {found.detail}")
    return found
