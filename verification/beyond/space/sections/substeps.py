"""Speed against accuracy of a growing sheet, beside a slice."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pandas as pd

from verification.beyond.space import figures_catch_up, substeps
from verification.page.columns import headed, read_columns
from verification.page.context import Context
from verification.page.parts import Follows, Grid, Picture, Section, Text
from verification.page.prose import fill
from verification.thesis.chapter3.sections.part import Part

PAGE = Path(__file__).parent.parent
PROSE, COLUMNS = PAGE / "prose", read_columns(PAGE / "columns.toml")

# Rerun beside the complete study: one seed of the slice.
AGAIN = substeps.SheetSubstepsForm(seeds=1)


def _run(context: Context) -> None:
    form = context.form(substeps.FULL)
    rows = context.rows_of(
        substeps.study(form), substeps.study(AGAIN).only(lambda key: key["tissue"] == "slice"), ("substeps", "t")
    )
    errors = substeps.errors(rows)
    context.keep("space_substeps_errors", errors)
    context.keep("space_substeps_orders", substeps.orders(errors))


def _substeps(context: Context) -> Section:
    errors, orders = (context.tables[f"space_substeps_{name}"] for name in ("errors", "orders"))
    picture = context.draw("space_substeps", figures_catch_up.substeps, errors)
    said = fill(PROSE / "substeps.html", **_values(errors, orders))
    return Section(
        "How many substeps does a growing sheet need?",
        [
            Text(said["measures"]),
            Picture(picture, said["picture"]),
            Grid(headed(orders, COLUMNS["substeps_orders"]), said["orders"], "space_substeps_orders"),
            Grid(headed(errors, COLUMNS["substeps"]), said["errors"], "space_substeps_errors", folded=True),
            Follows(said["follows"]),
        ],
    )


def _values(errors: pd.DataFrame, orders: pd.DataFrame) -> dict[str, Any]:
    end = errors["t"].max()
    last = {(row.tissue, row.substeps): row for row in errors[errors["t"] == end].itertuples()}
    least = {row.tissue: row.substeps for row in orders[orders["t"] == end].itertuples()}
    counts = {"finest": int(errors["substeps"].max()), "reference": substeps.FULL.reference}
    return {"last": last, "least": least, "end": end, **counts}


PART = Part(_run, _substeps)
