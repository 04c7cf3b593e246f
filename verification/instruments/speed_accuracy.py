"""Speed against accuracy: every method from coarse to fine settings, its chart, and charts of several problems."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from dincl import InvalidProblem
from dincl.checks import describe
from dincl.study import Study
from verification.instruments import cheapest
from verification.instruments.budget import Budget
from verification.instruments.error_norms import Errors, checked_errors
from verification.instruments.ladders import Ladders
from verification.instruments.measure import COUNTERS, REPEATS
from verification.instruments.method import Methods, as_methods
from verification.instruments.orders import Settings, settings_of
from verification.instruments.references import proved_words
from verification.instruments.result import Result, left_out, left_out_rows
from verification.instruments.stored import Store, carried_out

if TYPE_CHECKING:
    from verification.site.sheet import Axes

# Settings of a method in the smallest form.
SMALLEST = 2
TARGETS = (1e-2, 1e-3, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12)
COSTS = ("cpu_seconds", *COUNTERS)
TARGET = 1e-4
# One error for all problems, or name of a problem -> error.
Target = float | Mapping[str, float]


@dataclass(frozen=True, eq=False, repr=False)
class WorkPrecision(Result):
    """Errors against costs of several methods on one problem.

    Attributes
    ----------
    table
        One row for each method and setting: family, status, errors, ``cpu_seconds`` of the integration (the shortest of
        ``repeats``) with ``spread`` (median over shortest), ``output_seconds`` (what all output times add),
        ``disturbed`` (the run waited for the processor), counted work.
    errors
        Names of the errors, the first is drawn.
    budget
        Of one run.
    looks
        label -> family and keywords of matplotlib.
    reference
        The error of the reference in words, if it is proved.
    """

    table: pd.DataFrame
    errors: tuple[str, ...]
    budget: Budget
    looks: dict[str, dict[str, Any]]
    title: str = "Speed against accuracy"
    name: str = "work_precision"
    reference: str = ""

    def cheapest(self, targets: Sequence[float] = TARGETS, error: str = "", cost: str = "cpu_seconds") -> pd.DataFrame:
        """Return which method reaches each error at the smallest cost.

        A label; "tie"; "at the limit" of the budget; "not reached"; or "not resolved", where the error is below that of
        the reference. Two CPU times differ only if their ratio exceeds the measured spread; see ``cheapest.rank``.
        """
        found = self.prices(targets, error, cost)
        return cheapest.rank(found, self.budget.certain() if cost == self.budget.column else float("inf"))

    def prices(self, targets: Sequence[float], error: str = "", cost: str = "cpu_seconds") -> pd.DataFrame:
        """Return the table of ``cheapest.costs``; InvalidProblem unless targets are one or more errors > 0."""
        wanted = tuple(float(target) for target in targets)
        if not wanted or not all(0 < target < float("inf") for target in wanted):
            raise InvalidProblem(f"targets = {describe(targets)}: must be one or more errors > 0")
        return cheapest.costs(self.table, wanted, self.checked_error(error), checked_cost(cost))

    def costs(self, targets: Sequence[float] = TARGETS, error: str = "", cost: str = "cpu_seconds") -> pd.DataFrame:
        """Return the cost of each error: one row a method, one column a target, NaN where it is not reached."""
        wide = self.prices(targets, error, cost).pivot(index="method", columns="target", values="value")
        wide = wide.replace(float("inf"), float("nan"))
        return wide.reindex(list(self.looks))[sorted(wide, reverse=True)]

    def front(self, error: str = "", cost: str = "cpu_seconds") -> pd.DataFrame:
        """Return the efficient runs by increasing cost: no other has both a smaller error and a smaller cost."""
        return cheapest.front(self.table, self.checked_error(error), checked_cost(cost))

    def plot(self, ax: Axes | None = None, error: str = "", cost: str = "cpu_seconds") -> Axes:
        """Draw error against cost on logarithmic axes, one colour a family; failed runs are crosses on the upper edge.

        A grey band behind the curves joins the runs of ``front``.
        """
        from verification.instruments.charts import draw_work_precision

        panel = draw_work_precision(self.table, self.looks, self.checked_error(error), checked_cost(cost), ax)
        panel.set_title(self.title)
        panel.set_ylabel(", ".join(filter(None, (panel.get_ylabel(), self.reference))))
        return panel

    def summaries(self) -> dict[str, pd.DataFrame]:
        """Return the cheapest method for each error, the cost of each method, and what output adds."""
        done, disturbed = self.table[self.table["status"] == "SUCCESS"], int(self.table["disturbed"].sum())
        note = f" {disturbed} of {len(self.table)} measurements were disturbed by other programs." if disturbed else ""
        part = (done["output_seconds"] / done["cpu_seconds"]).groupby(done["method"], sort=False)
        output = part.agg(["median", "max"])
        return {
            f"The cheapest method for each error ({self.errors[0]}), CPU time in seconds.{note}": self.cheapest(),
            "CPU seconds of integration for each error (—: not reached).": self.costs().reset_index(),
            "What output adds, as a part of the integration: median and largest of all runs.": output.reset_index(),
        } | left_out_rows(self.table)

    def __repr__(self) -> str:
        won = self.cheapest()
        nobody = {word: won["cheapest"] == word for word in (cheapest.NOT_REACHED, cheapest.NOT_RESOLVED)}
        reached = won[~np.any(list(nobody.values()), axis=0)]
        lines = [f"  {row.target:g}: {row.cheapest}" for row in reached.itertuples()]
        missed = {word: ", ".join(f"{target:g}" for target in won.loc[here, "target"]) for word, here in nobody.items()}
        return "\n".join(
            [
                f"WorkPrecision of {len(self.looks)} methods; cheapest by CPU time at an error of",
                *lines,
                *(f"  {word}: {targets}" for word, targets in missed.items() if targets),
                *([f"  errors {self.reference}"] if self.reference else []),
                *(f"  left out: {name}: {why}" for name, why in left_out(self.table).items()),
            ]
        )

    def checked_error(self, error: str) -> str:
        """Return the error, the first of the chart for ""; InvalidProblem if it was not measured."""
        if error and error not in self.errors:
            raise InvalidProblem(f"error = {error!r}: must be one of {', '.join(self.errors)}, which were measured")
        return error or self.errors[0]


def checked_cost(cost: str) -> str:
    """Return the name of a column of costs; InvalidProblem for another."""
    if cost not in COSTS:
        raise InvalidProblem(f"cost = {cost!r}: must be one of {', '.join(COSTS)}")
    return cost


@dataclass(frozen=True, eq=False, repr=False)
class WorkPrecisionSet(Result):
    """Charts of speed against accuracy of several problems, and their averages.

    Attributes
    ----------
    charts
        Name of the problem -> its chart.
    """

    charts: Mapping[str, WorkPrecision]
    title: str = "Speed against accuracy on several problems"
    name: str = "work_precision_set"

    @property
    def table(self) -> pd.DataFrame:
        """The rows of all charts, with the problem as the first column."""
        tables = {name: chart.table for name, chart in self.charts.items()}
        return pd.concat(tables, names=["problem"]).reset_index("problem").reset_index(drop=True)

    def costs(self, target: Target = TARGET, error: str = "", cost: str = "cpu_seconds") -> pd.DataFrame:
        """Return the cost of an error: one row a problem, one column a method, NaN where it is not reached.

        ``target`` is the error, or a mapping from names of problems to the error that is asked for in each. Problems
        whose reference does not resolve the error are left out.
        """
        return self._prices(target, error, cost)["value"]

    def ratios(self, target: Target = TARGET, error: str = "", cost: str = "cpu_seconds") -> pd.DataFrame:
        """Return the costs over the least one of each problem, and exactly 1 for those that tie with it.

        A tie, as in ``WorkPrecision.cheapest``: the ratio does not exceed the spread of the repeated measurements of
        either; counted work has no spread. NaN where the error is not reached.
        """
        prices = self._prices(target, error, cost)
        costs, spreads = prices["value"], prices["spread"]
        over = costs.div(costs.min(axis=1), axis=0)
        best = spreads.where(over == 1).max(axis=1)
        return over.where(over > spreads.clip(lower=best, axis=0), 1.0).where(costs.notna())

    def _prices(self, target: Target, error: str, cost: str) -> dict[str, pd.DataFrame]:
        """Return values and spreads of ``cheapest.Price``: one row a problem, one column a method."""
        parts: dict[str, dict[str, pd.Series]] = {"value": {}, "spread": {}}
        for name, chart in self.charts.items():
            rows = chart.prices([target[name] if isinstance(target, Mapping) else target], error, cost)
            if rows["resolved"].all():
                rows = rows.set_index("method")
                for part, found in parts.items():
                    found[name] = rows[part].where(np.isfinite(rows["value"]))
        return {part: pd.DataFrame(found, index=list(self._looks())).T for part, found in parts.items()}

    def profile(self, target: Target = TARGET, error: str = "", cost: str = "cpu_seconds") -> pd.DataFrame:
        """Return performance profiles: the ``share`` of problems that a method solves within ``ratio`` of the best.

        Costs that tie with the least one count as the best; see ``ratios`` and ``profiles``.
        """
        return profiles(self.ratios(target, error, cost))

    def plot(self, ax: Axes | None = None, target: Target = TARGET, error: str = "", cost: str = "cpu_seconds") -> Axes:
        """Draw the performance profiles."""
        from verification.instruments.charts import draw_profiles

        panel = draw_profiles(self.profile(target, error, cost), self._looks(), cost, ax)
        asked = f"error {target:g}" if isinstance(target, float) else "an error for each problem"
        panel.set_title(f"{self.title}: {asked}")
        return panel

    def summaries(self) -> dict[str, pd.DataFrame]:
        """Return the cheapest method for each problem and error."""
        won = {name: chart.cheapest().set_index("target")["cheapest"] for name, chart in self.charts.items()}
        table = pd.DataFrame(won).T.rename_axis("problem").reset_index()
        return {"The cheapest method for each problem and error.": table} | left_out_rows(self.table)

    def __repr__(self) -> str:
        best = (self.ratios() == 1).mean()
        lines = [f"  {method}: {share:.0%}" for method, share in best.sort_values(ascending=False).items()]
        head = (
            f"WorkPrecisionSet of {len(self.charts)} problems; shares on which a method is the cheapest at {TARGET:g}"
        )
        return "\n".join([head, *lines])

    def _looks(self) -> dict[str, dict[str, object]]:
        looks: dict[str, dict[str, object]] = {}
        for chart in self.charts.values():
            looks |= chart.looks
        return looks


def profiles(ratios: pd.DataFrame) -> pd.DataFrame:
    """Return performance profiles of ratios: one row a problem, one column a method, NaN where it is not solved.

    rho_m(r) = |{p : ratio_pm <= r}| / |{p}|, ratio_pm = cost_pm / min_k cost_pk; rows are the ratios where a share
    changes. Source: Dolan and Moré, Benchmarking optimization software with performance profiles, Math. Program. 91
    (2002), (2.1).
    """
    rows = [
        {"method": method, "ratio": ratio, "share": (ratios[method] <= ratio).sum() / max(len(ratios), 1)}
        for method in ratios
        for ratio in [1.0, *np.sort(ratios[method].dropna().unique())]
    ]
    return pd.DataFrame(rows, columns=["method", "ratio", "share"]).drop_duplicates(ignore_index=True)


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
) -> WorkPrecision:
    """Run every method from coarse to fine settings until a run exceeds the budget; return errors against cost.

    Parameters
    ----------
    problem, methods, t, reference, errors
        As for ``order_study``. Charts of several problems make a ``WorkPrecisionSet``.
    settings
        Steps or tolerances > 0; or a mapping from labels of methods, or from "dt" and "tol", to them.
    budget
        Of one run: ``CpuSeconds(2.0)`` or ``DriftEvaluations(10**5)``. Wall time is no budget: it depends on what else
        the machine does. A program that never calls the drift is not stopped; after it, nothing finer is tried.
    store, executor
        A Parquet file that makes an interrupted call go on, method by method; who makes the runs: see ``carried_out``.

    Raises
    ------
    InvalidProblem
        For input outside of what is listed.
    """
    runs = WorkPrecisionRuns(problem, methods, settings, t, reference, budget, errors)
    return runs.result(carried_out(runs.study(), store, executor))
