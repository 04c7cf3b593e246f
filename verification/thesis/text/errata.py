"""Errata: what is printed wrong in the thesis and has no check of its own; rows of ``errata.csv``."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import pandas as pd

FILE = Path(__file__).parent / "errata.csv"


@cache
def errata() -> pd.DataFrame:
    """One row for each: id, chapter, source, as printed, to be read, what it changes, what depends on it, why, line.

    The last column, ``claim``, names the claim whose check decides it, too; it is empty where none does.
    """
    return pd.read_csv(FILE, dtype={"id": str, "chapter": int, "place": int}).fillna({"claim": ""})
