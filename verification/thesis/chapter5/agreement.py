"""DAE and ODE against each other: errors of y, y', X and the multipliers; drift of g."""
# ruff: noqa: RUF001 - headings for readers have minus signs

from __future__ import annotations

from dataclasses import replace
from functools import cache
from operator import itemgetter

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from dincl.study import Study, joined
from meanfield import Motion, solve_dae, solve_ode
from verification.instruments.error_norms import ErrorOf
from verification.instruments.meanfield_methods import ParticleProblem, particle_methods
from verification.instruments.orders import OrderRuns, OrderStudy
from verification.instruments.references import Known
from verification.instruments.result import draw_results
from verification.site.context import Context
from verification.thesis.chapter5 import cases, exact

Floats = NDArray[np.float64]
NAME, SHOWN = "meanfield_agreement", "wavy"
MODELS = ("straight", "linear", "wavy", "element", "interacting")
HARMONIC = ("straight", "linear")
PARTICLES = 5
T = np.array([0.0, 1.0, 2.0])
TOLERANCES = tuple(10.0**-k for k in range(3, 13))
# The ODE at its tightest tolerance is the reference where there is no closed form; the DAE gives its error.
TIGHTEST = 1e-13
COMPARED, DRIFTS = ("y", "v", "X", "multipliers"), ("drift", "velocity_drift")
HEADINGS = {
    "model": "Model",
    "method": "Method",
    "setting": "Tolerance",
    "y": "Error of y",
    "v": "Error of y'",
    "X": "Error of X",
    "multipliers": "Error of λ",
    "drift": "|g − c|",
    "velocity_drift": "|g'|",
}


def state(motion: Motion) -> Floats:
    """Return (K, D): y, y', X, the multipliers, and the drift of g and of g'."""
    parts = [np.reshape(getattr(motion, name), (len(motion.t), -1)) for name in COMPARED]
    return np.column_stack([*parts, motion.constraint_drift(), motion.velocity_drift()])


@cache
def runs() -> dict[str, OrderRuns]:
    """Return what is run on each model."""
    found, methods = {}, particle_methods(state)
    for name in MODELS:
        model, start = cases.model(name), cases.few(name, PARTICLES)
        ends = np.cumsum((0, model.ny, model.ny, *2 * (PARTICLES * model.nx,), 1, 1)).tolist()
        parts = {key: slice(*ends[k : k + 2]) for k, key in enumerate((*COMPARED, *DRIFTS))}
        path, off = reference(name)
        known = Known(T, path, np.full(len(T), off.max()))
        errors = {key: ErrorOf(key, itemgetter(part), float(off[part].max())) for key, part in parts.items()}
        problem = ParticleProblem(model, start)
        chosen = list(methods.values())
        found[cases.TITLES[name]] = OrderRuns(problem, chosen, {"tol": TOLERANCES}, T, known, errors)
    return found


def reference(name: str) -> tuple[Floats, Floats]:
    """Return the true states (K, D) and their largest errors over time (D,).

    They are a closed form, or else the ODE to rounding, whose error is its distance from the DAE.
    """
    model, start = cases.model(name), cases.few(name, PARTICLES)
    if name in HARMONIC:
        path = [part.reshape(len(T), -1) for part in exact.harmonic(name, np.asarray(start.X), T)]
        rounding = [np.full(part.shape[1], np.spacing(np.abs(part).max())) for part in path]
        return np.column_stack([*path, np.zeros((len(T), 2))]), np.concatenate([*rounding, np.zeros(2)])
    best, other = state(solve_ode(model, start, T, TIGHTEST)), state(solve_dae(model, start, T, TIGHTEST))
    best[:, -2:] = other[:, -2:] = 0.0  # the drifts
    return best, np.abs(best - other).max(axis=0)


def study(smallest: bool = False) -> Study:
    """Return the study of all methods on all models."""
    parts = {name: one.study(smallest=smallest) for name, one in runs().items()}
    return replace(joined(NAME, "Mean field: agreement", parts, "model"), columns=HEADINGS)


def results(rows: pd.DataFrame) -> dict[str, OrderStudy]:
    """Return the orders on each model that rows of the study have."""
    mine = {name: rows[rows["model"] == name].drop(columns="model") for name in runs()}
    return {name: runs()[name].result(one) for name, one in mine.items() if len(one)}


def best(rows: pd.DataFrame) -> pd.DataFrame:
    """Return each method's row with the smallest largest error, on each model."""
    worst = rows[list(COMPARED)].max(axis=1)
    return rows.loc[worst.groupby([rows["model"], rows["method"]], sort=False).idxmin()].reset_index(drop=True)


def show(context: Context) -> None:
    """Give the agreement of the formulations."""
    found, title = results(context.tables[NAME]), cases.TITLES[SHOWN]
    context.draw(NAME, draw_results, {title: found[title]}, 1, 3.8)
    context.show(NAME, context.headed(NAME, best(context.tables[NAME])))
