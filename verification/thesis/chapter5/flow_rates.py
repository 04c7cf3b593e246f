"""How fast N particles find the mean-field limit: W1 at the start and through the flow, and the error of y.

In one dimension W1(mu_N^t, mu^t) is exact: mu^t is mu^0 carried by the flow of the limit, which characteristics give to
rounding. In two and three W1 is taken of two independent samples, each with a flow of its own.

There is one form only, which takes minutes; its rows are kept, and made again by
``python -m verification.thesis.chapter5.flow_rates FILE``.
"""
# ruff: noqa: RUF001 - formulas for readers are written with Greek letters and minus signs

from __future__ import annotations

import sys
from functools import cache
from itertools import product
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from dincl.study import Key, Row, Study
from meanfield import Motion, solve_ode
from meanfield.characteristics import Flow, solve_characteristics
from meanfield.density import Density
from meanfield.wasserstein import w1
from verification.thesis.chapter5 import cases, exact
from verification.thesis.chapter5.sampling import IID, PAIR, QUANTILES, exponents, means
from verification.thesis.kept import keep

Floats = NDArray[np.float64]
T = np.array([4.0])
LINE, SPACE = ("uniform", "wavy"), ("element", "cube")
FILE = Path(__file__).parent.parent / "data" / "meanfield_flow.parquet"
# Of the limit; of particles, whose error falls with N: random ones, and quantiles.
EXACT, EXACT_IN_SPACE, FINE, FINER = 1e-12, 1e-7, 1e-7, 1e-12
# The repeats of each N, on a line and in space.
REPEATS = (
    {n: 200 if n <= 10_000 else 50 for n in (10, 30, 100, 300, 1000, 3000, 10_000, 30_000, 100_000)},
    {10: 200, 30: 200, 100: 200, 300: 100, 1000: 40, 3000: 10},
)
QUANTILE_COUNTS = (100, 300, 1000, 3000, 10_000)
QUANTITIES = {"start_w1": "W1 at t = 0", "end_w1": "W1 at the end", "error_y": "|y_N − y| at the end"}


def study() -> Study:
    """A row for each repeat; N of one model and kind of start together."""
    on_line, in_space = REPEATS
    runs = [{"model": name, "start": PAIR, "N": n} for name in SPACE for n in reversed(in_space)]
    runs += [{"model": name, "start": IID, "N": n} for name in LINE for n in reversed(on_line)]
    runs += [{"model": name, "start": QUANTILES, "N": n} for name in LINE for n in reversed(QUANTILE_COUNTS)]
    return Study(
        name="meanfield_flow_full",
        title="Mean field: rates through the flow",
        key=("model", "start", "N"),
        runs=tuple(runs),
        run=rows_of,
    )


def rows_of(key: Key) -> list[Row]:
    """The repeats of one model, kind of start and N."""
    name, n = key["model"], key["N"]
    if key["start"] == QUANTILES:
        return [dict(key) | {"repeat": 0} | _beside_law(name, cases.law(name).quantiles(n), FINER)]
    rows: list[Row] = []
    for k in range(REPEATS[key["start"] == PAIR][n]):
        rng = cases.stream("rates", list(cases.CASES).index(name), n, k)
        X = cases.law(name).sample(rng, n)
        found = (
            _beside_law(name, X, FINE)
            if key["start"] == IID
            else _beside_other(name, X, cases.law(name).sample(rng, n))
        )
        rows.append(dict(key) | {"repeat": k} | found)
    return rows


@cache
def limit(name: str) -> Flow:
    """The mean-field limit at the end."""
    case = cases.CASES[name]
    tol = EXACT if name in LINE else EXACT_IN_SPACE
    return solve_characteristics(cases.model(name), cases.law(name), case.y0, case.v0, T, tol)


@cache
def law_at_end(name: str) -> Density:
    """mu^T in one dimension."""
    return exact.carried(cases.model(name), cases.law(name), np.array(cases.CASES[name].y0), limit(name).y[0])


def _end(name: str, X: Floats, tol: float) -> Motion:
    return solve_ode(cases.model(name), cases.state(name, X), T, tol)


def _beside_law(name: str, X: Floats, tol: float) -> dict[str, float]:
    motion = _end(name, X, tol)
    error = np.linalg.norm(motion.y[0] - limit(name).y[0])
    ends = w1(motion.X[0], law_at_end(name))
    return {"start_w1": w1(X, cases.law(name)), "end_w1": ends, "error_y": float(error)}


def _beside_other(name: str, X: Floats, other: Floats) -> dict[str, float]:
    one, two = _end(name, X, FINE), _end(name, other, FINE)
    error = np.linalg.norm(one.y[0] - limit(name).y[0])
    return {"start_w1": w1(X, other), "end_w1": w1(one.X[0], two.X[0]), "error_y": float(error)}


def averaged(table: pd.DataFrame) -> pd.DataFrame:
    """Means over the repeats with 95 % intervals, for each model, kind of start, quantity and N."""
    parts = []
    for name, column in product(table["model"].unique(), QUANTITIES):
        mine = table[table["model"] == name]
        given = mine.assign(d=cases.model(name).nx, w1=mine[column], seconds=0.0)
        parts.append(means(given).drop(columns="seconds").assign(model=name, quantity=column))
    return pd.concat(parts, ignore_index=True)


def fitted(averages: pd.DataFrame) -> pd.DataFrame:
    """The exponents of N with their 95 % intervals; ``known`` is that of W1, and -1/2 for y with random starts."""
    parts = []
    for (name, column), mine in averages.groupby(["model", "quantity"], sort=False):
        parts.append(exponents(mine).assign(model=name, quantity=column))
    found = pd.concat(parts, ignore_index=True)
    of_y = found["quantity"] == "error_y"
    found.loc[of_y, "known"] = np.where(found.loc[of_y, "start"] == QUANTILES, np.nan, -0.5)
    return found.assign(agrees=(found["low"] <= found["known"]) & (found["known"] <= found["high"]))


def main() -> None:
    """Make all runs and write their rows to a file."""
    file = Path(sys.argv[1]) if len(sys.argv) > 1 else FILE
    keep(pd.DataFrame([row for key in study().runs for row in rows_of(key)]), file, main)


if __name__ == "__main__":
    main()
