"""Speed against accuracy: y at the end of a mean-field problem by every level of the model; one right-hand side."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, partial
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from dincl.study import Key, Row, Study
from meanfield import solve_characteristics
from meanfield.forces.field import field, field_by_numpy
from meanfield.forces.interaction import forces
from verification.instruments.meanfield_methods import DensityProblem, prepared
from verification.thesis.chapter5 import cases, exact

Floats = NDArray[np.float64]
T = np.array([4.0])
MODELS = ("straight", "wavy")
# Not for WavyFibre, whose moments do not close and which cannot be reduced.
CLOSED = ("reduced", "moments")
REFERENCE = 1e-13
PARTICLES = (4, 32, 256, 2048, 16_384, 131_072, 1_048_576)
TOLERANCES = tuple(10.0**-k for k in range(2, 13))
TOLERATED = ("characteristics", "moments")
CELLS = (32, 64, 128, 256, 512, 1024, 2048)
SETTINGS: dict[str, Sequence[float]] = {
    "dae": PARTICLES[:5],
    "rattle4": PARTICLES[:5],
    "ode": PARTICLES,
    "reduced": PARTICLES,
    "characteristics": TOLERANCES,
    "moments": TOLERANCES,
    "pde": CELLS,
}
# The best of so many runs is taken.
REPEATS = 4
# One right-hand side: particles, and with all pairs.
MANY, PAIRED = 1_000_000, 3000
SIDES = ("straight", "linear", "wavy", "element", "interacting")
TIMED = 3


@dataclass(frozen=True)
class CostForm:
    """How far the study goes.

    Attributes
    ----------
    enough
        Finer settings are left out after a run that takes longer [s]; one that does is not repeated.
    stride
        Between the tolerances that are taken.
    """

    enough: float
    stride: int
    settings: Mapping[str, Sequence[float]]
    models: tuple[str, ...] = MODELS


@dataclass(frozen=True)
class SideForm:
    """The models, and how many particles."""

    models: tuple[str, ...] = SIDES
    particles: int = MANY


FULL = CostForm(3.0, 1, SETTINGS)
# There is one form only.
SIDE = SideForm()


def study(form: CostForm) -> Study:
    """Plan all methods on both models, a row for each setting."""
    runs = [
        {"model": name, "method": method}
        for method in form.settings
        for name in form.models
        if not (name == "wavy" and method in CLOSED)
    ]
    return Study(
        name="meanfield_cost",
        title="Mean field: speed against accuracy",
        key=("model", "method"),
        runs=tuple(runs),
        run=partial(_rows, form.settings, form.enough, form.stride),
    )


def _rows(settings: Mapping[str, Sequence[float]], enough: float, stride: int, key: Key) -> list[Row]:
    name, method = key["model"], key["method"]
    true, rows = reference(name), list[Row]()
    for setting in settings[method][:: stride if method in TOLERATED else 1]:
        ask = question(name, method, setting)
        # The first of them may compile: some kernels are made for many particles only.
        seconds, found = _timed(ask, 2)
        if seconds <= enough:
            seconds = min(seconds, _timed(ask, REPEATS - 2)[0])
        error = float(np.linalg.norm(found.y[-1] - true))
        rows.append(
            dict(key) | {"setting": setting, "seconds": seconds, "error": error, "unknowns": found.work.unknowns}
        )
        if seconds > enough:
            break
    return rows


def question(name: str, method: str, setting: float) -> Callable[[], Any]:
    """Return a call that computes y(T) from the density, to be timed; particles are at quantiles found before."""
    case = cases.CASES[name]
    problem = DensityProblem(cases.model(name), cases.law(name), case.y0, case.v0)
    return prepared(method, problem, setting if method in TOLERATED else 1 / setting, T)


@cache
def reference(name: str) -> Floats:
    """Return y(T): in closed form from the second moment, or by characteristics to rounding."""
    law, case = cases.law(name), cases.CASES[name]
    if name == "straight":
        second = float(law.moments()[1][0, 0])
        return np.asarray(exact.harmonic(name, np.array([[np.sqrt(second)]]), T).y[0])
    return np.asarray(solve_characteristics(cases.model(name), law, case.y0, case.v0, T, REFERENCE).y[0])


def _timed(action: Callable[[], Any], repeats: int) -> tuple[float, Any]:
    """Return the least of some times, and the result."""
    best, found = np.inf, None
    for _ in range(repeats):
        began = time.process_time()
        found = action()
        best = min(best, time.process_time() - began)
    return best, found


def side_study(form: SideForm) -> Study:
    """Time one right-hand side of the ODE with many particles, one pass over the array, and the NumPy reference."""
    return Study(
        name="meanfield_side",
        title="Mean field: one right-hand side",
        key=("model",),
        runs=tuple({"model": name} for name in form.models),
        run=partial(_side, form.particles),
    )


def _side(many: int, key: Key) -> list[Row]:
    name = key["model"]
    model, case = cases.model(name), cases.CASES[name]
    X = np.tile(cases.law(name).sample(cases.stream("start", many), many // 10), (10, 1))

    def side(way: Callable[..., Any], given: Floats, repeats: int) -> tuple[float, Any]:
        return _timed(lambda: way(model, given, None, np.array(case.y0), np.array(case.v0)), repeats)

    side(field, X, 1)
    one, _ = side(field, X, TIMED)
    reading, _ = _timed(X.sum, TIMED)
    # The twin takes so much longer that a tenth of the particles will do.
    (part, found), (twin, other) = side(field, X[: many // 10], TIMED), side(field_by_numpy, X[: many // 10], 1)
    off = max(float(np.abs(found.force - other.force).max()), float(np.abs(found.mass - other.mass).max()))
    row = {"N": many, "seconds": one, "reading": one / reading, "twin": twin / part, "off": off}
    row |= {"pairs": np.nan, "pairs_off": np.nan}
    if model.V is not None:
        row |= _pairs(name)
    return [dict(key) | row]


def _pairs(name: str) -> dict[str, float]:
    """Time the sum over all pairs by NumPy against the interaction of the package, for PAIRED particles."""
    model, X = cases.model(name), cases.law(name).sample(cases.stream("start", PAIRED), PAIRED)
    fast, found = _timed(lambda: forces(model, X, None), TIMED)
    direct, true = _timed(lambda: np.array([model.K(X - x).mean(axis=0) for x in X]), 1)
    return {"pairs": direct / fast, "pairs_off": float(np.abs(found - true).max())}


def seconds_to(table: pd.DataFrame, targets: Sequence[float]) -> pd.DataFrame:
    """Return the least time of the settings that reach an error, for each model and method; NaN if none does."""
    rows = []
    for (name, method), mine in table.groupby(["model", "method"], sort=False):
        row: dict[str, Any] = {"model": name, "method": method}
        for target in targets:
            reached = mine[mine["error"] <= target]
            row |= {f"{target:g}": float(reached["seconds"].min()) if len(reached) else np.nan}
        rows.append(row | {"best": float(mine["error"].min()), "most": int(mine["unknowns"].max())})
    return pd.DataFrame(rows)
