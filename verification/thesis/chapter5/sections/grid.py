"""Section on the PDE on grids."""

from __future__ import annotations

from typing import Any

import pandas as pd

from verification.page.context import Context
from verification.page.parts import Follows, Grid, Picture, Section, Text
from verification.page.prose import fill
from verification.thesis.chapter3.sections.part import Part
from verification.thesis.chapter5 import figures, grid_order
from verification.thesis.chapter5.cases import TITLES
from verification.thesis.chapter5.sections.words import COLUMNS, PROSE, named

# Of grids with no more cells along a side.
COARSE = 80


def _run(context: Context) -> None:
    study = grid_order.study(context.form(grid_order.FULL))
    table = context.rows_of(study, study.only(lambda key: key["cells"] <= COARSE))
    context.tables["meanfield_grid"] = table
    context.keep("meanfield_grid_orders", grid_order.orders(table))


def _section(context: Context) -> Section:
    table, orders = context.tables["meanfield_grid"], context.tables["meanfield_grid_orders"]
    picture = context.draw("meanfield_grid", figures.grid, table)
    said = fill(PROSE / "grid.html", **_values(orders))
    return Section(
        "How accurate are grids for the PDE (5.42)?",
        [
            Text(said["orders"]),
            Picture(picture, said["picture"]),
            Grid(named(orders, COLUMNS["grid_orders"]), said["table"], "meanfield_grid_orders"),
            Grid(named(table, COLUMNS["grid"]), said["runs"], "meanfield_grid", folded=True),
            Follows(said["follows"]),
        ],
    )


def _values(orders: pd.DataFrame) -> dict[str, Any]:
    smooth, jumps = orders[orders["smooth"]], orders[~orders["smooth"]]
    return {
        "titles": TITLES,
        "smooth": list(smooth.itertuples()),
        "jumps": list(jumps.itertuples()),
        "mass": orders["mass"].max(),
        "least": orders["least"].min(),
        "apart": orders["moments_apart"].max(),
        "exact": grid_order.EXACT,
    }


PART = Part(_run, _section)
