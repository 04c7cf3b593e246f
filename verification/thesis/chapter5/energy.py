"""Drift of the energies (5.37) and (5.50): against the setting of each solver, and over many periods."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from dincl.study import Key, Row, Study
from meanfield import Moments, solve_characteristics, solve_moments, solve_pde
from verification.instruments.lines import slope
from verification.instruments.meanfield_methods import SOLVERS
from verification.instruments.order import estimate, order_text
from verification.thesis.chapter5 import cases
from verification.thesis.chapter5.agreement import TIMES

Floats = NDArray[np.float64]
# Over long times, WavyFibre with five particles; a period takes about PERIOD.
PERIOD, SAMPLES = 7.0, 121


@dataclass(frozen=True)
class LimitForm:
    """Of the solvers of the mean-field equations: digits of the tolerances, numbers of cells; models."""

    digits: tuple[int, ...]
    cells: tuple[int, ...]
    models: tuple[str, ...] = ("straight", "wavy")


@dataclass(frozen=True)
class LongForm:
    """How many periods; pairs of method and setting."""

    periods: int
    methods: tuple[tuple[str, float], ...] = (
        ("rattle2", 0.1),
        ("rattle4", 0.5),
        ("ode", 1e-5),
        ("ode", 1e-8),
        ("dae", 1e-5),
    )


FULL = LimitForm(tuple(range(3, 12)), (32, 48, 72, 108, 162, 243, 365))
FULL_LONG = LongForm(1000)


def limit_study(form: LimitForm) -> Study:
    """Measure the energy (5.50) of characteristics, moments (where they close) and the PDE."""
    runs = [{"model": name, "method": method} for method in ("pde", "characteristics") for name in form.models]
    return Study(
        name="meanfield_energy_limit",
        title="Mean field: energy of the limit",
        key=("model", "method"),
        runs=(*runs, {"model": "straight", "method": "moments"}),
        run=partial(_limit, digits=form.digits, cells=form.cells),
    )


def _limit(key: Key, digits: tuple[int, ...], cells: tuple[int, ...]) -> list[Row]:
    name = key["model"]
    model, law, case = cases.model(name), cases.law(name), cases.CASES[name]
    start = case.y0, case.v0, TIMES
    solve: Callable[[Any], Any] = {
        "pde": lambda n: solve_pde(model, law, *start, cells=n),
        "characteristics": lambda tol: solve_characteristics(model, law, *start, tol),
        "moments": lambda tol: solve_moments(model, Moments(*law.moments()), *start, tol),
    }[key["method"]]
    settings: Sequence[float] = cells if key["method"] == "pde" else [10.0**-k for k in digits]
    rows: list[Row] = []
    for setting in settings:
        energy = solve(setting).energy()
        fine = 1 / setting if key["method"] == "pde" else setting
        drift = float(np.abs(energy - energy[0]).max())
        rows.append(dict(key) | {"setting": fine, "energy": drift, "energy_scale": float(abs(energy[0]))})
    return rows


def long_study(form: LongForm) -> Study:
    """Measure the energy (5.37) over many periods."""
    runs = tuple({"method": method, "setting": setting} for method, setting in form.methods)
    return Study(
        name="meanfield_energy_long",
        title="Mean field: energy over long times",
        key=("method", "setting"),
        runs=runs,
        run=partial(_long, periods=form.periods),
    )


def _long(key: Key, periods: int) -> list[Row]:
    t = np.linspace(0.0, periods * PERIOD, SAMPLES)
    motion = SOLVERS[key["method"]](cases.model("wavy"), cases.few("wavy", 5), t, key["setting"])
    energy = motion.energy()
    return [dict(key) | {"t": at, "change": float(e - energy[0])} for at, e in zip(t, energy, strict=True)]


def slopes(agreement: pd.DataFrame, limit: pd.DataFrame) -> pd.DataFrame:
    """Fit the power p of |E - E(0)| ~ setting^p for the largest change of energy, with the range of local orders."""
    rows = []
    table = pd.concat([agreement, limit.assign(limit=True)])
    for (name, method), mine in table.groupby(["model", "method"], sort=False):
        fit = estimate(mine["setting"], mine["energy"], scale=float(mine["energy_scale"].iloc[0]))
        rows.append({"model": name, "method": method, "slope": order_text(fit), "least": float(mine["energy"].min())})
    return pd.DataFrame(rows).sort_values(["method", "model"], ignore_index=True)


def trends(table: pd.DataFrame) -> pd.DataFrame:
    """Fit a line through the changes of energy: its slope per period with the 95 % interval, and the largest change."""
    rows = []
    for (method, setting), mine in table.groupby(["method", "setting"]):
        fit = slope(mine["t"] / PERIOD, mine["change"])
        rows.append(
            {
                "method": method,
                "setting": setting,
                "periods": float(mine["t"].max()) / PERIOD,
                "largest": float(mine["change"].abs().max()),
                "slope": fit.value,
                "low": fit.low,
                "high": fit.high,
                "drifts": fit.low > 0 or fit.high < 0,
            }
        )
    return pd.DataFrame(rows)
