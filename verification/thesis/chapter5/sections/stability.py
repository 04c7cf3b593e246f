"""Section on the constant of the stability estimate."""

from __future__ import annotations

from typing import Any

import pandas as pd

from verification.page.context import Context
from verification.page.parts import Follows, Grid, Picture, Section, Text
from verification.page.prose import fill
from verification.thesis.chapter3.sections.part import Part
from verification.thesis.chapter5 import figures, stability_constant
from verification.thesis.chapter5.sections.words import COLUMNS, PROSE, named

# Rerun beside the complete study.
AGAIN = stability_constant.PairsForm(2)


def _run(context: Context) -> None:
    study = stability_constant.study(context.form(stability_constant.FULL))
    table = context.rows_of(study, stability_constant.study(AGAIN), ("pair", "t"))
    context.tables["meanfield_stability"] = table
    context.keep("meanfield_stability_summary", stability_constant.summary(table))
    context.keep("meanfield_stability_envelopes", stability_constant.envelopes(table))
    context.keep("meanfield_stability_laws", stability_constant.counterexample())


def _section(context: Context) -> Section:
    summary, envelopes, laws = (
        context.tables[f"meanfield_stability_{name}"] for name in ("summary", "envelopes", "laws")
    )
    picture = context.draw("meanfield_stability", figures.stability, envelopes, summary)
    shown = summary.assign(kind=summary["kind"].map(stability_constant.KINDS))
    said = fill(PROSE / "stability.html", **_values(summary, laws))
    return Section(
        "How large is the constant of the stability estimate (5.60)?",
        [
            Text(said["pairs"]),
            Text(said["printed"]),
            Picture(picture, said["picture"]),
            Grid(named(shown, COLUMNS["stability"]), said["table"], "meanfield_stability_summary"),
            Follows(said["follows"]),
        ],
    )


def _values(summary: pd.DataFrame, laws: pd.DataFrame) -> dict[str, Any]:
    return {
        "rows": list(summary.itertuples()),
        "apart": laws["flows_apart"].max(),
        "top": laws.loc[laws["ratio"].idxmax()],
    }


PART = Part(_run, _section)
