"""Which method reaches an accuracy at the smallest cost, and where the measurement does not decide."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from verification.instruments.error_norms import reference_error

# An error below this many times the stated error of the reference is not counted as an accuracy reached.
RESOLVED = 2.0
# Ratios of CPU times below this are not told apart, however small the spread of repeats was: the layout of code and
# data differs from process to process, and repeats within one process do not see it.
LEAST_SPREAD = 1.25
# Statuses of runs that were not made, which is no failure.
NOT_TRIED = ("LEFT_OUT", "REFUSED")
TIE, AT_THE_LIMIT, NOT_REACHED = "tie", "at the limit", "not reached"
# Of an error that the reference itself does not resolve.
NOT_RESOLVED = "not resolved"
UNDECIDED = (TIE, AT_THE_LIMIT, NOT_REACHED, NOT_RESOLVED)


class Runs(NamedTuple):
    """The runs of one method on one problem that came to their end, from coarse to fine."""

    accuracies: NDArray[np.float64]
    costs: NDArray[np.float64]
    spreads: NDArray[np.float64]


class Price(NamedTuple):
    """What an accuracy costs; infinite: it is not reached.

    ``spread`` is the ratio that separates two such costs; ``dearest`` the cost of the dearest run that it rests on.
    """

    value: float
    spread: float
    dearest: float


def accuracy(rows: pd.DataFrame, error: str) -> pd.Series:
    """Return the error, or RESOLVED times the error of the reference if that is larger."""
    return rows[error].clip(lower=RESOLVED * reference_error(rows, error))


def runs_of(rows: pd.DataFrame, error: str, cost: str) -> Runs:
    """Return the runs of one method on one problem."""
    done = rows[(rows["status"] == "SUCCESS") & rows[cost].notna()].sort_values("setting", ascending=False)
    return Runs(accuracy(done, error).to_numpy(float), done[cost].to_numpy(float), spreads(done, cost))


def cost_of(runs: Runs, target: float) -> Price:
    """Return the cost of one method for an error of ``target``.

    After the last run that misses the target, the next one has it, and so have all finer ones. The cost is that of the
    cheapest of these, or lies on the straight line in (log error, log cost) from the last that misses to the next, if
    that is less. So no error costs more than a finer one. Nothing is extrapolated: where the finest run misses the
    target, it is not reached.
    """
    reached, costs, spreads = runs
    missing = np.flatnonzero(~(reached <= target))
    first = int(missing[-1]) + 1 if len(missing) else 0
    if first == len(reached):
        return Price(math.inf, 1.0, math.inf)
    least = first + int(np.argmin(costs[first:]))
    run = Price(float(costs[least]), float(spreads[least]), float(costs[least]))
    if first == 0:
        return run
    pair = slice(first - 1, first + 1)
    x, y = np.log(np.maximum(reached[pair], np.finfo(float).tiny)), np.log(np.maximum(costs[pair], 1e-300))
    value = float(np.exp(np.interp(np.log(target), x[::-1], y[::-1])))
    return run if run.value < value else Price(value, float(spreads[pair].max()), float(costs[pair].max()))


def spreads(rows: pd.DataFrame, cost: str) -> NDArray[np.float64]:
    """Return the spread of costs: 0 for counted work; of the repeats for times, at least LEAST_SPREAD."""
    if cost != "cpu_seconds":
        return np.ones(len(rows))
    spreads: NDArray[np.float64] = np.maximum(
        np.nan_to_num(rows["spread"].to_numpy(float), nan=LEAST_SPREAD), LEAST_SPREAD
    )
    return spreads


def costs(table: pd.DataFrame, targets: Sequence[float], error: str, cost: str) -> pd.DataFrame:
    """Return one row for each method and target: cost and spread; infinite where the target is not reached.

    ``resolved`` tells whether the reference is good enough to say so.
    """
    finest = RESOLVED * reference_error(table, error).max()
    methods = {method: runs_of(mine, error, cost) for method, mine in table.groupby("method", sort=False)}
    rows = [
        {"method": method, "target": target, "resolved": not target < finest} | cost_of(runs, target)._asdict()
        for method, runs in methods.items()
        for target in targets
    ]
    return pd.DataFrame(rows)


def rank(found: pd.DataFrame, certain: float) -> pd.DataFrame:
    """Return one row for each target, from the table of ``costs``: the cheapest method and ties.

    ``cheapest`` is the label of the method; "tie" where others cost no more than the spread more (``tied`` names all of
    them); "at the limit" where it rests on a run that costs more than ``certain``, so that on another day it could be
    stopped by its budget; "not reached"; "not resolved" where the reference is no better. ``ratio`` is how much more
    the ``next`` method outside of the tie costs.
    """
    groups = found.groupby("target", sort=False)
    rows = [{"target": target} | _first(group, certain) for target, group in groups]
    return pd.DataFrame(rows).sort_values("target", ascending=False, ignore_index=True)


def _first(rows: pd.DataFrame, certain: float) -> dict[str, Any]:
    word = NOT_REACHED if rows["resolved"].all() else NOT_RESOLVED
    nobody: dict[str, Any] = {"cheapest": word, "cost": np.nan, "tied": "", "next": "", "ratio": np.nan}
    there = rows[np.isfinite(rows["value"])].sort_values("value", kind="stable")
    if there.empty:
        return nobody
    best = there.iloc[0]
    near = there["value"] <= best["value"] * there["spread"].clip(lower=best["spread"])
    tied, others = there[near], there[~near]
    name = best["method"] if len(tied) == 1 else TIE
    if best["dearest"] > certain:
        name = AT_THE_LIMIT
    row = nobody | {"cheapest": name, "cost": best["value"], "tied": "; ".join(tied["method"])}
    if len(others):
        row |= {"next": others.iloc[0]["method"], "ratio": others.iloc[0]["value"] / best["value"]}
    return row


def front(table: pd.DataFrame, error: str, cost: str) -> pd.DataFrame:
    """Return the efficient runs, by increasing cost: no other run has both a smaller error and a smaller cost."""
    done = table[(table["status"] == "SUCCESS") & table[cost].notna()]
    ordered = done.assign(accuracy=accuracy(done, error)).dropna(subset=["accuracy"]).sort_values([cost, "accuracy"])
    best = ordered["accuracy"].cummin()
    improves = ordered["accuracy"] < best.shift(fill_value=np.inf)
    return ordered[improves].reset_index(drop=True)
