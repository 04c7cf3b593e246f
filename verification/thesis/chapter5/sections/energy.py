"""Section on the energy."""

from __future__ import annotations

from typing import Any

import pandas as pd

from verification.page.context import Context
from verification.page.parts import Follows, Grid, Picture, Section, Text
from verification.page.prose import fill
from verification.thesis.chapter3.sections.part import Part
from verification.thesis.chapter5 import energy, figures
from verification.thesis.chapter5.methods import METHODS
from verification.thesis.chapter5.sections.words import COLUMNS, PROSE, named


def _run(context: Context) -> None:
    limits = energy.limit_study(context.form(energy.FULL))
    limit = context.rows_of(limits, limits.only(lambda key: key["method"] != "pde"))
    runs = energy.long_study(context.form(energy.FULL_LONG))
    long = context.rows_of(runs, runs.only(lambda key: key["method"] == "dae"))
    context.tables["meanfield_energy_limit"], context.tables["meanfield_energy_long"] = limit, long
    context.keep("meanfield_energy_slopes", energy.slopes(context.tables["meanfield_agreement"], limit))
    context.keep("meanfield_energy_trends", energy.trends(long))


def _section(context: Context) -> Section:
    slopes, trends = (context.tables[f"meanfield_energy_{name}"] for name in ("slopes", "trends"))
    picture = context.draw("meanfield_energy", figures.energy, context.tables["meanfield_energy_long"], energy.PERIOD)
    said = fill(PROSE / "energy.html", **_values(trends))
    return Section(
        "Which solvers keep the energy?",
        [
            Text(said["trends"]),
            Picture(picture, said["picture"]),
            Grid(named(trends, COLUMNS["energy_trends"]), said["line"], "meanfield_energy_trends"),
            Grid(
                named(slopes, COLUMNS["energy_slopes"]),
                said["slopes"],
                "meanfield_energy_slopes",
                folded=True,
            ),
            Follows(said["follows"]),
        ],
    )


def _values(trends: pd.DataFrame) -> dict[str, Any]:
    drifting, holding = (list(trends[trends["drifts"] == drifts].itertuples()) for drifts in (True, False))
    return {"methods": METHODS, "periods": trends["periods"].max(), "drifting": drifting, "holding": holding}


PART = Part(_run, _section)
