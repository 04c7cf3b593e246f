"""The page "Which method should I take?": ``python -m verification.beyond.chart.advice`` writes it from kept tables."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from dincl.files import write_text
from dincl.study import read_sealed
from verification.beyond.chart import cheapest, reach, work_precision
from verification.beyond.chart.references import SCENES
from verification.instruments.cheapest import TIE, UNDECIDED
from verification.page.kept import DATA, STUDIES
from verification.page.parts import number
from verification.page.prose import duration, text_page

MAKES_NO_NUMBERS = True
PAGE = Path(__file__).parents[3] / "docs" / "explain" / "which_method.md"
TEMPLATE = Path(__file__).parent / "prose" / "advice.md"
MANY = "pile_1000"


def page() -> str:
    """Return the text of the page."""
    winners = cheapest.winners(read_sealed(STUDIES / "work_precision.parquet"), work_precision.FULL)
    known = {"errors": by_error(winners), "many": many(winners), "piles": piles(reach.table()), "proved": proved()}
    known["stable"] = stable()
    filters = {"number": number, "duration": duration}
    return text_page(TEMPLATE, filters, **known, discs=len(SCENES[MANY]().x0))


def by_error(winners: pd.DataFrame) -> list[dict[str, Any]]:
    """Return for each error the methods most often among the cheapest, and what PBD costs, from ``cheapest.winners``.

    Keys: ``target``; ``reached``, the number of scenes with a method that reaches it; ``best``, the methods with the
    largest ``count`` of these scenes; ``pbd``, how many scenes PBD reaches it on, and ``times``, the median of its cost
    over the least cost there, NaN if there is none.
    """
    found = []
    for target, rows in winners[winners["tied"] != ""].groupby("target"):
        counts = rows["tied"].str.split("; ").explode().value_counts()
        ratios = rows["pbd_ratio"].dropna()
        best = sorted(counts.index[counts == counts.max()])
        times = float(ratios.median()) if len(ratios) else np.nan
        found.append(
            {"target": target, "reached": len(rows), "best": best, "count": counts.max(), "pbd": len(ratios)}
            | {"times": times}
        )
    return found[::-1]


def many(winners: pd.DataFrame) -> dict[str, Any]:
    """Return the cheapest methods for a thousand discs, the least error they are known for and the least cost [s]."""
    undecided = set(UNDECIDED) - {TIE}
    rows = winners[(winners["scene"] == MANY) & ~winners["cheapest"].isin(undecided)].sort_values("target")
    finest = rows.iloc[0]
    return {"methods": sorted(finest["tied"].split("; ")), "target": finest["target"], "cost": finest["cost"]}


def piles(table: pd.DataFrame) -> list[dict[str, Any]]:
    """Return for each number of discs the cheapest method at each error, the largest error first."""
    ordered = table.sort_values(["discs", "target"], ascending=[True, False])
    return [
        {"discs": discs, "cells": [(row.target, row.cheapest) for row in rows.itertuples()]}
        for discs, rows in ordered.groupby("discs")
    ]


def stable() -> dict[str, dict[str, int]]:
    """Return in how many of how many runs with large steps PBD and the softest springs stayed bounded."""
    table = read_sealed(STUDIES / "large_steps.parquet")
    counts = table.groupby("method")["stable"].agg(["sum", "count"])
    return {name: counts.loc[name].to_dict() for name in ("pbd", "penalty_10")}


def proved() -> dict[str, Any]:
    """Return the largest scene with a proved solution to 1e-12: its particles, the bound and the time [s]."""
    rows = read_sealed(DATA / "proved_scenes.parquet")
    largest = rows[(rows["asked"] == cheapest.FINE) & rows["bound"].notna()].sort_values("particles").iloc[-1]
    return {"particles": largest["particles"], "bound": largest["bound"], "seconds": largest["seconds"]}


if __name__ == "__main__":
    write_text(PAGE, page())
