"""Speed against accuracy: what every method costs for the error that it makes, on one problem."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

from dincl import InvalidProblem
from dincl.checks import describe
from verification import cheapest
from verification.budget import Budget
from verification.error_norms import Errors, checked_errors
from verification.measure import COUNTERS, REPEATS, measure
from verification.method import Method, Methods, as_methods
from verification.orders import checked_settings
from verification.references import Known, known_at
from verification.result import Result, left_out, left_out_rows

if TYPE_CHECKING:
    from verification.page.sheet import Axes

TARGETS = (1e-2, 1e-3, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12)
COSTS = ("cpu_seconds", *COUNTERS)
Settings = Sequence[float] | Mapping[str, Sequence[float]]


@dataclass(frozen=True, eq=False, repr=False)
class WorkPrecision(Result):
    """The chart of speed against accuracy.

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
    """

    table: pd.DataFrame
    errors: tuple[str, ...]
    budget: Budget
    looks: dict[str, dict[str, Any]]
    title: str = "Speed against accuracy"
    name: str = "work_precision"

    def cheapest(self, targets: Sequence[float] = TARGETS, error: str = "", cost: str = "cpu_seconds") -> pd.DataFrame:
        """Who reaches each error at the smallest cost: a label, "tie", "at the limit" of the budget, "not reached".

        Or "not resolved": the error is below what the reference can tell.
        Two CPU times count as different only if their ratio exceeds the measured spread; see ``cheapest.rank``.
        """
        found = cheapest.costs(self.table, _checked_targets(targets), self._error(error), _checked_cost(cost))
        return cheapest.rank(found, self.budget.certain() if cost == self.budget.column else float("inf"))

    def costs(self, targets: Sequence[float] = TARGETS, error: str = "", cost: str = "cpu_seconds") -> pd.DataFrame:
        """What each method needs for each error: one row a method, one column a target, NaN where it is not reached."""
        found = cheapest.costs(self.table, _checked_targets(targets), self._error(error), _checked_cost(cost))
        wide = found.pivot(index="method", columns="target", values="value").replace(float("inf"), float("nan"))
        return wide.loc[list(self.looks), sorted(wide, reverse=True)]

    def families(self, targets: Sequence[float] = TARGETS, error: str = "", cost: str = "cpu_seconds") -> pd.DataFrame:
        """The best method of each family for each error, and its cost."""
        found = cheapest.costs(self.table, _checked_targets(targets), self._error(error), _checked_cost(cost))
        there = found[found["value"] < float("inf")].assign(family=lambda rows: rows["method"].map(self._family))
        best = there.sort_values("value").groupby(["target", "family"], sort=False).head(1)
        return best.sort_values(["target", "value"], ascending=[False, True], ignore_index=True)

    def front(self, error: str = "", cost: str = "cpu_seconds") -> pd.DataFrame:
        """The efficient runs: no other has both a smaller error and a smaller cost; from cheap to dear."""
        return cheapest.front(self.table, self._error(error), _checked_cost(cost))

    def plot(self, ax: Axes | None = None, error: str = "", cost: str = "cpu_seconds") -> Axes:
        """Error against cost in logarithms, families by colour; runs that failed are crosses on the upper edge.

        A grey band behind the curves joins the efficient runs, those of ``front``.
        """
        from verification.page.charts import draw_work_precision

        panel = draw_work_precision(self.table, self.looks, self._error(error), _checked_cost(cost), ax)
        panel.set_title(self.title)
        return panel

    def summaries(self) -> dict[str, pd.DataFrame]:
        """Who is the cheapest, and what each method needs."""
        disturbed = int(self.table["disturbed"].sum())
        note = f" {disturbed} of {len(self.table)} measurements were disturbed by other programs." if disturbed else ""
        return {
            f"The cheapest method for each error ({self.errors[0]}), CPU time in seconds.{note}": self.cheapest(),
            "CPU seconds that each method needs for an error (nan: not reached).": self.costs().reset_index(),
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
                *(f"  left out: {name}: {why}" for name, why in left_out(self.table).items()),
            ]
        )

    def _error(self, error: str) -> str:
        if error and error not in self.errors:
            raise InvalidProblem(f"error = {error!r}: must be one of {', '.join(self.errors)}, which were measured")
        return error or self.errors[0]

    def _family(self, label: str) -> str:
        return str(self.looks[label]["family"])


def work_precision(
    problem: Any,
    methods: Methods,
    settings: Settings,
    t: ArrayLike,
    reference: Any,
    budget: Budget,
    errors: Errors = ("largest", "final", "overlap"),
) -> WorkPrecision:
    """Run every method from coarse to fine settings until a run exceeds the budget; errors against cost.

    Parameters
    ----------
    problem, methods, t, reference, errors
        As for ``order_study``.
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
    if not isinstance(budget, Budget):
        raise InvalidProblem(f"budget = {describe(budget)}: must be CpuSeconds(...) or DriftEvaluations(...)")
    chosen, norms = as_methods(methods), checked_errors(errors)
    known = known_at(reference, t, between="dense" in norms)
    rows = [
        row
        for method in chosen
        for row in rows_of(problem, method, settings_of(method, settings), known, norms, budget)
    ]
    looks = {method.label: {"family": method.family} | dict(method.look) for method in chosen}
    return WorkPrecision(pd.DataFrame(rows), tuple(norms), budget, looks)


def rows_of(
    problem: Any, method: Method, settings: Sequence[float], known: Known, errors: Errors, budget: Budget
) -> list[dict[str, Any]]:
    """The rows of one method, as they are in the table of the chart."""
    rows = measure(problem, method, settings, known, errors, budget, REPEATS)
    return [{"method": method.label, "family": method.family} | row for row in rows]


def settings_of(method: Method, settings: Settings) -> tuple[float, ...]:
    """The settings of one method, from coarse to fine."""
    if not isinstance(settings, Mapping):
        return checked_settings(settings)
    name = method.label if method.label in settings else method.setting
    if name not in settings:
        raise InvalidProblem(f"settings has no entry {method.label!r} or {method.setting!r}, which this method needs")
    return checked_settings(settings[name])


def _checked_targets(targets: Sequence[float]) -> tuple[float, ...]:
    found = tuple(float(target) for target in targets)
    if not found or not all(0 < target < float("inf") for target in found):
        raise InvalidProblem(f"targets = {describe(targets)}: must be one or more errors > 0")
    return found


def _checked_cost(cost: str) -> str:
    if cost not in COSTS:
        raise InvalidProblem(f"cost = {cost!r}: must be one of {', '.join(COSTS)}")
    return cost
