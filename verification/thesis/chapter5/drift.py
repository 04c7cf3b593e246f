"""The constrained equations of index 1 without stabilisation: how they leave g = c, beside those that keep it."""
# ruff: noqa: RUF001 - headings for readers have minus signs

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from dincl.study import Key, Row, Study
from meanfield import Motion, solve_dae, solve_ode, solve_rattle
from verification.instruments.lines import slope
from verification.site.context import Context
from verification.site.sheet import legend_below, sheet
from verification.thesis.chapter5 import cases
from verification.thesis.chapter5.naive import solve_naive, solve_naive_rk4

NAME, STEP, TOL = "meanfield_drift", 0.1, 1e-5
END, SAMPLES = 1000.0, 31
# The growth is fitted where it has outlasted the swings of a period.
FITTED = 10.0
NAIVE: dict[str, Callable[..., Motion]] = {
    f"naive RK4, dt = {STEP:g}": partial(solve_naive_rk4, dt=STEP),
    f"naive DOP853, tol = {TOL:g}": partial(solve_naive, tol=TOL),
}
METHODS: dict[str, Callable[..., Motion]] = NAIVE | {
    f"ODE, tol = {TOL:g}": partial(solve_ode, tol=TOL),
    f"DAE, tol = {TOL:g}": partial(solve_dae, tol=TOL),
    f"RATTLE of order 2, dt = {STEP:g}": partial(solve_rattle, dt=STEP, order=2),
}
# Errors below this are rounding, and drawn there.
LOWEST = 1e-16
HEADINGS = {
    "method": "Method",
    "power_g": "|g − c| ~ t^p: p [95 %]",
    "end_g": "|g − c| at the end",
    "power_rate": "|g'| ~ t^p: p [95 %]",
    "end_rate": "|g'| at the end",
}


def study(smallest: bool = False) -> Study:
    """Return the study of the drift of g and of g' at times that grow geometrically; the smallest has DAE only."""
    names = [name for name in METHODS if not smallest or name.startswith("DAE")]
    runs = tuple({"method": name} for name in names)
    return Study(NAME, "Mean field: drift", ("method",), runs, partial(_rows, END), columns=HEADINGS)


def _rows(end: float, key: Key) -> list[Row]:
    motion = METHODS[key["method"]](cases.model("wavy"), cases.few("wavy", 5), np.geomspace(1.0, end, SAMPLES))
    # The largest so far: it passes through zero.
    drifts = (np.maximum.accumulate(found) for found in (motion.constraint_drift(), motion.velocity_drift()))
    return [dict(key) | {"t": at, "g": g, "rate": rate} for at, g, rate in zip(motion.t, *drifts, strict=True)]


def growth(table: pd.DataFrame) -> pd.DataFrame:
    """Fit the powers of t by which the drift of g and of g' grow, with 95 % intervals; add the drift at the end."""
    rows = []
    for method, mine in table.groupby("method", sort=False):
        late = mine[mine["t"] >= FITTED]
        row: dict[str, Any] = {"method": method}
        for column in ("g", "rate"):
            fit = slope(np.log(late["t"]), np.log(late[column].clip(lower=LOWEST)))
            text = f"{fit.value:.2f} [{fit.low:.2f}, {fit.high:.2f}]" if method in NAIVE else "—"
            row |= {f"power_{column}": text, f"end_{column}": float(mine[column].max())}
        rows.append(row)
    return pd.DataFrame(rows)


def figure(table: pd.DataFrame, path: Path) -> Path:
    """Draw the largest |g - c| and |g'| so far against time."""
    with sheet(path, 3.2) as drawn:
        panels = drawn.subplots(1, 2, sharex=True)
        for method, one in table.groupby("method", sort=False):
            for panel, column in zip(panels, ("g", "rate"), strict=True):
                panel.loglog(one["t"], one[column].clip(lower=LOWEST), label=method)
        panels[0].set(xlabel="time t", ylabel="largest |g − c| so far")
        panels[1].set(xlabel="time t", ylabel="largest |dg/dX U + dg/dy v| so far")
        legend_below(drawn, panels, 3)
    return path


def show(context: Context) -> None:
    """Give the drift of the constraint."""
    table = context.tables[NAME]
    context.draw(NAME, figure, table)
    context.show(NAME, context.headed(NAME, growth(table)))
