"""What the sections of the mean-field chapter share."""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from verification.thesis.chapter5.cases import TITLES
from verification.thesis.chapter5.methods import LABELS

PROSE = Path(__file__).parent.parent / "prose"


def named(table: pd.DataFrame, headings: dict[str, str]) -> pd.DataFrame:
    """The columns of a table that a reader wants, with words for names of models and methods."""
    words = {"model": TITLES, "method": LABELS}
    return table[list(headings)].replace(words).rename(columns=headings)
