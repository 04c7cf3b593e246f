"""Errata: remarks on the notation of the thesis that no measurement could decide; rows of ``errata.csv``."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import pandas as pd

FILE = Path(__file__).parent / "errata.csv"
COLUMNS = ("id", "chapter", "source", "printed", "corrected", "depends", "why", "place")


@cache
def errata() -> pd.DataFrame:
    """One row for each: id, chapter, source, as printed, to be read, what depends on it, why, line of the text.

    Raises
    ------
    ValueError
        If the file has other columns, an empty cell or an id twice.
    """
    table = pd.read_csv(FILE, dtype={"id": str, "chapter": int, "place": int})
    if tuple(table) != COLUMNS:
        raise ValueError(f"{FILE.name} has the columns {', '.join(table)}: they must be {', '.join(COLUMNS)}")
    if table.isna().any(axis=None) or table["id"].duplicated().any():
        raise ValueError(f"{FILE.name}: each row must fill all columns, each id must be unique")
    return table
