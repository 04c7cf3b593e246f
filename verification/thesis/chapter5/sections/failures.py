"""Section on failures of the solvers."""

from __future__ import annotations

from typing import Any

import pandas as pd

from verification.page.context import Context
from verification.page.parts import Follows, Grid, Picture, Section, Text
from verification.page.prose import fill
from verification.thesis.chapter2.stability.figures import plane
from verification.thesis.chapter3.sections.part import Part
from verification.thesis.chapter5 import drift, failures, figures, maps
from verification.thesis.chapter5.sections.words import COLUMNS, PROSE, named

# So many runs, and lines of each map, are rerun.
MOST, LINES = 9, 3


def _run(context: Context) -> None:
    study, found = failures.study(context.form(failures.FORM)), []
    context.keep("meanfield_failed", failures.named(context.rows_of(study, study.some(MOST))))
    for one in context.form(maps.FORM).planes:
        context.tables[one.name] = context.rows_of(maps.study(one), maps.study(one).some(LINES))
        found.append(maps.agreement(context.tables[one.name], one))
    context.keep("meanfield_maps", pd.concat(found, ignore_index=True))
    drifts = drift.study(context.form(drift.FULL))
    table = context.rows_of(drifts, drifts.only(lambda key: key["method"] == "rattle2"))
    context.tables["meanfield_drift"] = table
    context.keep("meanfield_drift_growth", drift.growth(table))


def _section(context: Context) -> Section:
    found, growth = context.tables["meanfield_failed"], context.tables["meanfield_drift_growth"]
    picture = context.draw("meanfield_drift", figures.drift, context.tables["meanfield_drift"])
    planes = context.form(maps.FORM).planes
    drawn = [context.draw(one.name, plane, context.tables[one.name], one) for one in planes]
    said = fill(PROSE / "failures.html", **_values(context))
    return Section(
        "Where do the mean-field solvers fail?",
        [
            Text(said["provoked"]),
            Grid(named(found, COLUMNS["failures"]), said["found"], "meanfield_failed"),
            Text(said["maps"]),
            *(
                Picture(path, caption)
                for path, caption in zip(drawn, (said["first_map"], said["second_map"]), strict=True)
            ),
            Text(said["drift"]),
            Picture(picture, said["picture"]),
            Grid(named(growth, COLUMNS["drift"]), said["table"], "meanfield_drift_growth"),
            Follows(said["follows"]),
        ],
    )


def _values(context: Context) -> dict[str, Any]:
    found, growth, cells = (context.tables[f"meanfield_{name}"] for name in ("failed", "drift_growth", "maps"))
    naive = growth[growth["power_g"] != "—"]
    return {
        "count": len(found),
        "agreeing": int(found["agrees"].sum()),
        "off": list(found[~found["agrees"]].itertuples()),
        "cells": list(cells.itertuples()),
        "end": float(context.tables["meanfield_drift"]["t"].max()),
        "grown": list(naive.itertuples()),
        "kept": list(growth[growth["power_g"] == "—"].itertuples()),
    }


PART = Part(_run, _section)
