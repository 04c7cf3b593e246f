"""Drift of the energies (5.37) and (5.50): against the setting of each solver, and over many periods."""
# ruff: noqa: RUF001 - headings for readers have minus signs

from __future__ import annotations

from dataclasses import replace
from functools import cache, partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from dincl.study import Key, Row, Study, joined
from meanfield import solve_ode
from verification.instruments.lines import slope
from verification.instruments.meanfield_methods import (
    SOLVERS,
    STYLES,
    DensityProblem,
    ParticleProblem,
    density_methods,
    particle_methods,
)
from verification.instruments.method import Method
from verification.instruments.orders import OrderRuns
from verification.instruments.references import Known
from verification.site.context import Context
from verification.site.sheet import legend_below, sheet
from verification.thesis.chapter5 import agreement, cases

Floats = NDArray[np.float64]
NAME, LONG = "meanfield_energy", "meanfield_energy_long"
T = agreement.T
# Of the solvers of the mean-field equations: tolerances, cells.
SETTINGS = {"tol": [10.0**-k for k in range(3, 12)], "1/cells": [1 / n for n in (32, 48, 72, 108, 162, 243, 365)]}
LIMITS = {"straight": ("characteristics", "moments", "pde"), "wavy": ("characteristics", "pde")}
# Over long times, WavyFibre with five particles; a period takes about PERIOD.
PERIODS, PERIOD, SAMPLES = 1000, 7.0, 121
FOLLOWED = (("dae", 1e-5), ("ode", 1e-5), ("ode", 1e-8))
HEADINGS = {"model": "Model", "method": "Method", "setting": "Setting", "change": "Largest |E − E(0)|"}
HEADINGS |= {"order": "Power of the setting [range]"}
LONG_HEADINGS = {"method": "Method", "setting": "Tolerance", "periods": "Periods"}
LONG_HEADINGS |= {"largest": "Largest |E − E(0)|", "slope": "Change of E per period", "low": "Lower end, 95 %"}
LONG_HEADINGS |= {"high": "Upper end, 95 %", "drifts": "Drifts"}


def change(motion: Any) -> Floats:
    """Return E - E(0), (K, 1), of a result that has the time 0."""
    energy = motion.energy()
    return np.asarray(energy - energy[0])[:, None]


def _runs(problem: Any, methods: list[Method], settings: Any, scale: float) -> OrderRuns:
    """Return runs whose change of energy should be 0, to rounding of the energy."""
    known = Known(T, np.zeros((len(T), 1)), np.full(len(T), np.finfo(float).eps * scale))
    return OrderRuns(problem, methods, settings, T, known, {"change": np.ravel})


@cache
def runs() -> dict[str, OrderRuns]:
    """Return what is run: particles of each model, and the mean-field equations of two."""
    found, of_particles, of_density = {}, particle_methods(change), density_methods(change)
    for name in agreement.MODELS:
        model, start = cases.model(name), cases.few(name, agreement.PARTICLES)
        scale = abs(float(solve_ode(model, start, T[1:], 1e-6).energy()[0]))
        methods = list(of_particles.values())
        found[cases.TITLES[name]] = _runs(ParticleProblem(model, start), methods, {"tol": agreement.TOLERANCES}, scale)
    for name, used in LIMITS.items():
        case = cases.CASES[name]
        problem = DensityProblem(cases.model(name), cases.law(name), case.y0, case.v0)
        found[f"{case.title}, limit"] = _runs(problem, [of_density[way] for way in used], SETTINGS, 1.0)
    return found


def study(smallest: bool = False) -> Study:
    """Return the study of the change of energy against the setting."""
    parts = {name: one.study(smallest=smallest) for name, one in runs().items()}
    return replace(joined(NAME, "Mean field: energy", parts, "model"), columns=HEADINGS)


def powers(rows: pd.DataFrame) -> pd.DataFrame:
    """Return the power p of |E - E(0)| ~ setting^p for each model and method."""
    mine = {name: rows[rows["model"] == name].drop(columns="model") for name in runs()}
    return pd.concat([runs()[name].result(one).fits.assign(model=name) for name, one in mine.items() if len(one)])


def long_study(smallest: bool = False) -> Study:
    """Return the study of the energy (5.37) over many periods."""
    return Study(
        LONG,
        "Mean field: energy over long times",
        ("method", "setting"),
        tuple({"method": STYLES[name][0], "setting": setting} for name, setting in FOLLOWED[: 1 if smallest else None]),
        partial(_followed, PERIODS),
        columns=LONG_HEADINGS,
    )


def _followed(periods: int, key: Key) -> list[Row]:
    (name,) = (name for name in SOLVERS if STYLES[name][0] == key["method"])
    t = np.linspace(0.0, periods * PERIOD, SAMPLES)
    energy = SOLVERS[name](cases.model("wavy"), cases.few("wavy", 5), t, key["setting"]).energy()
    return [dict(key) | {"t": at, "change": float(e - energy[0])} for at, e in zip(t, energy, strict=True)]


def trends(rows: pd.DataFrame) -> pd.DataFrame:
    """Fit a line through the changes of energy: its slope per period with the 95 % interval, and the largest change."""
    found = []
    for (method, setting), mine in rows.groupby(["method", "setting"], sort=False):
        fit = slope(mine["t"] / PERIOD, mine["change"])
        row = {"method": method, "setting": setting, "periods": float(mine["t"].max()) / PERIOD}
        row |= {"largest": float(mine["change"].abs().max()), "slope": fit.value, "low": fit.low, "high": fit.high}
        found.append(row | {"drifts": fit.low > 0 or fit.high < 0})
    return pd.DataFrame(found)


def figure(rows: pd.DataFrame, path: Path) -> Path:
    """Draw the largest change of energy so far, over many periods."""
    with sheet(path, 3.2) as drawn:
        panel = drawn.subplots()
        for (method, setting), one in rows.groupby(["method", "setting"], sort=False):
            largest = np.maximum.accumulate(np.abs(one["change"].to_numpy()))[1:]
            panel.loglog(one["t"].to_numpy()[1:] / PERIOD, largest, label=f"{method}, {setting:g}")
        panel.set(xlabel="periods", ylabel="largest |E − E(0)| so far")
        legend_below(drawn, [panel], 3)
    return path


def show(context: Context) -> None:
    """Give the energy over long times, and within a period."""
    long = context.tables[LONG]
    context.draw(LONG, figure, long)
    context.show(LONG, context.headed(LONG, trends(long)))
    context.show(NAME, context.headed(NAME, powers(context.tables[NAME])))
