"""The constrained equations of index 1 without stabilisation: how they leave g = c, beside those that keep it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from dincl.study import Key, Row, Study
from meanfield import Motion
from verification.instruments.lines import slope
from verification.instruments.meanfield_methods import SOLVERS
from verification.thesis.chapter5 import cases
from verification.thesis.chapter5.methods import LABELS
from verification.thesis.chapter5.naive import solve_naive, solve_naive_rk4

Floats = NDArray[np.float64]
STEP, TOL = 0.1, 1e-5
SAMPLES = 31
# The growth is fitted where it has outlasted the swings of a period.
FITTED = 10.0
NAIVE = {"naive_rk4": f"naive RK4 with dt = {STEP:g}", "naive": f"naive DOP853 with tol = {TOL:g}"}
METHODS: dict[str, Callable[..., Motion]] = {
    "naive_rk4": partial(solve_naive_rk4, dt=STEP),
    "naive": partial(solve_naive, tol=TOL),
    "ode": lambda model, start, t: SOLVERS["ode"](model, start, t, TOL),
    "dae": lambda model, start, t: SOLVERS["dae"](model, start, t, TOL),
    "rattle2": lambda model, start, t: SOLVERS["rattle2"](model, start, t, STEP),
}
TITLES = LABELS | NAIVE


@dataclass(frozen=True)
class DriftForm:
    """The end of the runs, and the methods."""

    end: float
    methods: tuple[str, ...] = tuple(METHODS)


FULL = DriftForm(1000.0)


def study(form: DriftForm) -> Study:
    """Measure the drift of g and of g' at times that grow geometrically."""
    return Study(
        name="meanfield_drift",
        title="Mean field: drift",
        key=("method",),
        runs=tuple({"method": method} for method in form.methods),
        run=partial(_rows, form.end),
    )


def _rows(end: float, key: Key) -> list[Row]:
    t = np.geomspace(1.0, end, SAMPLES)
    motion = METHODS[key["method"]](cases.model("wavy"), cases.few("wavy", 5), t)
    # The largest so far: it passes through zero.
    drifts = (np.maximum.accumulate(found) for found in (motion.constraint_drift(), motion.velocity_drift()))
    return [dict(key) | {"t": at, "g": g, "rate": rate} for at, g, rate in zip(motion.t, *drifts, strict=True)]


def growth(table: pd.DataFrame) -> pd.DataFrame:
    """Fit the exponents of t by which the drift of g and of g' grow, with 95 % intervals; add the drift at the end."""
    rows = []
    for method, mine in table.groupby("method", sort=False):
        late = mine[mine["t"] >= FITTED]
        row: dict[str, Any] = {"method": TITLES[method]}
        for column in ("g", "rate"):
            text = "—"
            if method in NAIVE:
                fit = slope(np.log(late["t"]), np.log(late[column]))
                text = f"{fit.value:.2f} [{fit.low:.2f}, {fit.high:.2f}]"
            row |= {f"power_{column}": text, f"end_{column}": float(mine[column].max())}
        rows.append(row)
    return pd.DataFrame(rows)
