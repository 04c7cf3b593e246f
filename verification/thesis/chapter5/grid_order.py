"""The PDE on grids against the density that the flow carries exactly: order in the cell, jumps, mass, moments."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

from dincl.study import Key, Row, Study
from meanfield import GridMotion, Moments, push_forward, solve_characteristics, solve_moments, solve_pde, w1
from meanfield.solvers.grid.cells import CellGrid
from meanfield.solvers.push_forward import origins
from verification.instruments.order import estimate, order_text
from verification.thesis.chapter5 import cases, exact

Floats = NDArray[np.float64]
T = np.array([2.0])
EXACT = 1e-10
LINE, PLANE = ("straight", "wavy", "uniform"), ("element",)
SMOOTH = ("straight", "wavy", "element")
# A grid that holds the density all the time, so that all grids of a model have the same box.
BOXES: dict[str, ArrayLike] = {
    "straight": (0.2, 2.8),
    "wavy": (0.2, 3.0),
    "uniform": (0.2, 2.8),
    "element": ((-0.1, -0.4), (1.9, 1.1)),
}
QUANTITIES = {"error_f": "f in L1", "error_w1": "W1", "error_y": "y at the end"}


class Carried(NamedTuple):
    """f0(x0) |det g_X(x)| / |det g_X(x0)|: a density that the flow carried, as ``CellGrid.averages`` takes it."""

    name: str
    y: Floats
    lower: Floats
    upper: Floats
    breaks: tuple[float, ...] = ()

    def density(self, x: Floats) -> Floats:
        """Return f at points (n, nx)."""
        model, y0 = cases.model(self.name), np.array(cases.CASES[self.name].y0)
        before = origins(model, x, self.y, y0)
        now, then = (np.linalg.det(model.jacobians(*at)[0]) for at in ((x, self.y), (before, y0)))
        return np.asarray(cases.law(self.name).density(before) * np.abs(now / then))


class Limit(NamedTuple):
    """y (ny,) and the second moment (nx, nx) at the end, by characteristics; y by moments, NaN where none close."""

    y: Floats
    second: Floats
    y_by_moments: Floats


@dataclass(frozen=True)
class GridForm:
    """Numbers of cells along a line and along each side of a plane; the models on each."""

    cells: tuple[int, ...]
    plane_cells: tuple[int, ...]
    line: tuple[str, ...] = LINE
    plane: tuple[str, ...] = PLANE


FULL = GridForm((50, 80, 128, 205, 328, 525, 840, 1344), (24, 36, 54, 80, 120, 180, 270))


def study(form: GridForm) -> Study:
    """Make a row for each grid."""
    runs = [
        {"model": name, "cells": n}
        for names, counts in ((form.plane, form.plane_cells), (form.line, form.cells))
        for name in names
        for n in reversed(counts)
    ]
    return Study(
        name="meanfield_grid",
        title="Mean field: order in the grid",
        key=("model", "cells"),
        runs=tuple(runs),
        run=_row,
    )


@cache
def limit(name: str) -> Limit:
    """Return the characteristics that the PDE is compared with."""
    case, model, law = cases.CASES[name], cases.model(name), cases.law(name)
    start = case.y0, case.v0, T, EXACT
    flow = solve_characteristics(model, law, *start)
    X, w = flow.X[0], np.asarray(flow.weights)
    closes = name != "wavy"
    by_moments = solve_moments(model, Moments(*law.moments()), *start).y[0] if closes else np.full(model.ny, np.nan)
    return Limit(flow.y[0], (X * w[:, None]).T @ X, by_moments)


def _row(key: Key) -> list[Row]:
    name = key["model"]
    case, known = cases.CASES[name], limit(name)
    motion = solve_pde(cases.model(name), cases.law(name), case.y0, case.v0, T, key["cells"], bounds=BOXES[name])
    return [dict(key) | _errors(name, motion, known) | {"width": float(CellGrid(motion.edges).spacing.max())}]


def _errors(name: str, motion: GridMotion, known: Limit) -> dict[str, Any]:
    grid, model, law = CellGrid(motion.edges), cases.model(name), cases.law(name)
    y0 = np.array(cases.CASES[name].y0)
    distance = np.nan
    if model.nx == 1:
        true = exact.averages(model, law, y0, known.y, grid.edges[0])
        distance = w1(motion.density(0), push_forward(model, law, y0, known.y))
    else:
        low, high = np.asarray(BOXES[name])
        true = grid.averages(Carried(name, known.y, low, high))  # type: ignore[arg-type]
    return {
        "error_f": float(np.abs(motion.f[0].ravel() - true.ravel()).sum() * grid.volume),
        "error_w1": float(distance),
        "error_y": float(np.linalg.norm(motion.y[0] - known.y)),
        "error_moment": float(np.abs(motion.second_moment()[0] - known.second).max()),
        "moments_apart": float(np.linalg.norm(known.y_by_moments - known.y)),
        "mass": float(abs(motion.mass()[0] - 1)),
        "least": float(motion.f.min()),
    }


def orders(table: pd.DataFrame) -> pd.DataFrame:
    """Fit orders in the width of a cell, with the ranges of local orders, for each model and quantity."""
    rows = []
    for name, mine in table.groupby("model", sort=False):
        row: dict[str, Any] = {"model": name, "smooth": name in SMOOTH, "finest": int(mine["cells"].max())}
        for column in QUANTITIES:
            if mine[column].notna().all():
                fit = estimate(mine["width"], mine[column], EXACT)
                row[f"order_{column}"] = order_text(fit)
                row[f"slope_{column}"] = np.nan if fit.slope is None else fit.slope
            row[f"least_{column}"] = float(mine[column].min())
        row |= {column: float(mine[column].max()) for column in ("mass", "moments_apart")}
        rows.append(row | {"least": float(mine["least"].min())})
    return pd.DataFrame(rows).fillna({f"order_{column}": "—" for column in QUANTITIES})
