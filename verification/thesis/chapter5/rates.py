"""Rates at which N particles find the mean-field limit: W1 at the start and through the flow, and the error of y.

Starts of the unit cube in d = 1, 2, 3 without a flow; densities of models and their flows to T.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pandas as pd

from dincl.study import Study, joined
from meanfield import Density
from verification.instruments.rates import FEWEST_SIZES, QUANTILES, W1Rates, W1Runs
from verification.instruments.result import draw_results
from verification.site.context import Context
from verification.thesis.chapter5 import cases

NAME, TITLE, T = "meanfield_rates", "How fast do N particles find their limit?", 4.0
# Random numbers: of the cube and of the flows; the place of a model among these.
CUBE_SEED, FLOW_SEED, PLACE = (20260105, 0, 0, 0), 2, {"wavy": 2, "element": 3, "uniform": 5, "cube": 6}
# N: repeats. They fall with the cost of a value; at 1e4 in two dimensions it is half a minute.
LINE = {n: 400 if n <= 10_000 else 100 for n in (10, 30, 100, 300, 1000, 3000, 10_000, 30_000, 100_000)}
SPACE = {10: 400, 30: 400, 100: 400, 300: 200, 1000: 100, 3000: 40, 10_000: 16}
FLOW_LINE = {n: 200 if n <= 10_000 else 50 for n in LINE}
FLOW_SPACE = {10: 200, 30: 200, 100: 200, 300: 100, 1000: 40, 3000: 10}
# Fits begin where the faces of the cube no longer touch most particles.
FIRST = 100
# Of particles and their limit: random particles have errors far above it, quantiles fall to 1e-9.
FINE, FINER = 1e-7, 1e-12
# Of a fitted power.
ROUNDING = 1e-9
CUBES = {1: "Unit interval", 2: "Unit square", 3: "Unit cube"}
HEADINGS = {
    "case": "Density",
    "start": "Compared",
    "quantity": "Quantity",
    "t": "t [time]",
    "from": "N from",
    "to": "N to",
    "slope": "Power of N",
    "low": "Lower end, 95 %",
    "high": "Upper end, 95 %",
    "known": "Power in theory",
    "agrees": "Theory within the interval",
}


@cache
def runs() -> dict[str, W1Runs]:
    """Return what is run for each density and start."""
    found = {}
    for d, name in CUBES.items():
        law, counts = Density.uniform(np.zeros(d), np.ones(d)), LINE if d == 1 else SPACE
        found[name] = W1Runs(None, law, list(counts), list(counts.values()), (*CUBE_SEED, d))
    found[f"{CUBES[1]}, quantiles"] = W1Runs(
        None, Density.uniform(0.0, 1.0), list(LINE), 1, (*CUBE_SEED, 1), quantiles=True
    )
    for name, place in PLACE.items():
        case, law = cases.CASES[name], cases.law(name)
        flow: dict[str, Any] = {"t": [T], "y0": case.y0, "v0": case.v0}
        counts = FLOW_LINE if law.nx == 1 else FLOW_SPACE
        seed = (FLOW_SEED, place)
        found[case.title] = W1Runs(cases.model(name), law, list(counts), list(counts.values()), seed, **flow, tol=FINE)
        if law.nx == 1:
            sizes = [n for n in counts if FIRST <= n <= 10_000]
            found[f"{case.title}, quantiles"] = W1Runs(
                cases.model(name), law, sizes, 1, seed, **flow, tol=FINER, quantiles=True
            )
    return found


def study(smallest: bool = False) -> Study:
    """Return the study of all of them."""
    parts = {name: one.study(smallest=smallest) for name, one in runs().items()}
    return replace(joined(NAME, "Mean field: rates of W1", parts, "case"), columns=HEADINGS)


def results(rows: pd.DataFrame) -> dict[str, W1Rates]:
    """Return the rates of each density that rows of the study have, of N >= ``FIRST`` where these are enough."""
    found = {}
    for name, one in runs().items():
        mine = rows[rows["case"] == name].drop(columns="case")
        late = mine[mine["N"] >= FIRST]
        if len(mine):
            found[name] = one.result(late if late["N"].nunique() >= FEWEST_SIZES else mine)
    return found


def fits(found: dict[str, W1Rates]) -> pd.DataFrame:
    """Return the powers of N with 95 % intervals beside those of theory: of W1, and -1/2 for y with random starts."""
    tables = []
    for name, rates in found.items():
        by_w1 = -1.0 if rates.start == QUANTILES else -1.0 / max(runs()[name].density.nx, 2)
        of_y = np.nan if rates.start == QUANTILES else -0.5
        known = rates.fit["quantity"].map({"w1": by_w1, "error_y": of_y})
        tables.append(rates.fit.assign(case=name, start=rates.start, known=known))
    table = pd.concat(tables, ignore_index=True)
    inside = (table["low"] - ROUNDING <= table["known"]) & (table["known"] <= table["high"] + ROUNDING)
    return table.assign(agrees=inside.map({True: "yes", False: "no"}).where(table["known"].notna(), "—"))


def show(context: Context) -> None:
    """Give the powers of N."""
    found = results(context.tables[NAME])
    context.draw(NAME, draw_results, {cases.TITLES[name]: found[cases.TITLES[name]] for name in PLACE}, 2, 3.6)
    context.show(NAME, context.headed(NAME, fits(found)))
