"""Intervals, corrections and sample sizes of proportions, as statsmodels has them.

Counts and sizes need not be whole: what clusters of cells in one run tell is counted in effective cells. These numbers
(``tissue.statistics.ratios``), and differences of cells of the same runs (``tissue.statistics.comparisons``), are ours:
statsmodels has neither.
"""

from __future__ import annotations

from typing import Any, Literal, get_args

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.special import ndtri

from dincl.checks import describe
from dincl.errors import InvalidProblem

LEVEL, POWER = 0.95, 0.8
Floats = NDArray[np.float64]
Correction = Literal["holm", "fdr"]


def quantile(level: float) -> float:
    """Return z with P[|N(0, 1)| <= z] = level.

    Raises
    ------
    InvalidProblem
        If the level does not lie between 0 and 1.
    """
    if not 0 < level < 1:
        raise InvalidProblem(f"level = {describe(level)}: must be between 0 and 1, such as 0.95")
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
    from statsmodels.stats.proportion import proportion_confint

    quantile(level)  # refuses a bad level
    p, n = np.asarray(value, dtype=np.float64), np.asarray(size, dtype=np.float64)
    low, high = proportion_confint(p * n, n, alpha=1 - level, method="wilson")
    return np.where(p == 0, 0.0, low), np.where(p == 1, 1.0, high)


def newcombe(first: tuple[float, float], second: tuple[float, float], level: float = LEVEL) -> tuple[float, float]:
    """Compute the hybrid score interval of p_1 - p_2 for two independent samples, each given as (p, n).

    Source
    ------
    R. G. Newcombe, Interval estimation for the difference between independent proportions, Statistics in Medicine 17
    (1998), method 10.
    """
    from statsmodels.stats.proportion import confint_proportions_2indep

    quantile(level)  # refuses a bad level
    (p_1, n_1), (p_2, n_2) = first, second
    low, high = confint_proportions_2indep(p_1 * n_1, n_1, p_2 * n_2, n_2, method="newcomb", alpha=1 - level)
    return max(-1.0, float(low)), min(1.0, float(high))


def sample_size(difference: float, null: float, alternative: float, *, level: float, power: float = POWER) -> float:
    """Compute n = ((z_level null + z_power alternative)/difference)^2, the size with which a difference is seen.

    Parameters
    ----------
    difference
        What is to be seen, not 0.
    null, alternative
        Standard deviation of one observation of the difference, where there is none and where it is as given.
    level
        1 minus the probability to see a difference where there is none, two-sided.
    power
        Probability to see this one, from 0.5 to 1.
    """
    from statsmodels.stats.power import normal_sample_size_one_tail

    quantile(level)  # refuses a bad level
    return float(normal_sample_size_one_tail(difference, power, (1 - level) / 2, null, alternative))


def corrected(p_values: pd.Series, method: Correction = "holm") -> pd.Series:
    """Correct p-values so that each may be read as if it were the only one.

    Parameters
    ----------
    p_values
        From 0 to 1, of any number of comparisons.
    method
        "holm": max over j <= i of (m - j + 1) p_(j), at most 1: the chance of any false finding below 0.05 is 5 %.
        "fdr": min over j >= i of m p_(j) / j, Benjamini and Hochberg's: of what is below 0.05, 5 % are expected to be
        false findings.

    Returns
    -------
    pd.Series
        In the order of the argument, none smaller than before.

    Source
    ------
    S. Holm, A simple sequentially rejective multiple test procedure, Scandinavian Journal of Statistics 6 (1979);
    Y. Benjamini, Y. Hochberg, Controlling the false discovery rate, JRSS B 57 (1995).
    """
    if method not in get_args(Correction):
        raise InvalidProblem(f"method = {describe(method)}: must be one of {', '.join(get_args(Correction))}")
    p = p_values.to_numpy(dtype=np.float64)
    if not ((p >= 0) & (p <= 1)).all():
        raise InvalidProblem(f"p_values = {describe(p)}: must be from 0 to 1")
    # statsmodels.stats.multitest collects garbage at each call: 0.9 s in a large process.
    order, m, adjusted = np.argsort(p), len(p), np.empty(len(p))
    rank = np.arange(1, m + 1)
    if method == "holm":
        raised = np.maximum.accumulate((m - rank + 1) * p[order])
    else:
        raised = np.minimum.accumulate((m / rank * p[order])[::-1])[::-1]
    adjusted[order] = np.minimum(1.0, raised)
    return pd.Series(adjusted, index=p_values.index, name=p_values.name)
