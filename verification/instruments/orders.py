"""Orders of convergence: methods on one problem over a ladder of settings, with local orders and fitted slopes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

from dincl import InvalidProblem
from verification.instruments.budget import Budget
from verification.instruments.error_norms import Errors, checked_errors, reference_error
from verification.instruments.measure import measure
from verification.instruments.method import Methods, as_methods
from verification.instruments.order import MIN_STEPS, Order, estimate, order_text
from verification.instruments.references import known_at
from verification.instruments.result import Result, left_out

if TYPE_CHECKING:
    from verification.page.sheet import Axes

# What a setting is, by its name in ``Method``.
SETTINGS = {"dt": "step dt [time]", "tol": "tolerance [length]"}


@dataclass(frozen=True, eq=False, repr=False)
class OrderStudy(Result):
    """Errors against the setting, and the slope of each curve.

    Attributes
    ----------
    table
        One row for each method and setting: status, errors, counted work; ``role`` of the row in the fit of the first
        error ("used", "pre-asymptotic", "floor", "failed"), and the local order ``slope`` from the next coarser row,
        with its sign; ``slope_...`` of the other errors.
    fits
        One row for each method and error: ``order`` in words, the fitted ``slope``, the range of the local orders with
        their trend ``low``, ``high``, whether they have ``settled``, ``floor`` (what of the error was covered),
        ``failed`` runs, and the ``verdict`` as a sentence. The range is no confidence interval: see ``Order``.
    errors
        Names of the errors, the first is drawn.
    looks
        label -> keywords of matplotlib.
    setting
        What the settings are: the label of the axis.
    reference
        The error of the reference in words, if it is proved.
    """

    table: pd.DataFrame
    fits: pd.DataFrame
    errors: tuple[str, ...]
    looks: dict[str, dict[str, Any]]
    setting: str = SETTINGS["dt"]
    title: str = "Order of convergence"
    name: str = "orders"
    reference: str = ""

    def plot(self, ax: Axes | None = None, error: str = "") -> Axes:
        """Draw log error against log setting; rows that the fit left out are hollow, failed ones crosses."""
        from verification.instruments.charts import draw_orders

        panel = draw_orders(self.table, self.fits, self.looks, error or self.errors[0], self.setting, ax)
        panel.set_title(self.title)
        panel.set_ylabel(", ".join(filter(None, (panel.get_ylabel(), self.reference))))
        return panel

    def summaries(self) -> dict[str, pd.DataFrame]:
        """Return the fits."""
        fits = self.fits[["method", "error", "order", "failed", "verdict"]]
        failed = self.table[self.table["status"] != "SUCCESS"]
        columns = ["method", "setting", "status", "detail"]
        return {"Slopes with the range of the local orders.": fits} | (
            {"Runs without an error.": failed[columns]} if len(failed) else {}
        )

    def __repr__(self) -> str:
        rows = self.fits.itertuples()
        lines = [f"  {row.method}, {row.error}: {row.order}" for row in rows]
        why = [f"  left out: {name}: {reason}" for name, reason in left_out(self.table).items()]
        shown = [f"  errors {self.reference}"] if self.reference else []
        return "\n".join([f"OrderStudy of {self.table['method'].nunique()} methods", *lines, *shown, *why])


def order_study(
    problem: Any,
    methods: Methods,
    settings: Sequence[float],
    t: ArrayLike,
    reference: Any,
    errors: Errors = ("largest", "final"),
    budget: Budget | None = None,
) -> OrderStudy:
    """Run every method with every setting, and fit error = C h^p on the asymptotic part of each curve.

    Parameters
    ----------
    problem
        A dincl.Problem, or whatever the methods can run.
    methods
        label -> (setting -> Scheme), or a list of Method.
    settings
        Steps or tolerances > 0, five at least, in any order [time or length].
    t
        Times at which states are compared, increasing.
    reference
        ``reference(problem, tol)``, a function t -> exact states, a Known, or an array (K, N, d).
    errors
        Of max_i |X_i - exact| [length]: the "largest" over t, the "final" one at the last t, "L2", its root mean square
        over time, "dense", the largest of dense output between the times, too. "overlap": max max(0, -g) over t. A
        function of the state (N, d), such as a height or an energy: the largest error of its values over t. Several of
        these, or a mapping from names to them.
    budget
        Of one run: CpuSeconds or DriftEvaluations. Finer settings than one that exceeds it are left out.

    Raises
    ------
    InvalidProblem
        For fewer than five settings, unknown names of errors, objects that are not methods, times that do not increase.
    """
    chosen, norms = as_methods(methods), checked_errors(errors)
    names = tuple(norms)
    ladder = checked_settings(settings, least=MIN_STEPS)
    known = known_at(reference, t, between="dense" in names, problem=problem)
    rows = [row for method in chosen for row in measure(problem, method, ladder, known, norms, budget, repeats=0)]
    table, fits = pd.DataFrame(rows), []
    untried = left_out(table)
    for method in chosen:
        mine = table["method"] == method.label
        orders = {name: order_of(table[mine], name) for name in names}
        found = {name: _fit(order) | _untried(untried.get(method.label)) for name, order in orders.items()}
        fits += [{"method": method.label, "error": name} | row for name, row in found.items()]
        table.loc[mine, "role"] = [row.role for row in orders[names[0]].rows]
        for name, order in orders.items():
            column = "slope" if name == names[0] else f"slope_{name}"
            table.loc[mine, column] = [np.nan if row.slope is None else row.slope for row in order.rows]
    looks = {method.label: {"family": method.family} | dict(method.look) for method in chosen}
    meanings = {method.setting for method in chosen}
    setting = " or ".join(SETTINGS.get(name, name) for name in sorted(meanings))
    return OrderStudy(table, pd.DataFrame(fits), names, looks, setting, reference=known.words)


def order_of(rows: pd.DataFrame, error: str) -> Order:
    """Estimate the order of one method from its rows (coarse to fine); the reference's error is the floor.

    The overlap has no reference; its floor is rounding.
    """
    floor = float(np.nan_to_num(reference_error(rows, error)).max())
    failed = (rows["status"] != "SUCCESS").to_numpy()
    return estimate(rows["setting"], rows[error].where(~failed), floor=floor, failed=failed)


def checked_settings(settings: Sequence[float], least: int = 1) -> tuple[float, ...]:
    """Return different numbers > 0, from coarse to fine."""
    try:
        ladder = tuple(sorted({float(setting) for setting in settings}, reverse=True))
    except (TypeError, ValueError):
        ladder = ()
    if len(ladder) < least or not all(0 < setting < np.inf for setting in ladder):
        raise InvalidProblem(f"settings = {settings!r}: must be {least} or more different numbers > 0")
    return ladder


def _untried(why: str | None) -> dict[str, Any]:
    """Return the row in place of a fit where a method was left out."""
    return {} if why is None else {"order": "left out", "failed": 0, "verdict": why}


def _fit(order: Order) -> dict[str, Any]:
    low, high = order.interval or (np.nan, np.nan)
    return {
        "order": order_text(order),
        "slope": np.nan if order.slope is None else order.slope,
        "low": low,
        "high": high,
        "settled": order.settled,
        "floor": order.resolution,
        "failed": order.count("failed"),
        "verdict": order.verdict,
    }
