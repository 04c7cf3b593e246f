"""Map of failure with the limit that theory predicts: a fibre that is pushed through y = 0."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import pandas as pd

from dincl.study import Study
from meanfield import Motion, State, Status, StraightFibre, solve_dae, solve_ode
from verification.instruments.outcome import Outcome
from verification.instruments.result import Result
from verification.instruments.stability import Limit, StabilityRuns
from verification.site.context import Context

NAME = "meanfield_pushed"
M, REST, K1 = 1.0, 1.5, 0.5
# Largest error of a run that converged, over its amplitude.
ERROR = 0.02
# Cells nearer to the limit than this, relative to it, may fall on either side.
NEAR = 0.05
# Endings that say that dg/dX is about to become singular.
SINGULAR = (Status.SINGULAR, Status.STEP_TOO_SMALL, Status.NOT_CONVERGED)
METHODS: dict[str, Callable[..., Motion]] = {
    "ODE (DOP853)": partial(solve_ode, tol=1e-8, throw=False),
    "DAE (IDAS)": partial(solve_dae, tol=1e-6, throw=False),
}


def pushed_through(speed: float) -> float:
    """Return the k0 of StraightFibre that reaches y = 0 from y = 1 with this speed inwards, by its amplitude."""
    return ((1 + M) * speed**2 + K1) / (2 * REST - 1)


def pushed(method: str, speed: float, k0: float) -> dict[str, Any]:
    """Run StraightFibre with particles at +-1 over one period, from y = 1 inwards."""
    model, start = StraightFibre(m=M, k0=k0, y_rest=REST, k1=K1), State(X=[[-1.0], [1.0]], y=[1.0], v=[-speed])
    # The particles are at +-y: y is harmonic, with the mass 1 + m and the stiffness k0 + k1.
    rate, middle = np.sqrt((k0 + K1) / (1 + M)), k0 * REST / (k0 + K1)
    motion = METHODS[method](model, start, [2 * np.pi / rate])
    if motion.status:
        error = abs(motion.y[-1, 0] - 1.0) / np.hypot(1 - middle, speed / rate)
        found = Outcome.CONVERGED if error <= ERROR else Outcome.INACCURATE
    else:
        found = Outcome.REFUSED if motion.status in SINGULAR else Outcome.UNSTABLE
    return {"outcome": found.value, "status": motion.status.name}


RUNS = StabilityRuns(
    None,
    {method: partial(pushed, method) for method in METHODS},
    x=("speed", np.geomspace(0.25, 8.0, 30).tolist(), "speed inwards"),
    y=("k0", np.geomspace(0.3, 8.0, 20).tolist(), "stiffness k0"),
    limits=[Limit("y reaches 0", pushed_through)],
)


def study(smallest: bool = False) -> Study:
    """Return the study of the map."""
    return RUNS.study(NAME, "Mean field, map: y through 0", smallest)


def agreement(table: pd.DataFrame) -> pd.DataFrame:
    """Count, for each method, the cells away from the limit and those that failed exactly where they should."""
    rows = []
    for method, mine in table.groupby("method", sort=False):
        ratio = mine["speed"].to_numpy() / np.sqrt(np.maximum((2 * REST - 1) * mine["k0"] - K1, 0.0) / (1 + M))
        failed = mine["outcome"].isin([Outcome.UNSTABLE.value, Outcome.REFUSED.value])
        clear = np.abs(ratio - 1) > NEAR
        right = int((failed == (ratio > 1))[clear].sum())
        rows.append({"Method": method, "Cells": int(clear.sum()), "As theory says": right})
    return pd.DataFrame(rows)


def show(context: Context) -> None:
    """Give the map."""
    table = context.tables[NAME]
    context.draw(NAME, Result.draw, RUNS.result(table))
    context.show("meanfield_maps", agreement(table), NAME)
