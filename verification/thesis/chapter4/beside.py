"""Tables of the page with the presets beside each other."""

from __future__ import annotations

from collections.abc import Mapping

import pandas as pd

from verification.page.prose import percents
from verification.thesis.chapter4.studies import PRESETS, preset_of

MAKES_NO_NUMBERS = True

LABELS = {preset: preset.capitalize() for preset in PRESETS}
RATIO = ["value", "low", "high"]
# Between what a comparison is of and its numbers.
BEFORE_NUMBERS = r": (?=importance|[-+]?\d+(?:\.\d+)? % \[)"


def beside(table: pd.DataFrame, keys: Mapping[str, str], shown: Mapping[str, str]) -> pd.DataFrame:
    """A row for each value of the keys, and a column for each preset and each of what is shown; with their headings.

    The table has a column "side" with the headings of what stands beside each other, or "preset" with those of the
    presets, or "study", whose ending says the preset and is taken off.
    """
    table = _sided(table)
    rows = table[list(keys)].drop_duplicates()
    for side, mine in table.groupby("side", sort=False):
        named = {name: f"{side} {text}".strip() for name, text in shown.items()}
        rows = rows.merge(mine[[*keys, *shown]].rename(columns=named), on=list(keys), how="left")
    texts = rows.select_dtypes(exclude="number").columns
    return rows.assign(**{name: rows[name].fillna("") for name in texts}).rename(columns=keys)


def _sided(table: pd.DataFrame) -> pd.DataFrame:
    if "side" in table:
        return table
    if "preset" not in table:
        table = table.assign(preset=table["study"].map(preset_of), study=table["study"].map(without_ending))
    return table.assign(side=table["preset"].map(LABELS))


def without_ending(study: str) -> str:
    """The name of a study, the same for all presets."""
    return study.removesuffix(PRESETS[preset_of(study)])


def with_ratios(table: pd.DataFrame, digits: int = 1) -> pd.DataFrame:
    """The table with a text of each ratio and its interval, in a column "ratio"."""
    rows = table[RATIO].itertuples(index=False, name=None)
    return table.assign(ratio=[percents(row, digits) for row in rows])


def printed(table: pd.DataFrame) -> pd.DataFrame:
    """The printed ratios as they were measured, and how far off those are that do not agree."""
    sides = [f"{LABELS[preset]}, {t:g} h" for preset, t in zip(table["preset"], table["time_h"], strict=True)]
    return table.assign(side=sides, shown=[_measured(row) for _, row in table.iterrows()])


def _measured(row: pd.Series) -> str:
    away = percents((row["difference"], row["low"], row["high"]), 0, "+").replace(" %", " points")
    return f"{100 * row['measured']:.1f} %" + ("" if row["agrees"] else f", off by {away}")


def ranked(table: pd.DataFrame) -> pd.DataFrame:
    """The importance of factors with its interval as a text, in a column "number"."""
    rows = table[RATIO].itertuples(index=False, name=None)
    return table.assign(number=[f"{value:.4f} [{low:.4f}, {high:.4f}]" for value, low, high in rows])


def comparisons(answers: pd.DataFrame) -> pd.DataFrame:
    """One row for each comparison of each preset: what is compared, and what was found."""
    lines = answers.assign(line=answers["measured"].str.split("\n")).explode("line")
    parts = lines["line"].str.split(BEFORE_NUMBERS, n=1, regex=True)
    return lines.assign(compared=parts.str[0], found=parts.str[1].fillna(""))
