"""Errata: what is printed wrong in the thesis and has no check of its own; rows of ``errata.csv``."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import pandas as pd

from verification.claims import Effect

FILE = Path(__file__).parent / "errata.csv"
COLUMNS = ("id", "chapter", "source", "printed", "corrected", "effect", "depends", "why", "place", "claim")


@cache
def errata() -> pd.DataFrame:
    """One row for each: id, chapter, source, as printed, to be read, what it changes, what depends on it, why, line.

    The last column, ``claim``, names the claim whose check decides it, too; it is empty where none does.

    Raises
    ------
    ValueError
        If the file has other columns, an empty cell, an unknown effect or an id twice.
    """
    table = pd.read_csv(FILE, dtype={"id": str, "chapter": int, "place": int}).fillna({"claim": ""})
    if tuple(table) != COLUMNS:
        raise ValueError(f"{FILE.name} has the columns {', '.join(table)}: they must be {', '.join(COLUMNS)}")
    if table.isna().any(axis=None) or table["id"].duplicated().any():
        raise ValueError(f"{FILE.name}: each row must fill all columns but the last, each id must be unique")
    effects = [effect.value for effect in Effect]
    unknown = table.loc[~table["effect"].isin(effects), "effect"]
    if len(unknown):
        raise ValueError(f"{FILE.name}: effect {unknown.iloc[0]!r} must be one of {', '.join(effects)}")
    return table
