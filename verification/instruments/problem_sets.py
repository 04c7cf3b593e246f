"""Speed against accuracy on a set of problems: performance profiles and shifted geometric means."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from verification.instruments import cheapest
from verification.instruments.chart import TARGETS, WorkPrecision, checked_cost, checked_targets
from verification.instruments.result import Result, left_out_rows

if TYPE_CHECKING:
    from verification.site.sheet import Axes

TARGET = 1e-4
# One error for all problems, or name of a problem -> error.
Target = float | Mapping[str, float]


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
            label, wanted = chart.checked_error(error), target[name] if isinstance(target, Mapping) else target
            rows = cheapest.costs(chart.table, checked_targets([wanted]), label, checked_cost(cost))
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

    def means(self, target: Target = TARGET, error: str = "", cost: str = "cpu_seconds") -> pd.DataFrame:
        """Return the shifted geometric mean of each method's costs, over that of the best method, and its failures.

        exp(mean log(cost_p + s)) - s, with the shift s = median over problems of the smallest cost, so that problems
        that everybody solves at once count little. A problem that a method does not solve counts with the largest cost
        of any run on it; a method that solves none has no mean. Columns: ``mean``, ``ratio`` to the best, ``failed``,
        ``of`` problems.
        """
        costs = self.costs(target, error, cost)
        worst = pd.Series({name: self.charts[name].table[cost].max() for name in costs.index}, dtype=float)
        shift = float(costs.min(axis=1).median()) if costs.notna().any(axis=None) else 0.0
        filled = costs.apply(lambda column: column.fillna(worst))
        shift = shift or 1.0  # counted work may be 0
        failed = costs.isna().sum()
        mean = (np.exp(np.log(filled + shift).mean()) - shift).where(failed < len(costs))
        ratio = (mean / mean.min()).where(mean > mean.min(), 1.0).where(mean.notna())
        rows = {"mean": mean, "ratio": ratio, "failed": failed, "of": len(costs)}
        return pd.DataFrame(rows).rename_axis("method").sort_values("mean").reset_index()

    def plot(self, ax: Axes | None = None, target: Target = TARGET, error: str = "", cost: str = "cpu_seconds") -> Axes:
        """Draw the performance profiles."""
        from verification.instruments.charts import draw_profiles

        panel = draw_profiles(self.profile(target, error, cost), self._looks(), cost, ax)
        asked = f"error {target:g}" if isinstance(target, float) else "an error for each problem"
        panel.set_title(f"{self.title}: {asked}")
        return panel

    def summaries(self) -> dict[str, pd.DataFrame]:
        """Return the means for some errors, and the cheapest method for each problem and error."""
        means = pd.concat({target: self.means(target) for target in TARGETS}, names=["target"]).reset_index("target")
        won = {name: chart.cheapest().set_index("target")["cheapest"] for name, chart in self.charts.items()}
        solved = means[means["failed"] < means["of"]]
        return {
            "Shifted geometric means of CPU seconds, and how many problems are not solved.": solved,
            "The cheapest method for each problem and error.": pd.DataFrame(won).T.rename_axis("problem").reset_index(),
        } | left_out_rows(self.table)

    def __repr__(self) -> str:
        best = self.means().head(3)
        lines = [f"  {row.method}: {row.ratio:.3g}, {row.failed} of {row.of} failed" for row in best.itertuples()]
        head = f"WorkPrecisionSet of {len(self.charts)} problems; mean cost of an error of {TARGET:g} over the best"
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


def names_of(problems: Sequence[object] | Mapping[str, object]) -> dict[str, object]:
    """Return name -> problem: the keys, titles of scenes, or numbers from 1 on."""
    if isinstance(problems, Mapping):
        return {str(name): problem for name, problem in problems.items()}
    titles = [str(getattr(problem, "title", "")) for problem in problems]
    unique = [title if title and titles.count(title) == 1 else f"problem {k}" for k, title in enumerate(titles, 1)]
    return dict(zip(unique, problems, strict=True))
