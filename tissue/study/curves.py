"""Ratios against time and against an event time or the position at the onset.

Source: Figures 10 to 14, 20 and 21 of chapter 4.
"""

from __future__ import annotations

from typing import get_args

import numpy as np
import pandas as pd

from tissue.study.categories import Edges, Rule, What, by_interval, interval_names, kept_times, outcome
from tissue.study.proportions import LEVEL
from tissue.study.ratios import COLUMNS, ratios


def over_time(cells: pd.DataFrame, rule: Rule = "thesis", level: float = LEVEL) -> pd.DataFrame:
    """r(t) of (4.7) at each kept time with its band.

    The band holds at each time with the given probability, not at all times together.

    Parameters
    ----------
    cells
        Table of the EMT cells of a scenario.
    rule
        Of basal extrusion, as in ``outcome``.
    level
        Of the band.

    Returns
    -------
    pd.DataFrame
        One row for each outcome and kept time: ``what`` ("basal", "apical", "below"), ``time_h``, and the columns of
        ``ratios``. No rows for a table without cells.
    """
    parts = [
        ratios(outcome(cells, what, t, rule), cells["replicate"], _same(cells), level).assign(what=what, time_h=t)
        for what in get_args(What)
        for t in kept_times(cells)
        if len(cells)
    ]
    names = ["what", "time_h", *COLUMNS]
    return pd.concat(parts, ignore_index=True)[names] if parts else pd.DataFrame(columns=names)


def given(hits: pd.Series, replicate: pd.Series, values: pd.Series, edges: Edges, level: float = LEVEL) -> pd.DataFrame:
    """E[delta | value in (a, b]] of 3.3.4 for each interval, with bands.

    Parameters
    ----------
    hits, replicate, values
        Of each cell: whether it is one; its replicate; its event time [h] or its position at the onset.
    edges
        Of the intervals, rising. Cells outside of them, and those with none (never, null), are in no row.
    level
        Of the band, for each interval by itself.

    Returns
    -------
    pd.DataFrame
        ``low_edge``, ``high_edge``, ``middle`` and the columns of ``ratios``; an interval without cells has no row.
    """
    names = interval_names(edges)[1:-1]
    table = ratios(hits, replicate, by_interval(values, edges), level)
    table = table[table.index.isin(names)]
    first = np.array([names.index(name) for name in table.index], dtype=np.intp)
    low, high = np.asarray(edges, dtype=np.float64)[first], np.asarray(edges, dtype=np.float64)[first + 1]
    columns = pd.DataFrame({"low_edge": low, "high_edge": high, "middle": (low + high) / 2}, index=table.index)
    return pd.concat([columns, table], axis=1)


def _same(cells: pd.DataFrame) -> pd.Series:
    """One category for all cells."""
    return pd.Series(np.zeros(len(cells), dtype=np.int8), index=cells.index)
