"""A section of the chapter on the tissue, and what all of them share."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import pandas as pd

from verification.page.context import Context
from verification.page.parts import Section
from verification.thesis.chapter3.maps import LABELS

PROSE = Path(__file__).parent.parent / "prose"


class Part(NamedTuple):
    """One section: ``run`` completes its studies and fills ``context.tables``, ``section`` only reads them."""

    run: Callable[[Context], None]
    section: Callable[[Context], Section]


def named(table: pd.DataFrame, headings: dict[str, str]) -> pd.DataFrame:
    """The columns of a table that a reader wants, with words for names."""
    return table[list(headings)].replace({"preset": LABELS}).rename(columns=headings)
