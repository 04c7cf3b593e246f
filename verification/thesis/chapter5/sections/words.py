"""Prose and tables of the sections of the mean-field chapter."""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from verification.page.columns import Columns, headed, read_columns
from verification.thesis.chapter5.cases import TITLES
from verification.thesis.chapter5.methods import LABELS

CHAPTER = Path(__file__).parent.parent
PROSE, COLUMNS = CHAPTER / "prose", read_columns(CHAPTER / "columns.toml")


def named(table: pd.DataFrame, columns: Columns) -> pd.DataFrame:
    """Return the columns that a page shows under their headings, with words for names of models and methods."""
    return headed(table.replace({"model": TITLES, "method": LABELS}), columns)
