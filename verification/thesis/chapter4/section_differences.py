"""Which difference between the presets makes which printed ratio: a section of the page, from tables alone."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pandas as pd

from tissue.statistics.comparisons import Difference
from tissue.statistics.ratios import Ratio
from verification.page.columns import headed
from verification.page.context import Context
from verification.page.parts import Follows, Grid, Section, Text
from verification.page.prose import fill, listed, percents
from verification.thesis.chapter4 import kept
from verification.thesis.chapter4.beside import COLUMNS
from verification.thesis.chapter4.differences import AS_PRINTED, PUBLISHED, ROWS
from verification.thesis.chapter4.effects import COUNTING
from verification.thesis.chapter4.frequencies import CLAIM_LEVEL

PROSE = Path(__file__).parent / "prose"
AGREES = " ✓"
SIDES = ("printed", "published")
# Of pairs of rows those are shown whose interval is this far from 0, by the half of it.
CLEAR = 2.0
# So many of the largest average effects stand beside a ratio.
LARGEST = 2


def section(context: Context) -> Section:
    """The answer for each ratio; then one row changed at a time from both ends, and the effects of the design."""
    changed, effects = (context.tables[f"{kept.COMPLETE_PREFIX}{name}"] for name in ("changed", "effects"))
    told = found(changed, effects)
    said = fill(PROSE / "differences.html", found=told, rows=len(ROWS))
    name = f"{kept.COMPLETE_PREFIX}changed"
    return Section(
        COLUMNS["sections"]["differences"],
        [
            Text(said["asked"]),
            Grid(meanings(), said["meanings"], name),
            Grid(answers(told), said["answers"], f"{kept.COMPLETE_PREFIX}effects"),
            Grid(one_by_one(changed, AS_PRINTED), said["alone"], name, folded=True),
            Grid(one_by_one(changed, PUBLISHED), said["without"], name, folded=True),
            Grid(averages(effects), said["averages"], f"{kept.COMPLETE_PREFIX}effects", folded=True),
            Follows(said["follows"]),
        ],
    )


def meanings() -> pd.DataFrame:
    """What each row is, as printed and as published."""
    lines = [{"row": row} | {side: COLUMNS[f"rows_{side}"][row] for side in SIDES} for row in (*ROWS, COUNTING)]
    return headed(pd.DataFrame(lines), COLUMNS["meanings"])


def answers(told: list[dict[str, Any]]) -> pd.DataFrame:
    """A line for each printed ratio: what gives it, what takes it away, and what it depends on most."""
    lines = [
        {
            "Cells": one["ratio"],
            "Printed": one["printed"],
            "Model as printed": one["bare"],
            "Given by one difference alone": "needs none" if one["agrees"] else listed(one["makes"]),
            "Taken from the published runs by undoing": listed(one["needs"]),
            "Largest average effects [points]": "; ".join(one["largest"]),
        }
        for one in told
    ]
    return pd.DataFrame(lines)


def one_by_one(changed: pd.DataFrame, start: str) -> pd.DataFrame:
    """A line for each row that is changed, a column for each printed ratio; a mark where it agrees with that."""
    mine = changed[changed["start"] == start]
    numbers = mine[["value", "low", "high"]].itertuples(index=False, name=None)
    texts = [percents(each) + (AGREES if agrees else "") for each, agrees in zip(numbers, mine["agrees"], strict=True)]
    heading = _headings(mine) + ", printed " + (100 * mine["printed"]).map("{:.0f} %".format)
    lines = mine["row"].replace("", "nothing changed")
    return _wide(pd.DataFrame({"Changed": lines, "heading": heading, "text": texts}))


def averages(effects: pd.DataFrame) -> pd.DataFrame:
    """A line for each row, and for each two that matter together; a column for each printed ratio [points]."""
    clear = (effects["effect"].abs() > CLEAR * (effects["high"] - effects["low"]) / 2).groupby(
        [effects["row"], effects["with"]]
    )
    shown = effects[(effects["with"] == "") | clear.transform("any")]
    texts = [_points(row) for row in shown.itertuples()]
    lines = shown["row"] + (" with " + shown["with"]).where(shown["with"] != "", "")
    return _wide(pd.DataFrame({"Changed": lines, "heading": _headings(shown), "text": texts}))


def _headings(table: pd.DataFrame) -> pd.Series:
    pairs = zip(table["scenario"], table["what"], strict=True)
    return pd.Series([in_words(*pair) for pair in pairs], index=table.index)


def in_words(scenario: str, what: str) -> str:
    """A ratio, such as "[A] without INM leaves basally"."""
    return f"{scenario.replace('no INM', 'without INM')} {COLUMNS['outcomes'][what]}"


def _points(row: Any) -> str:
    """An effect with its interval in points."""
    return percents((row.effect, row.low, row.high), 0, "+").replace(" %", "")


def _wide(table: pd.DataFrame) -> pd.DataFrame:
    rows, columns = (list(dict.fromkeys(table[name])) for name in ("Changed", "heading"))
    wide = table.pivot(index="Changed", columns="heading", values="text").loc[rows, columns]
    return wide.rename_axis(columns=None).reset_index()


def found(changed: pd.DataFrame, effects: pd.DataFrame) -> list[dict[str, Any]]:
    """Of each printed ratio: what makes it agree alone, what takes it away, and the largest average effects."""
    told = []
    for (scenario, what), mine in changed.groupby(["scenario", "what"], sort=False):
        single = mine[mine["row"] != ""]
        bare = mine[mine["row"] == ""].set_index("start")
        main = effects[(effects["scenario"] == scenario) & (effects["what"] == what) & (effects["with"] == "")]
        # Those that chance alone may have made are none.
        main = main[(main["low"] > 0) | (main["high"] < 0)]
        largest = main.loc[main["effect"].abs().sort_values(ascending=False).index[:LARGEST]]
        start = bare.loc[AS_PRINTED]
        told.append(
            {
                "ratio": in_words(str(scenario), str(what)),
                "printed": f"{100 * start['printed']:.0f} %",
                "bare": percents((start["value"], start["low"], start["high"])),
                "agrees": bool(start["agrees"]),
                "makes": list(single.loc[(single["start"] == AS_PRINTED) & single["agrees"], "row"]),
                "needs": _taken(single[single["start"] == PUBLISHED], bare.loc[PUBLISHED]),
                "largest": [f"{row.row} {_points(row)}" for row in largest.itertuples()],
            }
        )
    return told


def _taken(single: pd.DataFrame, bare: pd.Series) -> list[str]:
    """The rows without which a ratio agrees no more and is another one than in the published runs, beyond chance."""
    whole = Ratio(int(bare["count"]), int(bare["of"]))
    rows = []
    for row in single[~single["agrees"]].itertuples():
        low, high = Difference(Ratio(int(row.count), int(row.of)), whole).interval(CLAIM_LEVEL)
        if low > 0 or high < 0:
            rows.append(row.row)
    return rows
