"""More sweeps or smaller steps: PBD and XPBD with equal numbers of sweeps in all, in few steps or in many."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache, partial
from typing import Any

import numpy as np
import pandas as pd

import dincl
from dincl.drifts import constant
from verification.instruments.references import Known, reference
from verification.instruments.stability import StabilityRuns, judged_run
from verification.methods.stability.schemes import Map

LINKS, COLUMN = 20, 20
# Of the references, far below all errors of the map [length].
TOL = 1e-9


def chain() -> dincl.Problem:
    """Return a slack rope of links that is pulled apart at its ends."""
    bent = np.column_stack([0.9 * np.arange(LINKS), 0.2 * (-1.0) ** np.arange(LINKS)])
    pull = np.zeros((LINKS, 2))
    pull[-1], pull[0] = (5.0, 2.0), (-1.0, 0.0)
    return dincl.Problem(bent, constant(pull), [dincl.MaxDistance([(k, k + 1) for k in range(LINKS - 1)], 1.0)])


def column() -> dincl.Problem:
    """Return a column of balls that falls on the ground, one ball after another: each carries all balls above it."""
    height = 0.5 + 1.05 * np.arange(COLUMN)
    ground = dincl.HalfSpace(normal=(1,), radius=0.5)
    return dincl.Problem(height[:, None], constant((-1.0,)), [dincl.NonOverlap(0.5), ground])


# Name -> problem, end [time].
SCENES: Mapping[str, tuple[Callable[[], dincl.Problem], float]] = {
    "four discs": (dincl.scenes.four_disks, 2.0),
    "chain of 20 links": (chain, 2.0),
    "column of 20 balls": (column, 2.0),
    "stack of 6 intervals": (dincl.scenes.stack, 1.5),
    "pile of 30 discs": (partial(dincl.scenes.pile, 30), 1.0),
}
METHODS = {"PBD": dincl.PBD, "XPBD": dincl.XPBD}
SWEEPS = (1, 2, 4, 8, 16, 32, 64)


@cache
def exact(scene: str) -> Known:
    """Return the solution of a scene at ten times."""
    make, end = SCENES[scene]
    return reference(make(), TOL)(np.linspace(0.0, end, 11)[1:])


def run(scene: str, method: Callable[..., dincl.Scheme], sweeps: float, total: float) -> dict[str, Any]:
    """Run total / sweeps steps."""
    make, end = SCENES[scene]
    known = exact(scene)
    return judged_run(make(), method(end * sweeps / total, sweeps=round(sweeps)), known.t, known.x)


MAP = Map(
    "sweeps_or_steps",
    "more sweeps or smaller steps",
    StabilityRuns(
        None,
        {f"{name}, {scene}": partial(run, scene, method) for name, method in METHODS.items() for scene in SCENES},
        x=("sweeps", SWEEPS, "sweeps in a step"),
        y=("total", (256, 1024, 4096), "sweeps in all"),
    ),
)


def divisions(table: pd.DataFrame) -> pd.DataFrame:
    """Return for each method and number of sweeps in all: the best sweeps in a step, and errors over the least error.

    ``one`` is the error with one sweep in a step over the least error, ``most`` the error with most sweeps.
    """
    errors = table.pivot_table(index=["method", "total"], columns="sweeps", values="error", sort=False)
    least = errors.min(axis=1)
    found = {
        "best": errors.idxmin(axis=1),
        "error": least,
        "one": errors[SWEEPS[0]] / least,
        "most": errors[SWEEPS[-1]] / least,
    }
    return pd.DataFrame(found).reset_index()
