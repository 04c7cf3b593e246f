"""The PDE on grids against the density that the flow carries exactly: order in the cell, jumps, mass, moments."""

from __future__ import annotations

from dataclasses import replace
from functools import cache, partial
from operator import itemgetter
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

from dincl.study import Study
from meanfield import push_forward, solve_characteristics, solve_pde, w1
from verification.instruments.method import Method
from verification.instruments.orders import OrderRuns, OrderStudy
from verification.instruments.references import Known
from verification.site.context import Context
from verification.site.sheet import legend_below, sheet
from verification.thesis.chapter5 import cases, exact

Floats = NDArray[np.float64]
NAME, T, EXACT = "meanfield_grid", np.array([2.0]), 1e-10
# Cells of a grid that holds the density all the time, so that all grids of a model have the same box.
CELLS = (50, 80, 128, 205, 328, 525, 840, 1344)
BOXES = {"straight": (0.2, 2.8), "wavy": (0.2, 3.0), "uniform": (0.2, 2.8)}
# What is measured of a run: the errors of f in L1, W1, y and the second moment at the end, the error of the mass, and
# the least average of a cell.
MEASURED = ("f", "W1", "y", "moment", "mass", "least")
FITTED = MEASURED[:3]
HEADINGS = {
    "method": "Model",
    "order_f": "Order of f in L1 [range]",
    "order_W1": "Order of W1 [range]",
    "order_y": "Order of y [range]",
    "setting": "1 / cells",
    "f": "Error of f in L1",
    "W1": "W1",
    "y": "Error of y",
    "moment": "Error of the second moment",
    "mass": "Error of the mass",
    "least": "Least f",
}


class Limit(NamedTuple):
    """y (ny,) and the second moment at the end, by characteristics."""

    y: Floats
    second: float


@cache
def limit(name: str) -> Limit:
    """Return the characteristics that the PDE is compared with."""
    case = cases.CASES[name]
    flow = solve_characteristics(cases.model(name), cases.law(name), case.y0, case.v0, T, EXACT)
    return Limit(flow.y[0], float(flow.weights @ flow.X[0, :, 0] ** 2))


def measured(name: str, _problem: Any, setting: float, t: ArrayLike) -> Floats:
    """Return what is measured of one grid, (1, 6)."""
    case, model, law, known = cases.CASES[name], cases.model(name), cases.law(name), limit(name)
    motion = solve_pde(model, law, case.y0, case.v0, t, round(1 / setting), bounds=BOXES[name])
    true = push_forward(model, law, case.y0, known.y)
    off = np.abs(motion.f[0] - exact.averages(model, law, np.array(case.y0), known.y, motion.edges))
    off_f = float(off @ np.diff(motion.edges))
    distance = w1(motion.density(0), true)
    y, moment = np.linalg.norm(motion.y[0] - known.y), abs(motion.second_moment()[0, 0, 0] - known.second)
    return np.array([[off_f, distance, float(y), float(moment), abs(motion.mass()[0] - 1), motion.f.min()]])


@cache
def runs() -> OrderRuns:
    """Return what is run: a curve for each model; errors are measured in the run, so the reference is 0."""
    methods = [Method(cases.TITLES[name], run=partial(measured, name), setting="1/cells") for name in BOXES]
    settings = {"1/cells": [1 / n for n in CELLS]}
    known = Known(T, np.zeros((1, len(MEASURED))), np.full(1, EXACT))
    return OrderRuns(None, methods, settings, T, known, {name: itemgetter(k) for k, name in enumerate(MEASURED)})


def study(smallest: bool = False) -> Study:
    """Return the study of all grids."""
    return replace(runs().study(NAME, "Mean field: order in the grid", smallest), columns=HEADINGS)


def orders(found: OrderStudy) -> pd.DataFrame:
    """Return the orders in the width of a cell with the ranges of local orders, for each model."""
    fits = found.fits[found.fits["error"].isin(FITTED)]
    return fits.pivot(index="method", columns="error", values="order").add_prefix("order_").reset_index()


def figure(found: OrderStudy, path: Path) -> Path:
    """Draw the errors against 1/cells, one panel for each quantity."""
    with sheet(path, 3.3) as drawn:
        panels = drawn.subplots(1, len(FITTED))
        for panel, error in zip(panels, FITTED, strict=True):
            found.plot(panel, error).legend().remove()
            panel.set_title(f"error of {error}")
        legend_below(drawn, panels[:1], 2)
    return path


def show(context: Context) -> None:
    """Give the orders of finite volumes."""
    rows = context.tables[NAME]
    found = runs().result(rows)
    context.draw(NAME, figure, found)
    context.show(NAME, context.headed(NAME, orders(found)))
    context.show(f"{NAME}_all", context.headed(NAME, rows), NAME)
