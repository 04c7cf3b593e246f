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
    from verification.page.sheet import Axes

TARGET = 1e-4


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

    def costs(self, target: float = TARGET, error: str = "", cost: str = "cpu_seconds") -> pd.DataFrame:
        """Return the cost of an error: one row a problem, one column a method, NaN where it is not reached.

        Problems whose reference does not resolve the error are left out.
        """
        found = {}
        for name, chart in self.charts.items():
            label = chart.checked_error(error)
            rows = cheapest.costs(chart.table, checked_targets([target]), label, checked_cost(cost))
            if rows["resolved"].all():
                found[name] = rows.set_index("method")["value"].replace(np.inf, np.nan)
        return pd.DataFrame(found, index=list(self._looks())).T

    def profile(self, target: float = TARGET, error: str = "", cost: str = "cpu_seconds") -> pd.DataFrame:
        """Return performance profiles: the ``share`` of problems that a method solves within ``ratio`` of the best.

        See ``profiles``.
        """
        return profiles(self.costs(target, error, cost))

    def means(self, target: float = TARGET, error: str = "", cost: str = "cpu_seconds") -> pd.DataFrame:
        """Return the shifted geometric mean of each method's costs, over that of the best method, and its failures.

        exp(mean log(cost_p + s)) - s, with the shift s = median over problems of the smallest cost, so that problems
        that everybody solves at once count little. A problem that a method does not solve counts with the largest cost
        of any run on it. Columns: ``mean``, ``ratio`` to the best, ``failed``, ``of`` problems.
        """
        costs = self.costs(target, error, cost)
        worst = pd.Series({name: self.charts[name].table[cost].max() for name in costs.index}, dtype=float)
        shift = float(costs.min(axis=1).median()) if costs.notna().any(axis=None) else 0.0
        filled = costs.apply(lambda column: column.fillna(worst))
        mean = np.exp(np.log(filled + shift).mean()) - shift
        rows = {"mean": mean, "ratio": mean / mean.min(), "failed": costs.isna().sum(), "of": len(costs)}
        return pd.DataFrame(rows).rename_axis("method").sort_values("mean").reset_index()

    def plot(self, ax: Axes | None = None, target: float = TARGET, error: str = "", cost: str = "cpu_seconds") -> Axes:
        """Draw the performance profiles for one error."""
        from verification.instruments.charts import draw_profiles

        panel = draw_profiles(self.profile(target, error, cost), self._looks(), ax)
        panel.set_title(f"{self.title}: error {target:g}")
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


def profiles(costs: pd.DataFrame) -> pd.DataFrame:
    """Return performance profiles of costs: one row a problem, one column a method, NaN where it is not solved.

    rho_m(r) = |{p : cost_pm <= r min_k cost_pk}| / |{p}|; rows are the ratios where a share changes. Source: Dolan
    and Moré, Benchmarking optimization software with performance profiles, Math. Program. 91 (2002), (2.1).
    """
    ratios = costs.div(costs.min(axis=1), axis=0)
    rows = [
        {"method": method, "ratio": ratio, "share": (ratios[method] <= ratio).sum() / max(len(costs), 1)}
        for method in costs
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
