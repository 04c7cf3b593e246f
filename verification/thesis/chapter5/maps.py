"""Two maps of failure with the limits that theory predicts: stiff springs, and a fibre that is pushed through y = 0."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, partial
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from dincl.errors import StepFailure
from dincl.study import Key, Row, Study
from meanfield import (
    LinearFibre,
    Model,
    Motion,
    SolveFailed,
    State,
    Status,
    StraightFibre,
    solve_dae,
    solve_ode,
    solve_rattle,
)
from meanfield.solvers.rattle import SUBSTEPS
from verification.instruments.outcome import FAR, Outcome
from verification.thesis.chapter2.stability.outcome import ERROR
from verification.thesis.chapter2.stability.plane import Axis, Line, Plane, geometric
from verification.thesis.chapter5.methods import LABELS
from verification.thesis.chapter5.naive import solve_naive_rk4
from verification.thesis.chapter5.provoked import SINGULAR

Floats = NDArray[np.float64]
M, REST, K1 = 1.0, 1.5, 0.5
# Steps of a run with stiff springs, and how far from rest it starts: far beyond a limit it then grows past all bounds.
STEPS, AWAY = 100, 0.1
# Of classical Runge-Kutta on y'' = -y: |1 + z + z^2/2 + z^3/6 + z^4/24| = 1 at z = i dt.
RK4_LIMIT = 2 * np.sqrt(2)
# Cells nearer to a limit than this, relative to it, may fall on either side: growth beyond it begins slowly.
NEAR = 0.05
ROUNDING = 1e-9
STIFF: dict[str, Callable[..., Motion]] = {
    "rattle2": partial(solve_rattle, order=2),
    "rattle4": partial(solve_rattle, order=4),
    "rk4": solve_naive_rk4,
}
PUSHED: dict[str, Callable[..., Motion]] = {
    "ode": partial(solve_ode, tol=1e-8, throw=False),
    "dae": partial(solve_dae, tol=1e-6, throw=False),
    "rattle2": partial(solve_rattle, dt=0.02, throw=False),
}


def grows(method: str, x: Floats) -> NDArray[np.bool_]:
    """Return whether a method with fixed step grows on y'' = -omega^2 y, for x = dt omega (K,).

    RATTLE is Verlet's scheme there; a composition of its steps grows where the trace of their product is beyond 2,
    which it need not be for all x beyond the first.
    """
    if method == "rk4":
        return np.asarray(x > RK4_LIMIT)
    product = np.broadcast_to(np.eye(2), (len(x), 2, 2))
    for part in SUBSTEPS[int(method[-1])]:
        h = part * x
        step = np.stack([1 - h**2 / 2, h, h**3 / 4 - h, 1 - h**2 / 2], axis=-1).reshape(-1, 2, 2)
        product = step @ product
    return np.asarray(np.abs(np.trace(product, axis1=1, axis2=2)) > 2 + ROUNDING)


@cache
def limit(method: str) -> float:
    """Return the least dt omega at which a method grows."""
    x = np.linspace(0.001, 4.0, 4000)
    return float(x[grows(method, x)][0])


def longest_step(method: str, k0: Floats) -> Floats:
    """Return the limit of dt for LinearFibre."""
    found: Floats = limit(method) / frequency(k0)
    return found


def frequency(k0: Floats | float) -> Any:
    """Return sqrt((k0 + k1 s)/(1 + m s)) with s = 1: of LinearFibre, and of StraightFibre with particles at +-y."""
    return np.sqrt((k0 + K1) / (1 + M))


def least_speed(k0: Floats) -> Floats:
    """Return the speed inwards from y = 1 with which StraightFibre reaches 0, by its amplitude."""
    middle = k0 * REST / (k0 + K1)
    found: Floats = frequency(k0) * np.sqrt(np.maximum(2 * middle - 1, 0.0))
    return found


def stiff(method: str, dt: float, k0: float) -> dict[str, Any]:
    """Run LinearFibre over STEPS steps from near its rest."""
    middle = (k0 * REST) / (k0 + K1)
    y0 = middle + AWAY
    model, start = _model(LinearFibre, k0), State(X=[[y0 - 0.3], [y0 + 0.3]], y=[y0], v=[0.0])
    # The particles are at y +- 0.3, so that their mean pull is that of one at y.
    end = STEPS * dt
    try:
        motion = STIFF[method](model, start, [end], dt)
    except (SolveFailed, StepFailure) as failure:
        return {"outcome": Outcome.UNSTABLE.value, "status": failure.status.name}
    if not abs(motion.y[-1, 0] - middle) <= FAR * AWAY:
        return {"outcome": Outcome.UNSTABLE.value, "status": motion.status.name}
    error = abs(motion.y[-1, 0] - middle - AWAY * np.cos(frequency(k0) * end))
    return _ended(motion.status, error / AWAY)


def pushed(method: str, speed: float, k0: float) -> dict[str, Any]:
    """Run StraightFibre with particles at +-1 over one period, from y = 1 inwards."""
    model, start = _model(StraightFibre, k0), State(X=[[-1.0], [1.0]], y=[1.0], v=[-speed])
    rate, middle = frequency(k0), k0 * REST / (k0 + K1)
    end = 2 * np.pi / rate
    motion = PUSHED[method](model, start, [end])
    if motion.status in SINGULAR:
        return {"outcome": Outcome.REFUSED.value, "status": motion.status.name}
    if not motion.status:
        return {"outcome": Outcome.UNSTABLE.value, "status": motion.status.name}
    return _ended(motion.status, abs(motion.y[-1, 0] - 1.0) / np.hypot(1 - middle, speed / rate))


def _ended(status: Status, error: float) -> dict[str, Any]:
    found = Outcome.CONVERGED if error <= ERROR else Outcome.INACCURATE
    return {"outcome": found.value, "status": status.name}


@cache
def _model(kind: Callable[..., Model], k0: float) -> Model:
    return kind(m=M, k0=k0, y_rest=REST, k1=K1)


PLANES = (
    Plane(
        name="meanfield_stiff",
        title="stiff springs",
        x=Axis("dt", geometric(0.01, 4.0, 40)),
        y=Axis("stiffness k0", geometric(1.0, 1e4, 30)),
        methods={"rattle2": LABELS["rattle2"], "rattle4": LABELS["rattle4"], "rk4": "naive RK4"},
        cell=stiff,
        lines=tuple(Line(f"dt ω = {limit(method):.3g}", (method,), partial(longest_step, method)) for method in STIFF),
    ),
    Plane(
        name="meanfield_pushed",
        title="y through 0",
        x=Axis("speed inwards", geometric(0.25, 8.0, 30)),
        y=Axis("stiffness k0", geometric(0.3, 8.0, 20)),
        methods={method: LABELS[method] for method in PUSHED},
        cell=pushed,
        lines=(Line("y reaches 0", tuple(PUSHED), least_speed),),
    ),
)


@dataclass(frozen=True)
class MeanFieldMapsForm:
    """Which planes are mapped."""

    planes: tuple[Plane, ...] = PLANES


# There is one form only.
FORM = MeanFieldMapsForm()


def study(plane: Plane) -> Study:
    """Run each method at each y, with a row for each x."""
    return Study(
        name=plane.name,
        title=f"Mean field, map: {plane.title}",
        key=("method", "y"),
        runs=tuple({"method": method, "y": y} for y in plane.y.values[::-1] for method in plane.methods),
        run=partial(_row, plane.cell, plane.x.values),
    )


def _row(cell: Callable[[str, float, float], dict[str, Any]], xs: tuple[float, ...], key: Key) -> list[Row]:
    return [dict(key) | {"x": x} | cell(key["method"], x, key["y"]) for x in xs]


def agreement(table: pd.DataFrame, plane: Plane) -> pd.DataFrame:
    """Count, for each method, the cells away from the limit and those that failed exactly where they should."""
    rows = []
    for method, mine in table.groupby("method", sort=False):
        x, y = mine["x"].to_numpy(), mine["y"].to_numpy()
        stepped = plane.cell is stiff
        ratio = x / (longest_step(method, y) if stepped else least_speed(y))
        expected = grows(method, x * frequency(y)) if stepped else ratio > 1
        failed = mine["outcome"].isin([Outcome.UNSTABLE.value, Outcome.REFUSED.value]).to_numpy()
        clear = np.abs(ratio - 1) > NEAR
        right = int((failed == expected)[clear].sum())
        rows.append({"map": plane.title, "method": plane.methods[method], "cells": int(clear.sum()), "right": right})
    return pd.DataFrame(rows)
