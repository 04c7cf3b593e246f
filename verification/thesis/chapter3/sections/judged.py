"""Single steps of DAHA and PBD, judged by the local minimum."""

from __future__ import annotations

from typing import Any

import pandas as pd

from verification.page.context import Context
from verification.page.parts import Follows, Grid, Section, Text
from verification.page.prose import fill
from verification.thesis.chapter3 import judged
from verification.thesis.chapter3.sections.part import COLUMNS, PROSE, Part, named

# Made again beside the complete study.
STEP = {"seed": 0, "t": 5.0}


def _run(context: Context) -> None:
    form = context.form(judged.FULL)
    steps, whole = judged.study(form), judged.whole(form)
    context.keep("tissue_judged_steps", judged.summary(context.rows_of(steps, steps.only(lambda key: key == STEP))))
    context.tables["tissue_judged_runs"] = context.rows_of(whole, whole.only(lambda _: False))


def _judged(context: Context) -> Section:
    steps, runs = context.tables["tissue_judged_steps"], context.tables["tissue_judged_runs"]
    said = fill(PROSE / "judged.html", **_steps(steps), **_whole(runs))
    parts: list[Text | Follows | Grid] = [
        Text(said["steps"]),
        Grid(named(steps, COLUMNS["judged_steps"]), said["table"], "tissue_judged_steps"),
    ]
    if len(runs):
        parts += [Text(said["whole"]), Grid(named(runs, COLUMNS["judged_runs"]), said["heights"], "tissue_judged_runs")]
    return Section("How far from a minimum does a step end?", [*parts, Follows(said["follows"])])


def _steps(steps: pd.DataFrame) -> dict[str, Any]:
    row = steps.set_index("where")
    numbers = judged.floored().daha_numbers()
    return {
        "daha": row.loc["DAHA"].to_dict(),
        "pbd": row.loc["PBD"].to_dict(),
        "minimum": row.loc["minimum from DAHA"].to_dict(),
        "apart": row.loc["minimum", "distance"],
        "tol": judged.TOL,
        "bound": numbers.eps / (numbers.alpha * numbers.dtau),
    }


def _whole(runs: pd.DataFrame) -> dict[str, Any]:
    """Return heights through minima over those of DAHA, where both were reached; the short form has no such runs."""
    ratio = (runs["judge"] / runs["DAHA"] - 1).dropna() if len(runs) else pd.Series(dtype=float)
    return {
        "end": judged.END,
        "runs": len(runs),
        "reached": len(ratio),
        "off": (ratio.mean(), ratio.min(), ratio.max()),
    }


PART = Part(_run, _judged)
