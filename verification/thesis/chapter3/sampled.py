"""Printed values, means over seeds with their confidence, and comparisons that the claims of chapter 3 share."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike
from scipy.special import stdtrit

from verification.claims import Comparison, MissingRow, Tables, at_least

# Table 2: soft radius [μm]; phases [h]; stiffnesses.
R_SOFT = 5.0
G2, MITOSIS = 0.5, 0.5
AA, AX, XX, AXB = 5.0, 2.0, 1.0, 15.0
# Table 3: time step [h], substeps.
DT, SUBSTEPS = 0.1, 20
# Table 4.
ALPHA, BETA, GAMMA, C, EPS = 1e-4, 0.25, 1e-3, 2.0, 1e-6
# Section 3.1: iterations of DAHA in a step.
USUAL = 7500


CONFIDENCE = 0.95


class MeanInterval(NamedTuple):
    """A mean with the interval that covers it; NaN for fewer than two values."""

    mean: float
    low: float
    high: float


def over_seeds(values: ArrayLike) -> MeanInterval:
    """Return mean +- t_{n-1} s / sqrt(n): Student's 95 % interval of the mean of values (n,), one for each seed."""
    kept = np.asarray(values, dtype=np.float64)
    if kept.size < 2:
        return MeanInterval(float(kept.mean()) if kept.size else np.nan, np.nan, np.nan)
    half = float(stdtrit(kept.size - 1, 0.5 + 0.5 * CONFIDENCE) * kept.std(ddof=1) / np.sqrt(kept.size))
    return MeanInterval(float(kept.mean()), float(kept.mean()) - half, float(kept.mean()) + half)


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
