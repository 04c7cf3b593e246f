"""Substeps of PBD against catch-up on frozen tissues in space."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pandas as pd

from verification.beyond.space import catch_up, figures_catch_up
from verification.beyond.space.frozen import open_sheet
from verification.page.columns import headed, read_columns
from verification.page.context import Context
from verification.page.parts import Follows, Grid, Picture, Section, Text
from verification.page.prose import fill
from verification.thesis.chapter3.catch_up import orders
from verification.thesis.chapter3.sections.part import Part

PAGE = Path(__file__).parent.parent
PROSE, COLUMNS = PAGE / "prose", read_columns(PAGE / "columns.toml")

# Rerun beside the complete study.
AGAIN = replace(catch_up.FULL, seeds=1)


def _run(context: Context) -> None:
    study = catch_up.study(context.form(catch_up.FULL))
    errors = catch_up.errors(context.rows_of(study, catch_up.study(AGAIN), ("method", "steps")))
    context.keep("space_catch_up_errors", errors)
    dt = open_sheet(catch_up.CELLS, catch_up.AGE).numbers().dt
    context.keep("space_catch_up_orders", orders(errors, dt))


def _catch_up(context: Context) -> Section:
    errors, found = (context.tables[f"space_catch_up_{name}"] for name in ("errors", "orders"))
    picture = context.draw("space_catch_up", figures_catch_up.catch_up, errors)
    said = fill(PROSE / "catch_up.html", **_values(errors))
    return Section(
        "Is PBD as accurate as catch-up on frozen tissues in space?",
        [
            Text(said["frozen"]),
            Picture(picture, said["picture"]),
            Grid(headed(found, COLUMNS["catch_up_orders"]), said["orders"], "space_catch_up_orders", folded=True),
            Grid(headed(errors, COLUMNS["catch_up"]), said["errors"], "space_catch_up_errors", folded=True),
            Follows(said["follows"]),
        ],
    )


def _values(errors: pd.DataFrame) -> dict[str, Any]:
    fine = errors[errors["method"] == "PBD"].iloc[-1]
    rivals = errors[(errors["method"] != "PBD") & (errors["rms"] <= fine["rms"])].sort_values("calls")
    return {
        "age": catch_up.AGE,
        "cells": catch_up.CELLS,
        "fine": fine.to_dict(),
        "rival": rivals.iloc[0].to_dict() if len(rivals) else None,
        "most": max(catch_up.FULL.steps),
    }


PART = Part(_run, _catch_up)
