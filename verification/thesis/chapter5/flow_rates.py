"""Rates at which N particles find the mean-field limit: W1 at the start and through the flow, and the error of y.

In one dimension W1(mu_N^t, mu^t) is exact: mu^t is mu^0 carried by the flow of the limit, which characteristics give to
rounding. In two and three W1 is taken of two independent samples, each with a flow of its own.

There is one form only, which takes minutes; its rows are kept, and recomputed by
``python -m verification.thesis.chapter5.flow_rates FOLDER``.
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

from dincl.study import Key, Row, Study, workers
from verification.instruments.rates import (
    IID,
    PAIR,
    QUANTILES,
    MeanFieldLimit,
    distance,
    draw,
    mean_field_limit,
    through_flow,
)
from verification.page.kept import DATA, keep
from verification.thesis.chapter5 import cases
from verification.thesis.chapter5.sampling import exponents, means

Floats = NDArray[np.float64]
T = np.array([4.0])
LINE, SPACE = ("uniform", "wavy"), ("element", "cube")
FILE = DATA / "meanfield_flow.parquet"
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
    """Make a row for each repeat; all N of one model and kind of start are one run."""
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
    """Run the repeats of one model, kind of start and N."""
    name, n = key["model"], key["N"]
    if key["start"] == QUANTILES:
        return [dict(key) | {"repeat": 0} | _compared(name, cases.law(name).quantiles(n), None, FINER)]
    rows: list[Row] = []
    for k in range(REPEATS[key["start"] == PAIR][n]):
        rng = cases.stream("rates", list(cases.CASES).index(name), n, k)
        X, other = draw(cases.law(name), key["start"], n, rng)
        rows.append(dict(key) | {"repeat": k} | _compared(name, X, other, FINE))
    return rows


@cache
def limit(name: str) -> MeanFieldLimit:
    """Return the mean-field limit at the end."""
    case = cases.CASES[name]
    tol = EXACT if name in LINE else EXACT_IN_SPACE
    return mean_field_limit(cases.model(name), cases.law(name), case.y0, case.v0, T, tol, FINE)


def _compared(name: str, X: Floats, other: Floats | None, tol: float) -> dict[str, float]:
    (end,) = through_flow(limit(name)._replace(tol=tol), X, other, None)
    start, _ = distance(cases.law(name), X, other, None)
    return {"start_w1": start, "end_w1": end["w1"], "error_y": end["error_y"]}


def averaged(table: pd.DataFrame) -> pd.DataFrame:
    """Average over the repeats, with 95 % intervals, for each model, kind of start, quantity and N."""
    parts = []
    for name, column in product(table["model"].unique(), QUANTITIES):
        mine = table[table["model"] == name]
        given = mine.assign(d=cases.model(name).nx, w1=mine[column], seconds=0.0)
        parts.append(means(given).drop(columns="seconds").assign(model=name, quantity=column))
    return pd.concat(parts, ignore_index=True)


def fitted(averages: pd.DataFrame) -> pd.DataFrame:
    """Fit the exponents of N with 95 % intervals; ``known`` is that of W1, and -1/2 for y with random starts."""
    parts = []
    for (name, column), mine in averages.groupby(["model", "quantity"], sort=False):
        parts.append(exponents(mine).assign(model=name, quantity=column))
    found = pd.concat(parts, ignore_index=True)
    of_y = found["quantity"] == "error_y"
    found.loc[of_y, "known"] = np.where(found.loc[of_y, "start"] == QUANTILES, np.nan, -0.5)
    return found.assign(agrees=(found["low"] <= found["known"]) & (found["known"] <= found["high"]))


def main(folder: Path) -> None:
    """Complete the study, and keep its table."""
    with workers() as executor:
        keep(study().complete(folder, executor), FILE, main)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
