"""Two ratios against each other: difference, p-value, runs needed; and many comparisons at once."""

from __future__ import annotations

import math
from dataclasses import dataclass

import pandas as pd
from scipy.special import ndtr

from dincl.checks import describe, number
from dincl.errors import InvalidProblem
from tissue.statistics.proportions import LEVEL, POWER, newcombe, sample_size
from tissue.statistics.ratios import Ratio, ratio

# A variance that is a smaller part of the two that it is the difference of is 0 up to rounding.
ROUNDING = 1e-12


@dataclass(frozen=True)
class Difference:
    """p_1 - p_2 with Newcombe's hybrid score interval.

    Attributes
    ----------
    first, second
        The ratios, with their effective numbers of cells.
    correlation
        Of the two estimates, from -1 to 1: 0 for ratios from different replicates.
    """

    first: Ratio
    second: Ratio
    correlation: float = 0.0

    def __post_init__(self) -> None:
        if not -1 <= self.correlation <= 1:
            raise InvalidProblem(f"correlation = {describe(self.correlation)}: must be from -1 to 1")

    @property
    def value(self) -> float:
        """p_1 - p_2."""
        return self.first.value - self.second.value

    def interval(self, level: float = LEVEL) -> tuple[float, float]:
        """Compute Newcombe's hybrid score interval, for the effective numbers of cells.

        Two kinds of cells of the same runs are correlated, c, which statsmodels has only for pairs of single
        observations. Then it is d - sqrt(a^2 - 2 c a b + b^2) with a = p_1 - low_1, b = high_2 - p_2; above with high_1
        and low_2. Low and high are the ends of Wilson's intervals.

        Source
        ------
        R. G. Newcombe, Interval estimation for the difference between independent proportions, method 10; and for
        paired data, Statistics in Medicine 17 (1998).
        """
        p_1, p_2 = self.first.value, self.second.value
        if self.correlation == 0:
            return newcombe((p_1, self.first.size), (p_2, self.second.size), level)
        (low_1, high_1), (low_2, high_2) = self.first.interval(level), self.second.interval(level)
        below, above = self._joined(p_1 - low_1, high_2 - p_2), self._joined(high_1 - p_1, p_2 - low_2)
        return max(-1.0, self.value - below), min(1.0, self.value + above)

    def p_value(self) -> float:
        """Compute P[a difference of this size or larger, either way], if there is none: the score test of proportions.

        Ours, for the correlation of cells of the same runs; without one it is the test of statsmodels.
        1 where all cells of both ratios are hits, or none is; and where the difference has no spread, as that of two
        ratios of equal sizes that always change together.
        """
        n_1, n_2 = self.first.size, self.second.size
        pooled = (self.first.value * n_1 + self.second.value * n_2) / (n_1 + n_2)
        spread = pooled * (1 - pooled)
        covariance = self.correlation * spread / math.sqrt(n_1 * n_2)
        variance = spread * (1 / n_1 + 1 / n_2) - 2 * covariance
        if self.value == 0 or variance <= ROUNDING * spread * (1 / n_1 + 1 / n_2):
            return 1.0
        return float(2 * ndtr(-abs(self.value) / math.sqrt(variance)))

    def __str__(self) -> str:
        low, high = self.interval()
        return f"{100 * self.value:+.1f} [{100 * low:+.1f}, {100 * high:+.1f}] points"

    def _joined(self, a: float, b: float) -> float:
        return math.sqrt(max(0.0, a * a - 2 * self.correlation * a * b + b * b))


def within(hits: pd.Series, replicate: pd.Series, first: pd.Series, second: pd.Series) -> Difference:
    """Compare two kinds of cells of the same replicates, such as cells with INM and cells without.

    Parameters
    ----------
    hits, replicate
        Of each cell: whether it is one; its replicate.
    first, second
        Whether each cell is of the first and of the second kind; no cell is of both, and there are some of each.

    Returns
    -------
    Difference
        Its correlation is that of the two ratios over replicates, linearised as their variances are.

    Raises
    ------
    InvalidProblem
        If a cell is of both kinds, or no cell of one.
    """
    if (first & second).any():
        raise InvalidProblem(f"first and second have {int((first & second).sum())} cells in common: must have none")
    one, other = (ratio(hits[kind], replicate[kind]) for kind in (first, second))
    rests = {"first": (hits - one.value) * first, "second": (hits - other.value) * second}
    runs = pd.DataFrame(rests).groupby(replicate.to_numpy()).sum()
    products = math.sqrt(float((runs["first"] ** 2).sum()) * float((runs["second"] ** 2).sum()))
    shared = float((runs["first"] * runs["second"]).sum())
    return Difference(one, other, max(-1.0, min(1.0, shared / products)) if products > 0 else 0.0)


def runs_needed(
    first: float, second: float, *, level: float = LEVEL, power: float = POWER, cells_per_run: float = 1.0
) -> int | None:
    """Compute the replicates per group that show a difference of two ratios with the given probability.

    n = (z_level sqrt(2 p (1 - p)) + z_power sqrt(p_1 (1 - p_1) + p_2 (1 - p_2)))^2/(p_1 - p_2)^2 independent cells per
    group, p = (p_1 + p_2)/2, divided by those in a replicate.

    Parameters
    ----------
    first, second
        Ratios p_1, p_2 from 0 to 1.
    level
        1 minus the probability to see a difference where there is none, two-sided.
    power
        Probability to see this one, above 0.5.
    cells_per_run
        Effective number of cells in a replicate, > 0.

    Returns
    -------
    int | None
        At least 1; None if the ratios are equal, which no number of runs shows to be different.

    Source
    ------
    J. L. Fleiss, Statistical Methods for Rates and Proportions (1981), section 3.2, without continuity correction.
    """
    for name, value in (("first", first), ("second", second)):
        if not 0 <= value <= 1:
            raise InvalidProblem(f"{name} = {describe(value)}: must be a ratio from 0 to 1")
    if not 0.5 < power < 1:
        raise InvalidProblem(f"power = {describe(power)}: must be above 0.5 and below 1")
    number("cells_per_run", cells_per_run, positive=True)
    if first == second:
        return None
    middle = (first + second) / 2
    equal, unequal = math.sqrt(2 * middle * (1 - middle)), math.sqrt(first * (1 - first) + second * (1 - second))
    cells = sample_size(first - second, equal, unequal, level=level, power=power)
    return max(1, math.ceil(cells / cells_per_run))
