"""A section of the chapter on the tissue; prose and headings of all sections."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import pandas as pd

from verification.page.columns import Columns, headed, read_columns
from verification.page.context import Context
from verification.page.parts import Section
from verification.thesis.chapter3.maps import LABELS

FOLDER = Path(__file__).parent.parent
PROSE, COLUMNS = FOLDER / "prose", read_columns(FOLDER / "columns.toml")


class Part(NamedTuple):
    """One section: ``run`` completes its studies and fills ``context.tables``, ``section`` only reads them."""

    run: Callable[[Context], None]
    section: Callable[[Context], Section]


def named(table: pd.DataFrame, columns: Columns) -> pd.DataFrame:
    """Return the named columns under their headings, presets by their labels."""
    return headed(table.replace({"preset": LABELS}), columns)
