"""DAE, RATTLE and ODE against each other."""
# ruff: noqa: RUF001 - formulas for readers are written with Greek letters and minus signs

from __future__ import annotations

import pandas as pd

from verification.page.report import Context, Grid, Picture, Section, Text, number
from verification.thesis.chapter3.sections.part import Part
from verification.thesis.chapter5 import agreement, figures, motion
from verification.thesis.chapter5.cases import TITLES
from verification.thesis.chapter5.methods import LABELS
from verification.thesis.chapter5.sections.words import form, listed, named

BEST = {
    "model": "Model",
    "method": "Method",
    "setting": "dt or tol",
    "error_y": "y",
    "error_v": "y'",
    "error_X": "X",
    "error_multipliers": "λ",
    "drift": "|g − c|",
    "velocity_drift": "|g'|",
    "reference": "Error of the reference",
    "reached": "10⁻⁹ reached",
}
ORDERS = {"model": "Model", "method": "Method", "order_y": "Order of y [95 %]", "order_multipliers": "of λ [95 %]"}


def _run(context: Context) -> None:
    context.keep("meanfield_motion", motion.table())
    table = agreement.study(context.full).complete(context.folder, context.executor)
    context.tables["meanfield_agreement"] = table
    context.keep("meanfield_best", agreement.best(table))
    context.keep("meanfield_orders", agreement.orders(table))


def _section(context: Context) -> Section:
    table, best, orders = (context.tables[f"meanfield_{name}"] for name in ("agreement", "best", "orders"))
    moved = context.draw("meanfield_motion", figures.motion, context.tables["meanfield_motion"])
    errors = context.draw("meanfield_agreement", figures.agreement, table, "wavy")
    file = form("meanfield_agreement", context.full)
    return Section(
        "Constrained particles: DAE, ODE, RATTLE",
        [
            Text(_words(best, orders)),
            Picture(moved, "Nine particles (grey, first coordinate) and the macroscopic component (colours)."),
            Picture(errors, "Error of y (solid) and of the multipliers (dotted); grey: error = tol."),
            Grid(named(best, BEST), "The setting with the least largest error, for each model and method.", file),
            Grid(named(orders, ORDERS), "Orders of RATTLE.", "meanfield_orders"),
        ],
    )


def _words(best: pd.DataFrame, orders: pd.DataFrame) -> str:
    tolerant = best[~best["method"].str.startswith("rattle")]
    worst = ", ".join(f"{LABELS[method]}: {number(part.max())}" for method, part in tolerant.groupby("method")["worst"])
    missed = best[~best["reached"]]
    short = [
        f"{LABELS[row.method]} ({number(row.worst)} at dt or tol = {number(row.setting)}, {TITLES[row.model]})"
        for row in missed.loc[missed.groupby("method")["worst"].idxmax()].itertuples()
    ]
    off = (orders["slope"] - orders["nominal"]).abs().max()
    return (
        "The constrained equations (5.6), integrated with their multipliers, and the reduced equations (5.11) give the "
        f"same motion: the largest error of y, y', X and λ over all models is, at the best tolerance, {worst}. "
        "References are closed forms (StraightFibre, LinearFibre), else the ODE at tol = 10⁻¹³, whose error is its "
        f"distance to RATTLE of order 8. Not below {number(agreement.CLAIMED)}: {listed(short)}. The orders of RATTLE "
        f"in y differ from 2, 4, 6, 8 by at most {number(off)}. The largest |g − c| there is "
        f"{_drifts(best)}; all keep g' as well, the ODE by construction."
    )


def _drifts(best: pd.DataFrame) -> str:
    return listed([f"{LABELS[method]} {number(part.max())}" for method, part in best.groupby("method")["drift"]])


PART = Part(_run, _section)
