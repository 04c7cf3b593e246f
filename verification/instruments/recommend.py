"""The cheapest method for an error on a problem: a table of forecasts from short runs."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

import dincl
from dincl import InvalidProblem, Problem
from dincl.checks import describe, number
from dincl.checks import times as checked_times
from verification.instruments.budget import GRACE, CpuSeconds
from verification.instruments.measure import measure
from verification.instruments.method import Method, Methods, as_methods
from verification.instruments.references import Known
from verification.instruments.result import Result

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from verification.site.sheet import Axes

# Steps of the first run with equal steps; of each further one twice as many, and of a forecast at most so many times as
# many. Tolerances fall by a factor that makes steps of order two half as long.
FIRST, MOST_GROWTH, FALL = 8, 2**20, 4.0
# The error falls with an order between these in the number of steps; local orders are looked at between so many runs.
ORDERS, LAST = (0.5, 2.0), 3
# Each run may take as long as the scheme of ``dincl.Auto``, and this long [s of CPU time].
LEAST_SECONDS = 0.1
# Tolerance of a projection, relative to the error asked for; with more particles a dense active set costs more than
# conjugate gradients.
PROJECTION, MOST_DENSE = 1e-3, 100


@dataclass(frozen=True, eq=False, repr=False)
class Recommendation(Result):
    """Forecasts of several methods for one error, the cheapest first.

    Attributes
    ----------
    table
        One row for each method: ``method``, ``setting`` (dt or tol), the predicted ``error`` with its interval ``low``
        to ``high`` [length], the predicted ``cpu_seconds`` of the run, ``drift_evaluations`` and ``runs`` of the runs
        that were made to predict it, ``why`` the method is out.
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
        from dincl.plotting import log_ticks
        from verification.site.sheet import own_axes

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
            f"  {row.method}: " + (row.why or f"setting {row.setting:.3g}, {row.cpu_seconds:.2g} s")
            for row in self.table.itertuples()
        ]
        return "\n".join([f"Recommendation for an error of {self.error:g}: {self.best or 'none'}", *lines])


def recommend(problem: Problem, error: float, t: ArrayLike, methods: Methods | None = None) -> Recommendation:
    """Recommend a method and its setting for an error, by short runs of each method.

    ``dincl.Auto(error)`` solves the problem; errors of the other methods are measured against its states, so they are
    known up to its stated error. A method runs with ever finer settings until it has the error, or a run costs more
    than the scheme that ``Auto`` took; then error and cost are extrapolated with the observed order.

    Parameters
    ----------
    problem
        The dincl.Problem.
    error
        Greatest error max_i |X_i - exact| at the output times [length].
    t
        Output times, (K,), increasing.
    methods
        As for ``order_study``; None: the scheme that ``Auto`` took and the usual other ones. The setting of a method is
        dt, or tol.

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
    built_in = usual_methods(problem, wanted)
    chosen = built_in if methods is None else as_methods(methods)
    auto = dincl.solve(problem, dincl.Auto(wanted), times, throw=False)
    if not auto.status or auto.error is None:
        why = f"there is no reference: Auto ended {auto.status.name}: {auto.detail}"
        return Recommendation(pd.DataFrame([_row(method, [], why) for method in chosen]), wanted)
    known = Known(auto.t, auto.x, auto.error)
    stated = float(auto.error.max())
    taken = next(one for one in built_in if one.scheme and isinstance(auto.scheme, type(one.scheme(wanted))))
    setting = getattr(auto.scheme, taken.setting)
    fixed = Method(taken.label, scheme=lambda _: auto.scheme)
    again = measure(problem, fixed, [setting], known, "largest", None, repeats=0)
    seconds = again[0]["cpu_seconds"]
    rows = [
        _row(method, again, "", setting, (0.0, stated, stated + again[0]["largest"]), seconds)
        if method is taken
        else _forecast(problem, method, known, wanted, CpuSeconds(max(seconds, LEAST_SECONDS) / GRACE))
        for method in chosen
    ]
    return Recommendation(pd.DataFrame(sorted(rows, key=lambda row: row["cpu_seconds"])), wanted)


def usual_projection(problem: Problem, tol: float) -> dincl.ActiveSet | dincl.ProjectedCG:
    """Return the cheapest projection for as many particles as a problem has."""
    return dincl.ActiveSet(tol) if len(problem.x0) <= MOST_DENSE else dincl.ProjectedCG(tol)


def usual_methods(problem: Problem, error: float) -> tuple[Method, ...]:
    """Return the five usual methods for a problem and an error; the type of each scheme is another one."""
    projection = usual_projection(problem, PROJECTION * error)
    return (
        Method("PBD", scheme=dincl.PBD),
        Method("linearised catch-up", scheme=lambda dt: dincl.LinearisedCatchUp(dt, projection)),
        Method("midpoint catch-up", scheme=lambda dt: dincl.MidpointCatchUp(dt, projection)),
        Method("adaptive catch-up", scheme=dincl.AdaptiveCatchUp, setting="tol"),
        Method("event-driven", scheme=dincl.EventDriven, setting="tol"),
    )


def _forecast(problem: Problem, method: Method, known: Known, error: float, budget: CpuSeconds) -> dict[str, Any]:
    """Return the row of a method, after runs with ever finer settings until one has the error."""
    stated, name = float(known.error.max()), method.setting
    # The reference's own error is taken off; it is an upper bound that few runs reach, so half of the error is enough.
    target = max(error - stated, error / 2)
    first, finer = (error, FALL) if name == "tol" else (float(known.t[-1]) / FIRST, 2.0)
    settings = [first / finer**k for k in range(int(np.log2(MOST_GROWTH)))]
    rows = measure(problem, method, settings, known, "largest", budget, repeats=0, enough=target)
    runs = [row for k, row in enumerate(rows) if k == 0 or row["status"] != "LEFT_OUT"]
    last = next((row for row in reversed(runs) if row["status"] != "OUT_OF_BUDGET"), None)
    if last is None:
        return _row(method, runs, f"takes more than {budget.limit():.2g} s with {name} = {first:.2g}")
    if last["status"] != "SUCCESS":
        return _row(method, runs, f"{last['status']} with {name} = {last['setting']:.2g}: {last['detail']}")
    found = last["largest"]
    if found <= target:
        return _row(method, runs, "", last["setting"], (found - stated, found, found + stated), last["cpu_seconds"])
    # The error falls with the observed order in the number of steps; their cost grows with them.
    done = [row for row in runs if row["status"] == "SUCCESS"]
    power = 0.5 if name == "tol" else 1.0
    steps = [(done[0]["setting"] / row["setting"]) ** power for row in done]  # over those of the first run
    errors, costs = ([row[column] for row in done] for column in ("largest", "cpu_seconds"))
    recent = pairwise(list(zip(steps, errors, strict=True))[-LAST:])
    local = np.clip([np.log(e / f) / np.log(n / m) for (m, e), (n, f) in recent], *ORDERS)
    growth = np.log(found / target) / (local.mean() if len(local) else np.mean(ORDERS))
    if growth + np.log(steps[-1]) > np.log(MOST_GROWTH):
        return _row(method, runs, f"needs more than {MOST_GROWTH:.0e} times the steps of its first run")
    more, orders = float(np.exp(growth)), local if len(local) > 1 else np.array(ORDERS)
    low, high = (found * more**-order for order in (orders.max(), orders.min()))
    rate = (costs[-1] - costs[0]) / (steps[-1] - steps[0]) if len(done) > 1 else 0.0
    seconds = costs[0] + max(rate, 0.5 * costs[-1] / steps[-1]) * more * steps[-1]
    setting = last["setting"] / more ** (1 / power)
    return _row(method, runs, "", setting, (low - stated, target, high + stated), seconds)


def _row(
    method: Method,
    runs: Sequence[Mapping[str, Any]],
    why: str,
    setting: float = math.nan,
    errors: tuple[float, float, float] = (math.nan,) * 3,
    seconds: float = math.inf,
) -> dict[str, Any]:
    """Return the row of a method from its runs and its forecast; ``errors`` are the least, the predicted, the most."""
    low, error, high = errors
    made = [row for row in runs if row["status"] != "LEFT_OUT"]
    evaluations = int(np.nansum([row["drift_evaluations"] for row in made]))
    row = {"method": method.label, "setting": setting, "error": error, "low": max(low, 0.0), "high": high}
    return row | {"cpu_seconds": seconds, "drift_evaluations": evaluations, "runs": len(made), "why": why}
