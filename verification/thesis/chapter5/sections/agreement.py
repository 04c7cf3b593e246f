"""Section that compares DAE, RATTLE and ODE."""

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
from verification.thesis.chapter5.sections.words import COLUMNS, PROSE, named


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
        "Constrained and reduced equations give one motion",
        [
            Text(said["same"]),
            Picture(moved, said["motion"]),
            Picture(errors, said["errors"]),
            Grid(named(best, COLUMNS["agreement"]), said["best"], "meanfield_best"),
            Grid(named(orders, COLUMNS["agreement_orders"]), said["orders"], "meanfield_orders"),
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
