"""Substeps of PBD against catch-up on a frozen tissue."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd

from verification.page.context import Context
from verification.page.parts import Follows, Grid, Picture, Section, Text
from verification.page.prose import fill
from verification.thesis.chapter3 import catch_up, figures_daha
from verification.thesis.chapter3.judged import floored
from verification.thesis.chapter3.sections.part import COLUMNS, PROSE, Part, named

# Made again beside the complete study.
AGAIN = replace(catch_up.FULL, seeds=1)


def _run(context: Context) -> None:
    study = catch_up.study(context.form(catch_up.FULL))
    table = context.rows_of(study, catch_up.study(AGAIN), ("method", "steps"))
    errors = catch_up.errors(table)
    context.keep("tissue_catch_up_errors", errors)
    context.keep("tissue_catch_up_orders", catch_up.orders(errors, floored().numbers().dt))


def _catch_up(context: Context) -> Section:
    errors, orders = (context.tables[f"tissue_catch_up_{name}"] for name in ("errors", "orders"))
    picture = context.draw("tissue_catch_up", figures_daha.catch_up, errors)
    said = fill(PROSE / "catch_up.html", **_values(errors))
    return Section(
        "Is PBD the cheapest method on a frozen tissue?",
        [
            Text(said["frozen"]),
            Picture(picture, said["picture"]),
            Grid(named(orders, COLUMNS["catch_up_orders"]), said["orders"], "tissue_catch_up_orders", folded=True),
            Grid(named(errors, COLUMNS["catch_up_errors"]), said["errors"], "tissue_catch_up_errors", folded=True),
            Follows(said["follows"]),
        ],
    )


def _values(errors: pd.DataFrame) -> dict[str, Any]:
    pbd = errors[errors["method"] == "PBD"]
    own = pbd[pbd["steps"] == floored().numbers().substeps].iloc[0]
    fine = pbd.iloc[-1]
    rivals = errors[(errors["method"] != "PBD") & (errors["rms"] <= fine["rms"])].sort_values("seconds")
    beyond = errors[errors["steps"] > errors["least"]].groupby("method", sort=False)
    return {
        "own": own.to_dict(),
        "fine": fine.to_dict(),
        "rival": rivals.iloc[0].to_dict() if len(rivals) else None,
        "orders": [{"method": method} | _mean_order(rows.sort_values("steps")) for method, rows in beyond],
    }


def _mean_order(rows: pd.DataFrame) -> dict[str, Any]:
    """Return the mean order between the coarsest and the finest run, given from coarse to fine."""
    first, last = rows.iloc[0], rows.iloc[-1]
    order = np.log(first["rms"] / last["rms"]) / np.log(last["steps"] / first["steps"])
    return {"order": order, "first": first["steps"], "last": last["steps"]}


PART = Part(_run, _catch_up)
