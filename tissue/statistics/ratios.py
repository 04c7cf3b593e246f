"""Ratios of cells with intervals that know how many independent observations there are.

The cells of one replicate share a tissue: one that leaves makes way for its neighbours or is in their way. Ten cells of
one replicate therefore tell less, or at most as much, as ten cells of ten replicates. What they tell is counted by the
effective number of cells; Wilson's interval takes that in place of the number of cells.
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass
from typing import Any, get_args

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.special import stdtrit

from dincl.checks import describe
from dincl.errors import InvalidProblem
from tissue.statistics.categories import Edges, Rule, What, by_interval, interval_names, kept_times, outcome
from tissue.statistics.proportions import LEVEL, quantile, wilson

COLUMNS = ("count", "of", "runs", "value", "low", "high", "effective")

# Size of the replicates that are added to those of control cells: a pair that leaves together. Their deff is about 1.4.
PAIR = 2.0

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Ratio:
    """``count`` of ``of`` cells, (4.7) and (4.12).

    Attributes
    ----------
    count, of
        Cells of the kind asked for, and all cells: 0 <= count <= of, of >= 1. A ratio of no cells does not exist.
    effective
        Number of independent cells that tell as much, 0 < effective <= of; ``of`` itself if it is not given.
    """

    count: int
    of: int
    effective: float | None = None

    def __post_init__(self) -> None:
        if not 0 <= self.count <= self.of or self.of < 1:
            raise InvalidProblem(f"ratio {self.count} of {self.of}: must count at least one cell, and no more than all")
        if self.effective is not None and not 0 < self.effective <= self.of:
            raise InvalidProblem(f"effective = {describe(self.effective)}: must be > 0 and <= {self.of}, the cells")

    @property
    def value(self) -> float:
        """count/of, from 0 to 1."""
        return self.count / self.of

    @property
    def size(self) -> float:
        """The effective number of cells."""
        return float(self.of if self.effective is None else self.effective)

    def interval(self, level: float = LEVEL) -> tuple[float, float]:
        """Return Wilson's interval on the effective number of cells; it lies within [0, 1]."""
        low, high = wilson(self.value, self.size, level)
        return float(low), float(high)

    def __str__(self) -> str:
        low, high = self.interval()
        return f"{100 * self.value:.1f} % [{100 * low:.1f}, {100 * high:.1f}] of {self.of}"


def ratio(hits: pd.Series, replicate: pd.Series) -> Ratio:
    """Compute the ratio of the cells that are hits, with its effective number of cells.

    Parameters
    ----------
    hits
        Whether each cell is one; at least one cell.
    replicate
        Which replicate each cell is of.

    Returns
    -------
    Ratio
        With effective = of/deff as described under ``effective_size``.

    Raises
    ------
    InvalidProblem
        If there are no cells, or the columns differ in length.
    """
    _refuse_other_lengths(hits, replicate, hits)
    if not len(hits):
        raise InvalidProblem("ratio of no cells: must have at least one cell")
    return _ratio(np.asarray(hits, dtype=np.int64), np.asarray(replicate))[0]


def as_ratio(row: pd.Series) -> Ratio:
    """Return the ratio in a row of a table of ratios."""
    return Ratio(int(row["count"]), int(row["of"]), float(row["effective"]))


def ratios(hits: pd.Series, replicate: pd.Series, category: pd.Series, level: float = LEVEL) -> pd.DataFrame:
    """Compute r(D_k) of (4.12), one row for each category that has cells, in the order of the categories.

    All cells of a category count alike, as in Remark 4.1. Cells without a category (missing) do not count.

    Parameters
    ----------
    hits, replicate, category
        Of each cell: whether it is one, its replicate, its category.
    level
        Of the intervals.

    Returns
    -------
    pd.DataFrame
        By category: ``count``, ``of`` [cells], ``runs`` [replicates with such a cell], ``value``, ``low``, ``high``,
        ``effective`` [cells]. A category without cells has no row.
    """
    _refuse_other_lengths(hits, replicate, category)
    names, codes = _coded(category)
    cells, replicates = np.asarray(hits, dtype=np.int64), np.asarray(replicate)
    there = np.unique(codes[codes >= 0])
    rows = [_row(*_ratio(cells[codes == code], replicates[codes == code]), level) for code in there]
    index = pd.Index([names[code] for code in there], name=category.name, dtype=object)
    return pd.DataFrame(rows, index=index, columns=list(COLUMNS))


def ratio_of_runs(hits: Any, cells: Any) -> Ratio:
    """Compute the ratio of hits among many cells of each run, of which few are hits, such as control cells.

    A replicate of mean size, as ``effective_size`` adds for EMT cells, would outweigh all hits: pairs are added. So
    the spread between the runs decides, known with k - 1 degrees of freedom: the effective number of cells is
    multiplied by (k - 1)/k (z/t)^2, z and t the quantiles of LEVEL.

    Parameters
    ----------
    hits, cells
        y_r and n_r >= 1 of each run; at least two runs.

    Source
    ------
    E. L. Korn, B. I. Graubard, Confidence intervals for proportions with small expected number of positive counts
    estimated from survey data, Survey Methodology 24 (1998).
    """
    runs = len(hits)
    known = (runs - 1) / runs * (quantile(LEVEL) / float(stdtrit(runs - 1, 0.5 + LEVEL / 2))) ** 2
    return Ratio(int(np.sum(hits)), int(np.sum(cells)), known * effective_size(hits, cells, PAIR))


def effective_size(hits: Any, cells: Any, added: float | None = None) -> float:
    """Compute n/deff with deff = sum_r (y_r - p n_r)^2/(n p (1 - p)), at least 1.

    deff is the variance of the ratio p = sum y_r/sum n_r over replicates, linearised, over that of independent cells.
    Before it is taken, two replicates of mean size are added, one with only hits and one with none. So deff is defined
    for p = 0 and p = 1 too, where the data say nothing about it: there it is nearly the largest possible, the size of a
    replicate. With one cell in each replicate it is 1.

    Parameters
    ----------
    hits, cells
        y_r and n_r >= 1 of each replicate; at least one replicate.
    added
        Size of the two replicates that are added; None: the mean size.

    Returns
    -------
    float
        > 0 and at most sum n_r.

    Source
    ------
    L. Kish, Survey Sampling (1965); linearised as in W. G. Cochran, Sampling Techniques (1977), section 6.4.
    """
    y, n = np.asarray(hits, dtype=np.float64), np.asarray(cells, dtype=np.float64)
    mean_size = float(n @ n / n.sum()) if added is None else added  # seen by a cell: what bounds deff
    total = n.sum() + 2 * mean_size
    p = float((y.sum() + mean_size) / total)
    squares = float(((y - p * n) ** 2).sum()) + mean_size**2 * (p * p + (1 - p) ** 2)
    return float(n.sum() / max(1.0, squares / (total * p * (1 - p))))


def _coded(category: pd.Series) -> tuple[list[Hashable], NDArray[np.intp]]:
    if isinstance(category.dtype, pd.CategoricalDtype):
        return list(category.cat.categories), np.asarray(category.cat.codes, dtype=np.intp)
    codes, names = pd.factorize(category, sort=True)
    return list(names), codes


def _refuse_other_lengths(hits: pd.Series, replicate: pd.Series, category: pd.Series) -> None:
    if not len(hits) == len(replicate) == len(category):
        raise InvalidProblem(
            f"{len(hits)} hits, {len(replicate)} replicates, {len(category)} categories: must be one of each per cell"
        )


def _ratio(hits: NDArray[np.int64], replicate: NDArray[Any]) -> tuple[Ratio, int]:
    """Return the ratio of hits, and how many replicates there are."""
    _, run = np.unique(replicate, return_inverse=True)
    cells, found = np.bincount(run), np.bincount(run, weights=hits)
    return Ratio(int(hits.sum()), len(hits), effective_size(found, cells)), len(cells)


def _row(found: Ratio, runs: int, level: float) -> tuple[int, int, int, float, float, float, float]:
    return found.count, found.of, runs, found.value, *found.interval(level), found.size


def over_time(cells: pd.DataFrame, rule: Rule = "thesis", level: float = LEVEL) -> pd.DataFrame:
    """Compute r(t) of (4.7) at each output time with its band.

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
        One row for each outcome and output time: ``what`` ("basal", "apical", "below"), ``time_h``, and the columns of
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
    """Compute E[delta | value in (a, b]] of 3.3.4 for each interval, with bands.

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
    """Return one category for all cells."""
    return pd.Series(np.zeros(len(cells), dtype=np.int8), index=cells.index)
