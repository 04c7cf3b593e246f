"""Orders of convergence: the two experiments of chapter 2 (its Figures 4 and 5), and sets that turn, close and grow."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache, partial
from pathlib import Path

import pandas as pd

import verification
from dincl import scenes
from dincl.study import Study, joined
from verification.instruments.orders import OrderRuns, OrderStudy
from verification.methods.methods import (
    CATCH_UP,
    CATCH_UP_ACTIVE,
    COMPARED,
    LINEARISED_ACTIVE,
    LINEARISED_CLARABEL,
    LINEARISED_CVXPY,
    MIDPOINT_ACTIVE,
    PBD,
    PENALTY_TIED,
)
from verification.methods.references import TOL
from verification.site.sheet import sheet

EXPERIMENTS = (scenes.four_disks, scenes.ten_disks_corner)
# Their solutions are known exactly.
MOVING = (scenes.drum, partial(scenes.drum, 2), scenes.closing_walls, scenes.growing_discs)
ON_MOVING = (PBD, CATCH_UP_ACTIVE, LINEARISED_ACTIVE, MIDPOINT_ACTIVE, PENALTY_TIED)
STEPS = [0.1 / 2**k for k in range(10)]
# A step of these calls a solver of an external library.
COSTLY = {method.label: STEPS[:8] for method in (CATCH_UP, LINEARISED_CLARABEL, LINEARISED_CVXPY)}
# Equally spaced output times of the sets that move.
TIMES = 20
# Errors below these come from the tolerances of the projections [length].
FLOOR, MOVING_FLOOR = 1e-9, 1e-11


@cache
def problems() -> dict[str, OrderRuns]:
    """Return title of a scene -> the runs on it."""
    found = []
    for scene in [make() for make in EXPERIMENTS]:
        exact = verification.reference(scene, TOL)
        errors: list[str | float] = [*scene.times, "overlap"]
        found.append(OrderRuns(scene, COMPARED, {"dt": STEPS} | COSTLY, scene.times, exact, errors, floor=FLOOR))
    for scene in [make() for make in MOVING]:
        times = [scene.times[-1] * k / TIMES for k in range(1, TIMES + 1)]
        norms = ("largest", "overlap")
        found.append(OrderRuns(scene, ON_MOVING, STEPS[:8], times, scene.exact, norms, floor=MOVING_FLOOR))
    return {runs.problem.title: runs for runs in found}


def study(smallest: bool = False) -> Study:
    """Return all runs."""
    return joined(
        "orders", "Orders of convergence", {name: runs.study(smallest=smallest) for name, runs in problems().items()}
    )


def results(rows: pd.DataFrame) -> dict[str, OrderStudy]:
    """Return title of a scene -> what the rows say of it."""
    return {name: runs.result(rows[rows["problem"] == name]) for name, runs in problems().items()}


def fits(rows: pd.DataFrame) -> pd.DataFrame:
    """Return the fitted orders: one row for each scene, method and error."""
    return pd.concat([one.fits.assign(problem=name) for name, one in results(rows).items()], ignore_index=True)


HEADINGS = {
    "problem": "Scene",
    "error": "Error",
    "method": "Method",
    "order": "Order [range]",
    "finest": "Finest dt [time]",
    "finest_error": "Error there [length]",
    "failed": "Failed",
    "verdict": "In words",
}


def draw(rows: pd.DataFrame, panels: Sequence[tuple[str, str]], path: Path) -> Path:
    """Draw errors against the step, a panel for each scene and error."""
    found = results(rows)
    with sheet(path, 2.8 * len(panels)) as figure:
        axes = figure.subplots(len(panels), squeeze=False)[:, 0]
        for panel, (name, error) in zip(axes, panels, strict=True):
            found[name].plot(panel, error).set_title(name)
    return path
