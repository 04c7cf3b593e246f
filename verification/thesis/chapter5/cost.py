"""Speed against accuracy: y at the end of a mean-field problem by every level of the model."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from dincl.study import Study, joined
from meanfield import solve_characteristics
from verification.instruments.budget import CpuSeconds
from verification.instruments.meanfield_methods import DensityProblem, density_methods
from verification.instruments.result import draw_results
from verification.instruments.speed_accuracy import WorkPrecision, WorkPrecisionRuns
from verification.site.context import Context
from verification.thesis.chapter5 import cases

Floats = NDArray[np.float64]
NAME, T, REFERENCE = "meanfield_cost", np.array([4.0]), 1e-13
# Moments of WavyFibre do not close.
METHODS = {
    "straight": ("dae", "ode", "characteristics", "moments", "pde"),
    "wavy": ("dae", "ode", "characteristics", "pde"),
}
PARTICLES = [1 / n for n in (4, 32, 256, 2048, 16_384, 131_072, 1_048_576)]
SETTINGS = {
    "1/N": PARTICLES,
    "DAE (IDAS)": PARTICLES[:5],
    "tol": [10.0**-k for k in range(2, 13)],
    "1/cells": [1 / n for n in (32, 64, 128, 256, 512, 1024, 2048)],
}
TARGETS = (1e-3, 1e-6, 1e-9)
HEADINGS = {"model": "Model", "method": "Method", "setting": "1/N, tolerance or 1/cells", "status": "Status"}
HEADINGS |= {"final": "Error of y", "cpu_seconds": "CPU time [s]"}


@cache
def runs() -> dict[str, WorkPrecisionRuns]:
    """Return what is run on each model."""
    found, methods = {}, density_methods()
    for name, used in METHODS.items():
        case = cases.CASES[name]
        problem = DensityProblem(cases.model(name), cases.law(name), case.y0, case.v0)
        chosen = [methods[way] for way in used]
        found[case.title] = WorkPrecisionRuns(
            problem, chosen, SETTINGS, T, reference(name)[None], CpuSeconds(3.0), ("final",)
        )
    return found


def reference(name: str) -> Floats:
    """Return y(T): in closed form from the second moment, or by characteristics to rounding."""
    law, case = cases.law(name), cases.CASES[name]
    if name == "straight":
        second = float(law.moments()[1][0, 0])
        return np.asarray(cases.harmonic(name, np.array([[np.sqrt(second)]]), T).y[0])
    return np.asarray(solve_characteristics(cases.model(name), law, case.y0, case.v0, T, REFERENCE).y[0])


def study(smallest: bool = False) -> Study:
    """Return the study of all methods on both models."""
    parts = {name: one.study(smallest=smallest) for name, one in runs().items()}
    return replace(joined(NAME, "Mean field: speed against accuracy", parts, "model"), columns=HEADINGS)


def results(rows: pd.DataFrame) -> dict[str, WorkPrecision]:
    """Return the chart of each model that rows of the study have."""
    mine = {name: rows[rows["model"] == name].drop(columns="model") for name in runs()}
    return {name: runs()[name].result(one) for name, one in mine.items() if len(one)}


def show(context: Context) -> None:
    """Give the cost of each level of the model."""
    from verification.instruments.interactive import draw_chart

    charts = results(context.tables[NAME])
    won = pd.concat([chart.cheapest(TARGETS).assign(model=name) for name, chart in charts.items()])
    times = pd.concat([chart.costs(TARGETS).reset_index().assign(model=name) for name, chart in charts.items()])
    costs = {"model": "Model", "method": "Method"} | {target: f"Time to {target:g} [s]" for target in TARGETS}
    first = {"model": "Model", "target": "Error", "cheapest": "Cheapest", "tied": "Tied", "cost": "CPU time [s]"}
    context.charts["meanfield"] = draw_chart(charts, ("cpu_seconds",))
    context.draw(NAME, draw_results, charts, 1, 3.8)
    context.show(NAME, won[list(first)].rename(columns=first))
    context.show(f"{NAME}_times", times[list(costs)].rename(columns=costs), NAME)
