"""Which difference between the presets makes which printed ratio: a section of the page, from tables alone."""

from __future__ import annotations

from collections.abc import Iterable

import pandas as pd

from verification.site.cells import listed, percents
from verification.site.context import Context
from verification.thesis.chapter4.differences import AS_PRINTED, COUNTING, COUNTING_ROW, PUBLISHED, ROWS
from verification.thesis.chapter4.frequencies import CLAIM_LEVEL
from verification.thesis.chapter4.ratios import Ratio, difference

OUTCOMES = {"apical": "leaves apically", "basal": "leaves basally", "below": "lies below all control cells"}
AGREES = " ✓"
LARGEST = 2  # of the average effects of a ratio that are named
CLEAR = 2.0  # effects of two rows are shown if one is this far from 0, by the half of its interval


def show(context: Context) -> None:
    """Give the answer for each ratio, one row changed at a time from both ends, and the effects of the design."""
    changed, effects = context.tables["emt_changed"], context.tables["emt_effects"]
    context.show("emt_swapped", answers(changed, effects), "emt_effects")
    context.show("emt_meanings", meanings(), "emt_changed")
    context.show("emt_from_printed", one_by_one(changed, AS_PRINTED), "emt_changed")
    context.show("emt_from_published", one_by_one(changed, PUBLISHED), "emt_changed")
    context.show("emt_effects", averages(effects))


def meanings() -> pd.DataFrame:
    """Tabulate what each row says in both models."""
    rows = [(name, row.printed, row.published) for name, row in (ROWS | {COUNTING: COUNTING_ROW}).items()]
    return pd.DataFrame(rows, columns=["Difference", "In the model as printed", "In the published runs"])


def answers(changed: pd.DataFrame, effects: pd.DataFrame) -> pd.DataFrame:
    """Tabulate for each printed ratio what gives it, what takes it away, and what it depends on most."""
    return pd.DataFrame([_answer(mine, effects) for _, mine in changed.groupby(["scenario", "what"], sort=False)])


def _answer(mine: pd.DataFrame, effects: pd.DataFrame) -> dict[str, object]:
    bare, single = mine[mine["row"] == ""].set_index("start"), mine[mine["row"] != ""]
    start = bare.loc[AS_PRINTED]
    of_ratio = (effects["scenario"] == start["scenario"]) & (effects["what"] == start["what"])
    main = effects[of_ratio & (effects["with"] == "") & ((effects["low"] > 0) | (effects["high"] < 0))]
    largest = main.loc[main["effect"].abs().sort_values(ascending=False).index[:LARGEST]]
    makes = single.loc[(single["start"] == AS_PRINTED) & single["agrees"], "row"]
    return {
        "Cells": in_words(start["scenario"], start["what"]),
        "Printed": f"{100 * start['printed']:.0f} %",
        "Model as printed": percents((start["value"], start["low"], start["high"])),
        "Given by one difference alone": "needs none" if start["agrees"] else listed(makes),
        "Taken from the published runs by undoing": listed(_taken(single, bare.loc[PUBLISHED])),
        "Largest average effects [points]": "; ".join(f"{row.row} {_points(row)}" for row in largest.itertuples()),
    }


def _taken(single: pd.DataFrame, bare: pd.Series) -> list[str]:
    """List the rows without which a ratio agrees no more and differs from the published runs, beyond chance."""
    whole, rows = Ratio(int(bare["count"]), int(bare["of"])), []
    for row in single[(single["start"] == PUBLISHED) & ~single["agrees"]].itertuples():
        low, high = difference(Ratio(int(row.count), int(row.of)), whole).interval(CLAIM_LEVEL)
        if low > 0 or high < 0:
            rows.append(row.row)
    return rows


def one_by_one(changed: pd.DataFrame, start: str) -> pd.DataFrame:
    """Tabulate a line for each row that is changed, a column for each printed ratio; a mark where it agrees."""
    mine = changed[changed["start"] == start]
    texts = [percents((r.value, r.low, r.high)) + AGREES * r.agrees for r in mine.itertuples()]
    headings = [f"{in_words(r.scenario, r.what)}, printed {100 * r.printed:.0f} %" for r in mine.itertuples()]
    return _wide(mine["row"].replace("", "nothing changed"), headings, texts)


def averages(effects: pd.DataFrame) -> pd.DataFrame:
    """Tabulate a line for each row, and for each two that matter together, a column for each printed ratio."""
    clear = effects["effect"].abs() > CLEAR * (effects["high"] - effects["low"]) / 2
    shown = effects[(effects["with"] == "") | clear.groupby([effects["row"], effects["with"]]).transform("any")]
    lines = shown["row"] + (" with " + shown["with"]).where(shown["with"] != "", "")
    return _wide(
        lines, [in_words(r.scenario, r.what) for r in shown.itertuples()], [_points(r) for r in shown.itertuples()]
    )


def _points(row: object) -> str:
    """Write an effect with its interval in points."""
    return percents((row.effect, row.low, row.high), 0, "+").replace(" %", "")  # type: ignore[attr-defined]


def in_words(scenario: str, what: str) -> str:
    """Name a ratio, such as "[A] without INM leaves basally"."""
    return f"{scenario.replace('no INM', 'without INM')} {OUTCOMES[what]}"


def _wide(lines: pd.Series, headings: Iterable[str], texts: Iterable[str]) -> pd.DataFrame:
    table = pd.DataFrame({"Changed": lines.to_numpy(), "heading": list(headings), "text": list(texts)})
    rows, columns = (list(dict.fromkeys(table[name])) for name in ("Changed", "heading"))
    wide = table.pivot(index="Changed", columns="heading", values="text").loc[rows, columns]
    return wide.rename_axis(columns=None).reset_index()
