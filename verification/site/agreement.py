"""Whether runs that are made again agree with the complete study that ships: row by row, to the digits of the pages."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd

from dincl.study import Study
from dincl.study.table import ATTRIBUTE, rounded
from verification.site.cells import cell

# Columns that depend on the machine or its load.
TIMES = ("seconds", "cpu_seconds", "us_best", "us_median")
OF_THE_MACHINE = {
    *TIMES,
    "output_seconds",
    "check_seconds",
    "repeats",
    "spread",
    "disturbed",
    "reading",
    "twin",
    "pairs",
    "daha",
    "pbd",
}
# Words that are compared as they are; others, such as details of a failure, hold numbers.
WORDS = ("status", "outcome")
CUT_OFF = ("OUT_OF_BUDGET", "LEFT_OUT")
# Numbers agree that have three digits in common, and those below what the projections of references resolve [length].
RELATIVE, SMALL = 1e-3, 1e-9
# Shorter times say more about the clock than about the machine [s].
LEAST_SECONDS = 1e-3


@dataclass(frozen=True)
class Agreement:
    """What came of making a part of a study again.

    Attributes
    ----------
    title
        Of the study.
    runs, of
        Made again, and those of the complete study.
    rows, apart
        Compared, and how many of them do not agree.
    worst
        The farthest number in words; empty if all agree.
    pace
        Median of the times here over those of the complete study; None where too few were measured.
    made
        Version of this package with which the complete study was made, and the date.
    """

    title: str
    runs: int
    of: int
    rows: int
    apart: int
    worst: str = ""
    pace: float | None = None
    made: str = ""


def compare_studies(here: pd.DataFrame, complete: pd.DataFrame, study: Study) -> Agreement:
    """Compare rows of a rerun with the rows of the complete study.

    Parameters
    ----------
    here, complete
        Rows of the same kind.
    study
        The complete one; where its ``by`` names no columns, rows of one run stand in the same order.
    """
    names = [*study.key, *study.by]
    mine, other = (_indexed(_ended(table), names) for table in (here, complete))
    both = mine.index.intersection(other.index)
    mine, other = mine.loc[both], other.loc[both]
    off = _apart(mine, other)
    runs = len(here[list(study.key)].drop_duplicates())
    worst = _worst(mine, other, off) if off.any(axis=None) else ""
    rows, apart = len(both), int(off.any(axis=1).sum())
    made = complete.attrs.get(ATTRIBUTE, {})
    said = ", ".join(made[part] for part in ("package", "date") if part in made)
    return Agreement(study.title, runs, len(study.runs), rows, apart, worst, _pace(mine, other), said)


def _ended(table: pd.DataFrame) -> pd.DataFrame:
    """Return the rows without runs that a budget cut off."""
    return table[~table["status"].isin(CUT_OFF)] if "status" in table else table


def _indexed(table: pd.DataFrame, names: list[str]) -> pd.DataFrame:
    """Index rows by the names and the place among rows of the same names."""
    table = table.assign(**{name: table[name].map(rounded) for name in names})
    place = table.groupby(names, sort=False, dropna=False).cumcount()
    return table.assign(place=place).set_index([*names, "place"])


def _apart(mine: pd.DataFrame, other: pd.DataFrame) -> pd.DataFrame:
    """Return one column of booleans for each compared column, True where a number or word differs."""
    found = {}
    for column in mine.columns.intersection(other.columns).difference(sorted(OF_THE_MACHINE)):
        one, two = mine[column], other[column]
        if column in WORDS or one.dtype == bool:
            found[column] = (one != two) & ~(one.isna() & two.isna())
        elif pd.api.types.is_numeric_dtype(one) and pd.api.types.is_numeric_dtype(two):
            found[column] = relative(one, two) > RELATIVE
    return pd.DataFrame(found, index=mine.index)


def relative(one: pd.Series, two: pd.Series) -> pd.Series:
    """Return |a - b| over the larger of both; 0 for small, equal or missing numbers, infinite if one is missing."""
    a, b = one.to_numpy(dtype=np.float64), two.to_numpy(dtype=np.float64)
    size = np.maximum(np.abs(a), np.abs(b))
    same = (a == b) | (np.isnan(a) & np.isnan(b)) | (size <= SMALL)
    with np.errstate(invalid="ignore"):
        apart = np.where(same, 0.0, np.abs(a - b) / np.where(same, 1.0, size))
    return pd.Series(np.nan_to_num(apart, nan=np.inf), index=one.index)


def _worst(mine: pd.DataFrame, other: pd.DataFrame, off: pd.DataFrame) -> str:
    """Return the column and row with the largest difference, with both values."""
    numeric = [column for column in off if off[column].any() and mine[column].dtype != bool and column not in WORDS]
    sizes = {column: relative(mine[column], other[column]) for column in numeric}
    column = max(sizes, key=lambda name: sizes[name].max()) if sizes else next(name for name in off if off[name].any())
    row = sizes[column].argmax() if sizes else int(off[column].to_numpy().argmax())
    where = zip(mine.index.names[:-1], mine.index[row][:-1], strict=True)
    place = ", ".join(f"{name} = {cell(value)[0]}" for name, value in where)
    return f"{column} ({cell(mine[column].iloc[row])[0]} here, {cell(other[column].iloc[row])[0]} there) at {place}"


def _pace(mine: pd.DataFrame, other: pd.DataFrame) -> float | None:
    """Return the median ratio of the times, to two digits."""
    column = next((name for name in TIMES if name in mine and name in other), None)
    if column is None:
        return None
    long = (mine[column] > LEAST_SECONDS) & (other[column] > LEAST_SECONDS)
    ratios = (mine[column] / other[column])[long]
    return float(f"{ratios.median():.2g}") if len(ratios) else None
