"""The chart of speed against accuracy of one problem: who is cheapest, the front, costs of methods and families."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from dincl import InvalidProblem
from dincl.checks import describe
from verification.instruments import cheapest
from verification.instruments.budget import Budget
from verification.instruments.measure import COUNTERS
from verification.instruments.result import Result, left_out, left_out_rows

if TYPE_CHECKING:
    from verification.site.sheet import Axes

TARGETS = (1e-2, 1e-3, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12)
COSTS = ("cpu_seconds", *COUNTERS)


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
        found = cheapest.costs(self.table, checked_targets(targets), self.checked_error(error), checked_cost(cost))
        return cheapest.rank(found, self.budget.certain() if cost == self.budget.column else float("inf"))

    def costs(self, targets: Sequence[float] = TARGETS, error: str = "", cost: str = "cpu_seconds") -> pd.DataFrame:
        """Return the cost of each error: one row a method, one column a target, NaN where it is not reached."""
        found = cheapest.costs(self.table, checked_targets(targets), self.checked_error(error), checked_cost(cost))
        wide = found.pivot(index="method", columns="target", values="value").replace(float("inf"), float("nan"))
        return wide.reindex(list(self.looks))[sorted(wide, reverse=True)]

    def families(self, targets: Sequence[float] = TARGETS, error: str = "", cost: str = "cpu_seconds") -> pd.DataFrame:
        """Return the best method of each family for each error, and its cost."""
        found = cheapest.costs(self.table, checked_targets(targets), self.checked_error(error), checked_cost(cost))
        there = found[found["value"] < float("inf")].assign(family=lambda rows: rows["method"].map(self._family))
        best = there.sort_values("value").groupby(["target", "family"], sort=False).head(1)
        return best.sort_values(["target", "value"], ascending=[False, True], ignore_index=True)

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

    def output(self) -> pd.DataFrame:
        """Return what output at all times adds, as a part of the integration: median and largest of each method."""
        done = self.table[self.table["status"] == "SUCCESS"]
        part = done["output_seconds"] / done["cpu_seconds"]
        return part.groupby(done["method"], sort=False).agg(["median", "max"]).reset_index()

    def summaries(self) -> dict[str, pd.DataFrame]:
        """Return the cheapest method for each error, the cost of each method, and what output adds."""
        disturbed = int(self.table["disturbed"].sum())
        note = f" {disturbed} of {len(self.table)} measurements were disturbed by other programs." if disturbed else ""
        return {
            f"The cheapest method for each error ({self.errors[0]}), CPU time in seconds.{note}": self.cheapest(),
            "CPU seconds of integration for each error (—: not reached).": self.costs().reset_index(),
            "What output adds, as a part of the integration: median and largest of all runs.": self.output(),
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

    def _family(self, label: str) -> str:
        return str(self.looks[label]["family"])


def checked_targets(targets: Sequence[float]) -> tuple[float, ...]:
    """Return one or more errors > 0; InvalidProblem for others."""
    found = tuple(float(target) for target in targets)
    if not found or not all(0 < target < float("inf") for target in found):
        raise InvalidProblem(f"targets = {describe(targets)}: must be one or more errors > 0")
    return found


def checked_cost(cost: str) -> str:
    """Return the name of a column of costs; InvalidProblem for another."""
    if cost not in COSTS:
        raise InvalidProblem(f"cost = {cost!r}: must be one of {', '.join(COSTS)}")
    return cost
