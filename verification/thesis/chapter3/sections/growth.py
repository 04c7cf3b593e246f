"""Growth of the height for several dampings."""

from __future__ import annotations

from typing import Any

import pandas as pd

from verification.page.context import Context
from verification.page.parts import Follows, Grid, Picture, Section, Text
from verification.page.prose import fill
from verification.thesis.chapter3 import figures as figures_tissue
from verification.thesis.chapter3 import growth
from verification.thesis.chapter3.growing import PRESETS
from verification.thesis.chapter3.sections.part import COLUMNS, PROSE, Part, named

# Made again beside the complete study: two seeds with the substeps of the presets.
AGAIN = growth.GrowthForm(2, 1.0)


def _run_growth(context: Context) -> None:
    study = growth.study(context.form(growth.FULL))
    table = context.rows_of(study, growth.study(AGAIN), ("seed", "t"))
    context.tables["tissue_growth"] = table
    context.keep("tissue_ratios", growth.ratios(table))
    context.keep("tissue_doubling", growth.doubling(table))


def _growth(context: Context) -> Section:
    table, ratios, doubling = (context.tables[f"tissue_{name}"] for name in ("growth", "ratios", "doubling"))
    picture = context.draw("tissue_growth", figures_tissue.growth, table, growth.fine(table))
    said = fill(PROSE / "growth.html", **_values(doubling, ratios, table["t"].max()))
    return Section(
        "At which damping does the height double?",
        [
            Text(said["doubles"]),
            Picture(picture, said["picture"]),
            Grid(named(doubling, COLUMNS["doubling"]), said["doubling"], "tissue_doubling"),
            Grid(named(ratios, COLUMNS["ratios"]), said["ratios"], "tissue_ratios"),
            Follows(said["follows"]),
        ],
    )


def _values(doubling: pd.DataFrame, ratios: pd.DataFrame, end: float) -> dict[str, Any]:
    return {
        "end": end,
        "doubling": list(doubling.sort_values("preset", ascending=False).itertuples()),
        "beside": _beside_the_thesis(doubling, ratios),
        "lost": list(ratios[ratios["lost"] > 0].sort_values("mu").itertuples()),
    }


def _beside_the_thesis(doubling: pd.DataFrame, ratios: pd.DataFrame) -> dict[str, Any] | None:
    """Return the preset that comes nearest to Figures 14 to 16; None if none comes near a doubling."""
    least, most = ratios["mu"].min(), ratios["mu"].max()
    if doubling["mu"].isna().all():
        return None
    nearest = doubling.loc[(doubling["mu"] / least - 1).abs().idxmin(), "preset"]
    slow = ratios[ratios["mu"] == most].groupby("preset")["ratio"].last()
    return {"least": least, "most": most, "nearest": nearest, "slow": [(name, slow[name]) for name in PRESETS]}


PART = Part(_run_growth, _growth)
