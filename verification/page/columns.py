"""Headings of tables: ``columns.toml`` of a chapter names the columns that a page shows, with units in brackets.

One table of the file for each table on a page; its first line tells ``dincl.provenance`` that no number depends on it::

    # MAKES_NO_NUMBERS
    [orders]
    t = "t"
    order = "Order [range]"
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from functools import cache
from pathlib import Path

import pandas as pd

Columns = Mapping[str, str]


@cache
def read_columns(file: Path) -> Mapping[str, Columns]:
    """Read table -> column -> heading."""
    return tomllib.loads(file.read_text("utf-8"))


def headed(rows: pd.DataFrame, columns: Columns) -> pd.DataFrame:
    """Return the named columns, in the order of the file, under their headings."""
    return rows[list(columns)].rename(columns=columns)
