"""Which difference between the presets makes which printed ratio: a section of the page, from tables alone."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pandas as pd

from verification.page.context import Context
from verification.page.parts import Follows, Grid, Section, Text
from verification.page.prose import fill, percents
from verification.thesis.chapter4 import kept
from verification.thesis.chapter4.differences import AS_PRINTED, PUBLISHED, ROWS

PROSE = Path(__file__).parent / "prose"
AGREES = " ✓"
# Of pairs of rows those are shown whose interval is this far from 0, by the half of it.
CLEAR = 2.0


def section(context: Context) -> Section:
    """One row changed at a time from both ends, and the average effects of the factorial design."""
    changed, effects = (context.tables[f"{kept.COMPLETE_PREFIX}{name}"] for name in ("changed", "effects"))
    said = fill(PROSE / "differences.html", found=found(changed, effects), rows=len(ROWS))
    name = f"{kept.COMPLETE_PREFIX}changed"
    return Section(
        "Which difference makes which ratio",
        [
            Text(said["asked"]),
            Grid(one_by_one(changed, AS_PRINTED), said["alone"], name),
            Grid(one_by_one(changed, PUBLISHED), said["without"], name),
            Grid(averages(effects), said["averages"], f"{kept.COMPLETE_PREFIX}effects"),
            Follows(said["follows"]),
        ],
    )


def one_by_one(changed: pd.DataFrame, start: str) -> pd.DataFrame:
    """A line for each row that is changed, a column for each printed ratio; a mark where it agrees with that."""
    mine = changed[changed["start"] == start]
    numbers = mine[["value", "low", "high"]].itertuples(index=False, name=None)
    texts = [percents(each) + (AGREES if agrees else "") for each, agrees in zip(numbers, mine["agrees"], strict=True)]
    heading = mine["scenario"] + " " + mine["what"] + ", printed " + (100 * mine["printed"]).map("{:.0f} %".format)
    lines = mine["row"].replace("", "nothing changed")
    return _wide(pd.DataFrame({"Changed": lines, "heading": heading, "text": texts}))


def averages(effects: pd.DataFrame) -> pd.DataFrame:
    """A line for each row, and for each two that matter together; a column for each printed ratio [points]."""
    clear = (effects["effect"].abs() > CLEAR * (effects["high"] - effects["low"]) / 2).groupby(
        [effects["row"], effects["with"]]
    )
    shown = effects[(effects["with"] == "") | clear.transform("any")]
    numbers = shown[["effect", "low", "high"]].itertuples(index=False, name=None)
    texts = [percents(each, 0, "+").replace(" %", "") for each in numbers]
    lines = shown["row"] + (" with " + shown["with"]).where(shown["with"] != "", "")
    return _wide(pd.DataFrame({"Changed": lines, "heading": shown["scenario"] + " " + shown["what"], "text": texts}))


def _wide(table: pd.DataFrame) -> pd.DataFrame:
    rows, columns = (list(dict.fromkeys(table[name])) for name in ("Changed", "heading"))
    wide = table.pivot(index="Changed", columns="heading", values="text").loc[rows, columns]
    return wide.rename_axis(columns=None).reset_index()


def found(changed: pd.DataFrame, effects: pd.DataFrame) -> list[dict[str, Any]]:
    """Of each printed ratio: what makes it agree alone, what it needs, and the row with the largest average effect."""
    told = []
    for (scenario, what), mine in changed.groupby(["scenario", "what"], sort=False):
        single = mine[mine["row"] != ""]
        bare = mine[mine["row"] == ""].set_index("start")
        main = effects[(effects["scenario"] == scenario) & (effects["what"] == what) & (effects["with"] == "")]
        largest = main.loc[main["effect"].abs().idxmax()]
        told.append(
            {
                "ratio": f"{scenario} {what}",
                "agrees": bool(bare.loc[AS_PRINTED, "agrees"]),
                "makes": list(single.loc[(single["start"] == AS_PRINTED) & single["agrees"], "row"]),
                "needs": list(single.loc[(single["start"] == PUBLISHED) & ~single["agrees"], "row"]),
                "largest": largest,
            }
        )
    return told
