"""Two maps of failure with the limits that theory predicts: stiff springs, and a fibre that is pushed through y = 0."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from dincl.errors import StepFailure
from dincl.study import Study
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
from verification.instruments.result import Result
from verification.instruments.stability import Limit, StabilityRuns
from verification.site.context import Context
from verification.thesis.chapter5.naive import solve_naive_rk4

Floats = NDArray[np.float64]
STIFF, PUSHED = "meanfield_stiff", "meanfield_pushed"
M, REST, K1 = 1.0, 1.5, 0.5
# Steps of a run with stiff springs, and how far from rest it starts: far beyond a limit it then grows past all bounds.
STEPS, AWAY = 100, 0.1
# Largest error of a run that converged, over its amplitude.
ERROR = 0.02
# Of classical Runge-Kutta on y'' = -y: |1 + z + z^2/2 + z^3/6 + z^4/24| = 1 at z = i dt.
RK4, RK4_LIMIT = "naive RK4", 2 * np.sqrt(2)
# Cells nearer to a limit than this, relative to it, may fall on either side: growth beyond it begins slowly.
NEAR, ROUNDING = 0.05, 1e-9
# Endings that say that dg/dX is about to become singular.
SINGULAR = (Status.SINGULAR, Status.STEP_TOO_SMALL, Status.NOT_CONVERGED)
STIFF_METHODS: dict[str, Callable[..., Motion]] = {
    "RATTLE of order 2": partial(solve_rattle, order=2),
    "RATTLE of order 4": partial(solve_rattle, order=4),
    RK4: solve_naive_rk4,
}
PUSHED_METHODS: dict[str, Callable[..., Motion]] = {
    "ODE (DOP853)": partial(solve_ode, tol=1e-8, throw=False),
    "DAE (IDAS)": partial(solve_dae, tol=1e-6, throw=False),
    "RATTLE of order 2": partial(solve_rattle, dt=0.02, throw=False),
}


def grows(method: str, x: Floats) -> NDArray[np.bool_]:
    """Return whether a method with fixed step grows on y'' = -omega^2 y, for x = dt omega (K,).

    RATTLE is Verlet's scheme there; a composition of its steps grows where the trace of their product is beyond 2,
    which it need not be for all x beyond the first.
    """
    if method == RK4:
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


def frequency(k0: Floats | float) -> Any:
    """Return sqrt((k0 + k1 s)/(1 + m s)) with s = 1: of LinearFibre, and of StraightFibre with particles at +-y."""
    return np.sqrt((k0 + K1) / (1 + M))


def stiffest(method: str, dt: float) -> float:
    """Return the k0 of LinearFibre with dt omega at the limit of a method."""
    return (1 + M) * (limit(method) / dt) ** 2 - K1


def pushed_through(speed: float) -> float:
    """Return the k0 of StraightFibre that reaches y = 0 from y = 1 with this speed inwards, by its amplitude."""
    return ((1 + M) * speed**2 + K1) / (2 * REST - 1)


def stiff(method: str, dt: float, k0: float) -> dict[str, Any]:
    """Run LinearFibre over STEPS steps from near its rest."""
    middle = (k0 * REST) / (k0 + K1)
    y0 = middle + AWAY
    model, start = _model(LinearFibre, k0), State(X=[[y0 - 0.3], [y0 + 0.3]], y=[y0], v=[0.0])
    # The particles are at y +- 0.3, so that their mean pull is that of one at y.
    end = STEPS * dt
    try:
        motion = STIFF_METHODS[method](model, start, [end], dt)
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
    motion = PUSHED_METHODS[method](model, start, [2 * np.pi / rate])
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


MAPS = {
    STIFF: StabilityRuns(
        None,
        {method: partial(stiff, method) for method in STIFF_METHODS},
        x=("dt", np.geomspace(0.01, 4.0, 40).tolist(), "step dt [time]"),
        y=("k0", np.geomspace(1.0, 1e4, 30).tolist(), "stiffness k0"),
        limits=[Limit(f"dt ω = {limit(method):.3g}", partial(stiffest, method), [method]) for method in STIFF_METHODS],
    ),
    PUSHED: StabilityRuns(
        None,
        {method: partial(pushed, method) for method in PUSHED_METHODS},
        x=("speed", np.geomspace(0.25, 8.0, 30).tolist(), "speed inwards"),
        y=("k0", np.geomspace(0.3, 8.0, 20).tolist(), "stiffness k0"),
        limits=[Limit("y reaches 0", pushed_through)],
    ),
}
TITLES = {STIFF: "stiff springs", PUSHED: "y through 0"}


def study(name: str, smallest: bool = False) -> Study:
    """Return the study of one of the maps."""
    return MAPS[name].study(name, f"Mean field, map: {TITLES[name]}", smallest)


def agreement(name: str, table: pd.DataFrame) -> pd.DataFrame:
    """Count, for each method, the cells away from the limit and those that failed exactly where they should."""
    rows = []
    for method, mine in table.groupby("method", sort=False):
        k0 = mine["k0"].to_numpy()
        if name == STIFF:
            x = mine["dt"].to_numpy() * frequency(k0)
            ratio, expected = x / limit(str(method)), grows(str(method), x)
        else:
            ratio = mine["speed"].to_numpy() / np.sqrt(np.maximum((2 * REST - 1) * k0 - K1, 0.0) / (1 + M))
            expected = ratio > 1
        failed = mine["outcome"].isin([Outcome.UNSTABLE.value, Outcome.REFUSED.value]).to_numpy()
        clear = np.abs(ratio - 1) > NEAR
        right = int((failed == expected)[clear].sum())
        rows.append({"Map": TITLES[name], "Method": method, "Cells": int(clear.sum()), "As theory says": right})
    return pd.DataFrame(rows)


def show(context: Context) -> None:
    """Give the two maps."""
    for name, runs in MAPS.items():
        context.draw(name, Result.draw, runs.result(context.tables[name]))
    counts = pd.concat([agreement(name, context.tables[name]) for name in MAPS], ignore_index=True)
    context.show("meanfield_maps", counts, STIFF)
