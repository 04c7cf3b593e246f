"""DAE, RATTLE and ODE against each other."""
# ruff: noqa: RUF001 - formulas for readers are written with Greek letters and minus signs

from __future__ import annotations

from typing import Any

import pandas as pd

from verification.page.context import Context
from verification.page.parts import Follows, Grid, Picture, Section, Text
from verification.page.prose import fill
from verification.thesis.chapter3.sections.part import Part
from verification.thesis.chapter5 import agreement, figures, motion
from verification.thesis.chapter5.cases import TITLES
from verification.thesis.chapter5.methods import LABELS
from verification.thesis.chapter5.sections.words import PROSE, named

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
    context.keep("meanfield_motion", motion.table(context.form(motion.FORM)))
    study = agreement.study(context.form(agreement.FULL))
    table = context.rows_of(study, study.only(lambda key: key["model"] == "straight"))
    context.tables["meanfield_agreement"] = table
    context.keep("meanfield_best", agreement.best(table))
    context.keep("meanfield_orders", agreement.orders(table))


def _section(context: Context) -> Section:
    table, best, orders = (context.tables[f"meanfield_{name}"] for name in ("agreement", "best", "orders"))
    moved = context.draw("meanfield_motion", figures.motion, context.tables["meanfield_motion"])
    errors = context.draw("meanfield_agreement", figures.agreement, table, "wavy")
    said = fill(PROSE / "agreement.html", **_values(best, orders))
    return Section(
        "Constrained particles: DAE, ODE, RATTLE",
        [
            Text(said["same"]),
            Picture(moved, said["motion"]),
            Picture(errors, said["errors"]),
            Grid(named(best, BEST), said["best"], "meanfield_best"),
            Grid(named(orders, ORDERS), said["orders"], "meanfield_orders"),
            Follows(said["follows"]),
        ],
    )


def _values(best: pd.DataFrame, orders: pd.DataFrame) -> dict[str, Any]:
    tolerant = best[~best["method"].str.startswith("rattle")]
    missed = best[~best["reached"]]
    return {
        "labels": LABELS,
        "titles": TITLES,
        "worst": list(tolerant.groupby("method")["worst"].max().items()),
        "claimed": agreement.CLAIMED,
        "missed": list(missed.loc[missed.groupby("method")["worst"].idxmax()].itertuples()),
        "off": (orders["slope"] - orders["nominal"]).abs().max(),
        "drifts": list(best.groupby("method")["drift"].max().items()),
    }


PART = Part(_run, _section)
