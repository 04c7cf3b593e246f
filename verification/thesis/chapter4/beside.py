"""Tables of the page with the presets beside each other."""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from verification.page.columns import read_columns
from verification.page.prose import percent, percents
from verification.thesis.chapter4.frequencies import READINGS
from verification.thesis.chapter4.studies import PRESETS, preset_of

MAKES_NO_NUMBERS = True

COLUMNS = read_columns(Path(__file__).parent / "columns.toml")
LABELS = {preset: READINGS[preset].capitalize() for preset in PRESETS}
RATIO = ["value", "low", "high"]


def beside(table: pd.DataFrame, name: str) -> pd.DataFrame:
    """Return a row for each value of the keys, with columns for each reading, under the headings of ``columns.toml``.

    The table has a column "side" with the headings of what stands beside each other, or "preset", or "study", whose
    ending says the preset and is taken off.
    """
    table, keys, shown = _sided(table), COLUMNS[name], COLUMNS[f"{name}_shown"]
    rows = table[list(keys)].drop_duplicates()
    for side, mine in table.groupby("side", sort=False):
        named = {column: f"{side} {text}".strip() for column, text in shown.items()}
        rows = rows.merge(mine[[*keys, *shown]].rename(columns=named), on=list(keys), how="left")
    texts = rows.select_dtypes(exclude="number").columns
    return rows.assign(**{column: rows[column].fillna("") for column in texts}).rename(columns=dict(keys))


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
    measured = [_measured(row) for _, row in table.iterrows()]
    return table.assign(side=sides, printed=table["printed"].map(percent), shown=measured)


def _measured(row: pd.Series) -> str:
    away = percents((row["difference"], row["low"], row["high"]), 0, "+").replace(" %", " points")
    return f"{100 * row['measured']:.1f} %" + ("" if row["agrees"] else f", off by {away}")


def ranked(table: pd.DataFrame) -> pd.DataFrame:
    """The importance of factors with its interval as a text, in a column "number"."""
    rows = table[RATIO].itertuples(index=False, name=None)
    return table.assign(number=[f"{value:.4f} [{low:.4f}, {high:.4f}]" for value, low, high in rows])
