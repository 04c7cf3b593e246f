"""Ratios of cells, as chapter 4 counts them, with intervals that know how many independent observations there are.

All cells count alike, as in (4.7) and (4.12), and the kept tables hold counts of cells. The cells of one replicate
share a tissue: ten cells of one replicate tell less, or at most as much, as ten cells of ten replicates. What they tell
is counted by the effective number of cells, which Wilson's interval takes in place of the number of cells.

EMT categories (3.3.3, 3.3.4) are beneath: which events a cell had in which order, ratios given a time or a position,
and basal extrusion by the rule of the published code.
"""

from __future__ import annotations

import math
from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.special import ndtri

from dincl.checks import describe
from dincl.errors import InvalidProblem
from tissue.study.categories import EVENTS, What, kept_times, outcome, time_column
from tissue.study.estimates import LEVEL

COLUMNS = ("count", "of", "runs", "value", "low", "high", "effective")

Floats = NDArray[np.float64]


def quantile(level: float) -> float:
    """Return z with P[|N(0, 1)| <= z] = level."""
    return float(ndtri(0.5 + level / 2))


def wilson(value: Any, size: Any, level: float = LEVEL) -> tuple[Floats, Floats]:
    """Compute (p + z^2/2n +- z sqrt(p (1 - p)/n + z^2/4n^2))/(1 + z^2/n), for many ratios at once.

    Parameters
    ----------
    value, size
        Ratios p and numbers n > 0 of independent observations, which need not be whole; of one shape.
    level
        Probability to cover, 0 < level < 1.

    Returns
    -------
    low, high
        Exactly 0 for p = 0, exactly 1 for p = 1.

    Source
    ------
    E. B. Wilson, Probable inference, the law of succession, and statistical inference, JASA 22 (1927).
    """
    p, n = np.asarray(value, dtype=np.float64), np.asarray(size, dtype=np.float64)
    z = quantile(level)
    whole = 1 + z**2 / n
    centre, half = (p + z**2 / (2 * n)) / whole, z * np.sqrt(p * (1 - p) / n + z**2 / (4 * n**2)) / whole
    return np.where(p == 0, 0.0, centre - half), np.where(p == 1, 1.0, centre + half)


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


def as_ratio(row: pd.Series) -> Ratio:
    """Return the ratio in a row of a table of ratios."""
    return Ratio(int(row["count"]), int(row["of"]), float(row["effective"]))


def ratio(hits: pd.Series, replicate: pd.Series) -> Ratio:
    """Compute the ratio of the cells that are hits, with its effective number of cells; at least one cell."""
    _, run = np.unique(np.asarray(replicate), return_inverse=True)
    found = np.bincount(run, weights=np.asarray(hits, dtype=np.int64))
    return Ratio(int(found.sum()), len(hits), effective_size(found, np.bincount(run)))


def ratios(hits: pd.Series, replicate: pd.Series, category: pd.Series) -> pd.DataFrame:
    """Compute r(D_k) of (4.12), one row for each category that has cells, in the order of the categories.

    All cells of a category count alike, as in Remark 4.1. Cells without a category (missing) do not count.

    Parameters
    ----------
    hits, replicate, category
        Of each cell: whether it is one, its replicate, its category.

    Returns
    -------
    pd.DataFrame
        By category: ``count``, ``of`` [cells], ``runs`` [replicates with such a cell], ``value``, ``low``, ``high``,
        ``effective`` [cells].
    """
    names: list[Hashable]
    codes, names = pd.factorize(category, sort=True)
    hit, run, rows = np.asarray(hits), np.asarray(replicate), []
    for code in range(len(names)):
        mine = codes == code
        one = ratio(hit[mine], run[mine])
        rows.append((one.count, one.of, len(np.unique(run[mine])), one.value, *one.interval(), one.size))
    return pd.DataFrame(rows, index=pd.Index(list(names), name=category.name, dtype=object), columns=list(COLUMNS))


def effective_size(hits: Any, cells: Any) -> float:
    """Compute n/deff with deff = sum_r (y_r - p n_r)^2/(n p (1 - p)), at least 1.

    deff is the variance of the ratio p = sum y_r/sum n_r over replicates, linearised, over that of independent cells.
    Before it is taken, two replicates of mean size are added, one with only hits and one with none. So deff is defined
    for p = 0 and p = 1 too, where the data say nothing about it: there it is nearly the largest possible, the size of a
    replicate. With one cell in each replicate it is 1.

    Parameters
    ----------
    hits, cells
        y_r and n_r >= 1 of each replicate; at least one replicate.

    Returns
    -------
    float
        > 0 and at most sum n_r.

    Source
    ------
    L. Kish, Survey Sampling (1965); linearised as in W. G. Cochran, Sampling Techniques (1977), section 6.4.
    """
    y, n = np.asarray(hits, dtype=np.float64), np.asarray(cells, dtype=np.float64)
    mean_size = float(n @ n / n.sum())  # seen by a cell: what bounds deff
    total = n.sum() + 2 * mean_size
    p = float((y.sum() + mean_size) / total)
    squares = float(((y - p * n) ** 2).sum()) + mean_size**2 * (p * p + (1 - p) ** 2)
    return float(n.sum() / max(1.0, squares / (total * p * (1 - p))))


@dataclass(frozen=True)
class ProportionContrast:
    """d = sum w_i p_i of independent proportions, as p_1 - p_2 or (p_1 - p_2) - (p_3 - p_4).

    Attributes
    ----------
    weights
        w_i.
    ratios
        The proportions, with their effective numbers of cells.
    """

    weights: tuple[float, ...]
    ratios: tuple[Ratio, ...]

    @property
    def value(self) -> float:
        """The weighted sum."""
        return math.fsum(w * one.value for w, one in zip(self.weights, self.ratios, strict=True))

    def interval(self, level: float = LEVEL) -> tuple[float, float]:
        """Compute d -+ sqrt(sum (w_i p_i - e_i)^2), e_i the lower (upper) end of Wilson's interval of w_i p_i.

        For two groups it is Newcombe's hybrid score interval.

        Source
        ------
        G. Y. Zou, W. Huang, X. Zhang, A note on confidence interval estimation for a linear function of binomial
        proportions, Computational Statistics & Data Analysis 53 (2009).
        """
        w, p, n = np.asarray(self.weights), *np.array([(one.value, one.size) for one in self.ratios]).T
        ends = w * np.array(wilson(p, n, level))
        below, above = w * p - ends.min(axis=0), ends.max(axis=0) - w * p
        most, least = w[w > 0].sum(), w[w < 0].sum()
        low, high = self.value - np.sqrt((below**2).sum()), self.value + np.sqrt((above**2).sum())
        return max(float(least), float(low)), min(float(most), float(high))


def difference(first: Ratio, second: Ratio) -> ProportionContrast:
    """Return p_1 - p_2 of independent proportions, with Newcombe's interval."""
    return ProportionContrast((1.0, -1.0), (first, second))


# EMT categories.
NO_EVENT = "none"
NO_INM = " no INM"
# Part of the end of a run by which an event at the end may be later: 0.1 h + 0.2 h is more than 0.3 h.
ROUNDING = 1e-12
WINDOW = 1.0  # [h], over which a nucleus is below 0 on average to be extruded by the published rule


def happened(cells: pd.DataFrame, end: float) -> pd.DataFrame:
    """Return whether each event came by the end of the run [h]; columns "A", "B", "S", "P".

    [P] counts from when it acts, which it does not before [B]: so ``t_p_h`` has it.
    """
    return pd.DataFrame({event: cells[time_column(event)] <= end * (1 + ROUNDING) for event in EVENTS})


def outcome_published(cells: pd.DataFrame, what: What, t: float) -> pd.Series:
    """Compute delta(t) as the published code has it, which looks ahead for basal extrusion.

    y_AB < 0 at t, and on average over the output times of the next hour and over all that follow. At the end of the run
    it is ``outcome``.
    """
    hits = outcome(cells, what, t)
    if what != "basal":
        return hits
    later = [f"ab_{u:g}h" for u in kept_times(cells) if u >= t]
    soon = [f"ab_{u:g}h" for u in kept_times(cells) if t <= u <= t + WINDOW]
    return hits & (cells[soon].mean(axis=1) < 0) & (cells[later].mean(axis=1) < 0)


def by_order(cells: pd.DataFrame, end: float) -> pd.Series:
    """Return the events of a cell by the end as they followed: "[AB]" for T_A <= T_B, "[BA]" for T_B < T_A.

    Equal times are in the order A, B, S, P. Without INM the name ends with ``NO_INM``; without events it is "none".
    """
    times = np.column_stack([cells[time_column(event)] for event in EVENTS])
    order = np.argsort(times, axis=1, kind="stable")
    had = np.take_along_axis(happened(cells, end).to_numpy(), order, axis=1)
    letters = np.where(had, np.array(EVENTS, dtype=object)[order], "").sum(axis=1)
    names = np.where(letters == "", NO_EVENT, "[" + letters + "]")
    return pd.Series(names + np.where(cells["inm"], "", NO_INM), index=cells.index)


def given(hits: pd.Series, replicate: pd.Series, values: pd.Series, edges: Sequence[float]) -> pd.DataFrame:
    """Compute E[delta | value in (a, b]] of 3.3.4 for each interval between rising edges, with 95 % intervals.

    Parameters
    ----------
    hits, replicate, values
        Of each cell: whether it is one; its replicate; its event time [h] or its position at the onset. Cells outside
        of the edges, and those with none (infinite or missing), are in no row.

    Returns
    -------
    pd.DataFrame
        ``low_edge``, ``high_edge`` and the columns of ``ratios``; an interval without cells has no row.
    """
    table = ratios(hits, replicate, pd.cut(values.astype(float), list(edges), labels=False))
    first = table.index.to_numpy(dtype=int)
    ends = np.asarray(edges, dtype=float)
    return table.assign(low_edge=ends[first], high_edge=ends[first + 1]).reset_index(drop=True)
