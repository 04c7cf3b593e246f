"""Orders of convergence: methods on one problem over a ladder of settings, with local orders and fitted slopes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

from dincl import InvalidProblem
from dincl.checks import instance, number
from dincl.study import Study
from verification.instruments.budget import Budget
from verification.instruments.error_norms import Errors, checked_errors, reference_error
from verification.instruments.ladders import Ladders
from verification.instruments.method import Method, Methods, as_methods
from verification.instruments.order import MIN_RATIO, MIN_STEPS, Order, estimate, order_text
from verification.instruments.references import proved_words
from verification.instruments.result import Result, left_out
from verification.instruments.stored import Store, carried_out

if TYPE_CHECKING:
    from verification.site.sheet import Axes

Settings = Sequence[float] | Mapping[str, Sequence[float]]
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
        their trend ``low``, ``high``, whether they have ``settled``, the ``finest`` setting with the ``finest_error``
        there, ``floor`` (what of the error was covered), ``failed`` runs, and the
        ``verdict`` as a sentence. The range is no confidence interval: see ``Order``.
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


@dataclass(frozen=True, eq=False)
class OrderRuns:
    """What ``order_study`` runs, apart from what it makes of the rows; the arguments are the same."""

    problem: Any
    methods: Methods
    settings: Settings
    t: ArrayLike
    reference: Any
    errors: Errors = ("largest", "final")
    budget: Budget | None = None
    floor: float = 0.0

    def __post_init__(self) -> None:
        number("floor", self.floor, non_negative=True)
        if self.budget is not None:
            instance("budget", self.budget, Budget, "CpuSeconds or DriftEvaluations")
        if isinstance(self.settings, Mapping):
            used = {name for one in as_methods(self.methods) for name in (one.label, one.setting)}
            if unknown := [name for name in self.settings if name not in used]:
                raise InvalidProblem(
                    f"settings has {unknown[0]!r}: must be a label of a method or one of {', '.join(SETTINGS)}"
                )
        else:
            object.__setattr__(self, "settings", checked_settings(self.settings, least=MIN_STEPS))

    def study(self, name: str = "orders", title: str = "Orders", smallest: bool = False) -> Study:
        """Return the runs; in the smallest form those of the coarsest settings that an order needs."""
        return self._ladders(smallest).study(name, title)

    def _ladders(self, smallest: bool) -> Ladders:
        chosen, norms = as_methods(self.methods), checked_errors(self.errors)
        most = MIN_STEPS if smallest else None
        ladders = {one.label: settings_of(one, self.settings, least=MIN_STEPS)[:most] for one in chosen}
        return Ladders(self.problem, chosen, ladders, self.t, self.reference, norms, self.budget, repeats=0)

    def result(self, rows: pd.DataFrame) -> OrderStudy:
        """Return what rows of the study say, of the complete one or of some of its runs."""
        ladders = self._ladders(smallest=False)
        table, fits, names = ladders.sorted(rows), [], tuple(ladders.errors)
        there = [method for method in ladders.methods if (table["method"] == method.label).any()]
        untried = left_out(table)
        for method in there:
            mine = table["method"] == method.label
            orders = {name: order_of(table[mine], name, self.floor) for name in names}
            found = {name: _fit(order) | _untried(untried.get(method.label)) for name, order in orders.items()}
            fits += [{"method": method.label, "error": name} | row for name, row in found.items()]
            table.loc[mine, "role"] = [row.role for row in orders[names[0]].rows]
            for name, order in orders.items():
                column = "slope" if name == names[0] else f"slope_{name}"
                table.loc[mine, column] = [np.nan if row.slope is None else row.slope for row in order.rows]
        meanings = {method.setting for method in there}
        setting = " or ".join(SETTINGS.get(name, name) for name in sorted(meanings))
        words = proved_words(self.reference, lambda: ladders.known)
        return OrderStudy(table, pd.DataFrame(fits), names, ladders.looks, setting, reference=words)


def order_study(
    problem: Any,
    methods: Methods,
    settings: Settings,
    t: ArrayLike,
    reference: Any,
    errors: Errors = ("largest", "final"),
    budget: Budget | None = None,
    floor: float = 0.0,
    *,
    store: Store = None,
    executor: Executor | None = None,
) -> OrderStudy:
    """Run every method with every setting, and fit error = C h^p on the asymptotic part of each curve.

    Parameters
    ----------
    problem
        A dincl.Problem, or whatever the methods can run.
    methods
        label -> (setting -> Scheme), or a list of Method.
    settings
        Steps or tolerances > 0, five at least, in any order [time or length]; or a mapping from labels of methods, or
        from "dt" and "tol", to them.
    t
        Times at which states are compared, increasing.
    reference
        ``reference(problem, tol)``, a function t -> exact states, a Known, or an array (K, N, d).
    errors
        Of max_i |X_i - exact| [length]: the "largest" over t, the "final" one at the last t, the one at a time that is
        given as a number. "overlap": max max(0, -g) over t. "stated": the largest that the run itself states, NaN if
        none. A function of the state (N, d), such as a height or an energy: the largest error of its values over t.
        Several of these, or a mapping from names to them.
    budget
        Of one run: CpuSeconds or DriftEvaluations. Finer settings than one that exceeds it are left out.
    floor
        Errors below it come from elsewhere than the step, such as the tolerance of a projection [length]; they enter no
        fit, as those below the reference's own error.
    store, executor
        A Parquet file that makes an interrupted call go on, method by method; who makes the runs: see ``carried_out``.

    Raises
    ------
    InvalidProblem
        For fewer than five settings, unknown names of errors, objects that are not methods, times that do not increase.
    """
    runs = OrderRuns(problem, methods, settings, t, reference, errors, budget, floor)
    return runs.result(carried_out(runs.study(), store, executor))


def order_of(rows: pd.DataFrame, error: str, floor: float = 0.0) -> Order:
    """Estimate the order of one method from its rows (coarse to fine); the reference's error is the least floor.

    The overlap has no reference; its least floor is rounding.
    """
    own = float(np.nan_to_num(reference_error(rows, error)).max())
    failed = (rows["status"] != "SUCCESS").to_numpy()
    return estimate(rows["setting"], rows[error].where(~failed), floor=max(own, floor), failed=failed)


def settings_of(method: Method, settings: Settings, least: int = 1) -> tuple[float, ...]:
    """Return the settings of one method, from coarse to fine."""
    if not isinstance(settings, Mapping):
        return checked_settings(settings, least)
    name = method.label if method.label in settings else method.setting
    if name not in settings:
        raise InvalidProblem(f"settings has no entry {method.label!r} or {method.setting!r}, which this method needs")
    return checked_settings(settings[name], least)


def checked_settings(settings: Sequence[float], least: int = 1) -> tuple[float, ...]:
    """Return different numbers > 0, from coarse to fine."""
    try:
        ladder = tuple(sorted({float(setting) for setting in list(settings)}, reverse=True))
    except (TypeError, ValueError):
        ladder = ()
    if len(ladder) < least or not all(0 < setting < np.inf for setting in ladder):
        raise InvalidProblem(f"settings = {settings!r}: must be {least} or more different numbers > 0")
    for coarse, fine in pairwise(ladder) if least >= MIN_STEPS else ():
        if coarse < MIN_RATIO * fine:
            raise InvalidProblem(f"settings has {coarse:g} and {fine:g}: must differ by 1 % at least, to show an order")
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
        "finest": order.rows[-1].h,
        "finest_error": order.rows[-1].error,
        "floor": order.resolution,
        "failed": order.count("failed"),
        "verdict": order.verdict,
    }
