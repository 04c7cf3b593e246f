"""Seeds, corrections of the model, comparisons of means and rows of tables that the claims of chapter 3 share."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
import pandas as pd
from scipy.special import stdtrit

from verification.claims import Comparison, MissingRow, Tables, at_least
from verification.thesis.chapter3.intervals import over_seeds

SEEDS = tuple(range(4))
# The claim on which those about simulated tissues rest; the errata name the other misprints of the model.
MODEL = ("c3.repulsion",)
# The most runs that ``runs_for`` looks for.
MOST_RUNS = 10_000


def of_mean(what: str, values: Sequence[float], compare: Callable[..., Comparison], *bound: float) -> Comparison:
    """Compare the mean of values, one for each seed, by its 95 % interval."""
    found = over_seeds(values)
    return compare(what, found.mean, *bound, interval=found[1:])


def of_column(what: str, row: pd.Series, name: str, compare: Callable[..., Comparison], *bound: float) -> Comparison:
    """Compare an entry of a row whose interval is in the columns ``name_low`` and ``name_high``, or low and high."""
    low, high = (f"{name}_{end}" if f"{name}_{end}" in row else end for end in ("low", "high"))
    return compare(what, row[name], *bound, interval=(float(row[low]), float(row[high])))


def runs_for(values: Sequence[float], gap: float) -> int:
    """Return the fewest runs whose 95 % interval of the mean is narrower than ± gap, with the scatter of the values."""
    scatter = float(np.std(values, ddof=1))
    enough = (n for n in range(2, MOST_RUNS) if stdtrit(n - 1, 0.975) * scatter / math.sqrt(n) < gap)
    return next(enough, MOST_RUNS)


def needed(runs: float, half: float, gap: float) -> int:
    """Return the runs with which an interval of half-width ``half`` with ``runs`` of them shrinks to ``gap``."""
    return max(2, math.ceil(runs * (half / gap) ** 2)) if math.isfinite(half) else 2


def row_of(table: pd.DataFrame, **where: object) -> pd.Series:
    """Return the row with these values.

    Raises
    ------
    MissingRow
        If there is none.
    """
    for name, value in where.items():
        table = table[table[name] == value]
    if table.empty:
        raise MissingRow(f"no row where {', '.join(f'{name} is {value}' for name, value in where.items())}")
    return table.iloc[0]


def daha_runs_ending(tables: Tables, reading: str) -> Comparison:
    """Compare the share of the runs of DAHA that reach 10 h with 1/2, for a reading of the model."""
    row = row_of(tables["tissue_daha_shares"], case=reading)
    what = f"share of {row['runs']} runs of DAHA that reach 10 h, {reading}"
    return at_least(what, 1 - row["share"], 0.5, interval=(1 - row["high"], 1 - row["low"]))
