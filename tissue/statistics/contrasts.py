"""Planned contrasts: weighted sums over groups, such as a difference of differences, with intervals and p-values.

Groups are independent of each other: scenarios with runs of their own. Several contrasts share groups, so they are
correlated; ``Family`` corrects for as many as were planned, and knows these correlations.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal, Protocol, get_args

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.special import ndtr, ndtri, stdtrit
from scipy.stats import qmc

from dincl.checks import describe
from dincl.errors import InvalidProblem
from tissue.statistics.proportions import LEVEL, corrected, quantile, wilson
from tissue.statistics.ratios import Ratio

Floats = NDArray[np.float64]
Correction = Literal["simultaneous", "holm"]
# Standard deviations beyond which a p-value is stated as that of this many: 1e-15.
FARTHEST = 8.0
# Points of the integral over the errors of the groups: probabilities to 1e-4.
POINTS = 1 << 16


class Contrast(Protocol):
    """A weighted sum over groups that is ``null`` where there is no effect."""

    @property
    def value(self) -> float: ...

    @property
    def null(self) -> float: ...

    @property
    def errors(self) -> Floats:
        """Standard error that each group contributes, with the sign of its weight; in the order of all groups."""

    def interval(self, level: float = LEVEL) -> tuple[float, float]: ...


@dataclass(frozen=True)
class ProportionContrast:
    """d = sum w_i p_i of independent proportions, as p_1 - p_2 or (p_1 - p_2) - (p_3 - p_4).

    Attributes
    ----------
    weights
        w_i, of sum 0; 0 for a group that is not part of it.
    ratios
        The proportions of all groups, with their effective numbers of cells.
    """

    weights: tuple[float, ...]
    ratios: tuple[Ratio, ...]
    null: float = 0.0

    @property
    def value(self) -> float:
        """The weighted sum, 0 without effect."""
        return math.fsum(w * one.value for w, one in zip(self.weights, self.ratios, strict=True))

    @property
    def errors(self) -> Floats:
        """w_i sqrt(q (1 - q)/n_i), q = (p n + 1/2)/(n + 1), which is never 0 or 1."""
        p, n = _values(self.ratios)
        q = (p * n + 0.5) / (n + 1)
        return np.asarray(self.weights) * np.sqrt(q * (1 - q) / n)

    def interval(self, level: float = LEVEL) -> tuple[float, float]:
        """Compute d -+ sqrt(sum (w_i p_i - e_i)^2), e_i the lower (upper) end of Wilson's interval of w_i p_i.

        For two groups it is Newcombe's hybrid score interval.

        Source
        ------
        G. Y. Zou, W. Huang, X. Zhang, A note on confidence interval estimation for a linear function of binomial
        proportions, Computational Statistics & Data Analysis 53 (2009).
        """
        w, (p, n) = np.asarray(self.weights), _values(self.ratios)
        ends = w * np.array(wilson(p, n, level))
        below, above = w * p - ends.min(axis=0), ends.max(axis=0) - w * p
        most, least = w[w > 0].sum(), w[w < 0].sum()
        low, high = self.value - np.sqrt((below**2).sum()), self.value + np.sqrt((above**2).sum())
        return max(float(least), float(low)), min(float(most), float(high))


@dataclass(frozen=True)
class RatioContrast:
    """prod p_i^w_i of independent proportions, as p_1/p_2 or (p_1/p_2)/(p_3/p_4); 1 without effect.

    Each p is (p n + 1/2)/(n + 1/2), so that a group without hits does not make the ratio 0 or infinite.
    """

    weights: tuple[float, ...]
    ratios: tuple[Ratio, ...]
    null: float = 1.0

    @property
    def value(self) -> float:
        """The ratio, 1 without effect."""
        return math.exp(self._logarithm)

    @property
    def errors(self) -> Floats:
        """w_i sqrt(1/(p n + 1/2) - 1/(n + 1/2)), of the logarithm."""
        p, n = _values(self.ratios)
        return np.asarray(self.weights) * np.sqrt(1 / (p * n + 0.5) - 1 / (n + 0.5))

    def interval(self, level: float = LEVEL) -> tuple[float, float]:
        """Compute the normal interval of the logarithm.

        Source
        ------
        S. D. Walter, The distribution of Levin's measure of attributable risk, Biometrika 62 (1975).
        """
        half = quantile(level) * float(np.linalg.norm(self.errors))
        return math.exp(self._logarithm - half), math.exp(self._logarithm + half)

    @property
    def _logarithm(self) -> float:
        p, n = _values(self.ratios)
        return float(np.asarray(self.weights) @ np.log((p * n + 0.5) / (n + 0.5)))


@dataclass(frozen=True)
class MeanContrast:
    """sum w_i m_i of means of one value of each run, such as a height.

    Attributes
    ----------
    weights
        w_i, of sum 0.
    samples
        The values of each group, two or more.
    """

    weights: tuple[float, ...]
    samples: tuple[Floats, ...]
    null: float = 0.0

    @property
    def value(self) -> float:
        """The weighted sum, 0 without effect."""
        return math.fsum(w * float(one.mean()) for w, one in zip(self.weights, self.samples, strict=True))

    @property
    def errors(self) -> Floats:
        """w_i s_i/sqrt(n_i)."""
        # Of equal values std is not 0 but rounding.
        spreads = [one.std(ddof=1) / math.sqrt(len(one)) if np.ptp(one) > 0 else 0.0 for one in self.samples]
        found: Floats = np.asarray(self.weights) * np.array(spreads)
        return found

    def interval(self, level: float = LEVEL) -> tuple[float, float]:
        """Compute Welch's interval, with the degrees of freedom of Satterthwaite; infinite without any spread.

        A few runs with one value, such as a 0 or 1 of each, do not tell that no other occurs.

        Source
        ------
        B. L. Welch, The generalization of Student's problem, Biometrika 34 (1947).
        """
        quantile(level)  # refuses a bad level
        variances = self.errors**2
        if not variances.any():
            return -math.inf, math.inf
        freedom = np.array([len(one) - 1 for one in self.samples])
        degrees = variances.sum() ** 2 / (variances**2 / freedom).sum()
        half = float(stdtrit(degrees, 0.5 + level / 2) * np.sqrt(variances.sum()))
        return self.value - half, self.value + half


def p_value(one: Contrast) -> float:
    """Compute 1 minus the level at which the interval of a contrast ends at no effect: so both always agree.

    At least 1e-15, the p-value at 8 standard deviations.
    """

    def excess(z: float) -> float:
        low, high = one.interval(float(1 - 2 * ndtr(-z)))
        return min(high - one.null, one.null - low)

    if one.value == one.null or excess(1e-6) >= 0:
        return 1.0
    z = FARTHEST if excess(FARTHEST) <= 0 else float(brentq(excess, 1e-6, FARTHEST, xtol=1e-6))
    return float(2 * ndtr(-z))


@dataclass(frozen=True)
class Family:
    """All comparisons that were planned together: the chance of any false finding among them is 1 - ``level``.

    Attributes
    ----------
    blocks
        The planned contrasts, a list for each outcome. Within a list their correlation is known, also that of
        differences and ratios of the same proportions: their errors are those of the groups, to first order. Between
        lists they count as independent, with which the chance is at most what is said.
    correction
        "simultaneous": intervals and p-values of all at once. "holm": p-values by Holm, which find a little more;
        intervals, each at the level of m comparisons, 1 - (1 - level)/m, may then hold no effect where p finds one.
    level
        Probability that all intervals cover.

    Source
    ------
    T. Hothorn, F. Bretz, P. Westfall, Simultaneous inference in general parametric models, Biometrical Journal 50
    (2008); Z. Sidak, Rectangular confidence regions for the means of multivariate normal distributions, JASA 62 (1967).
    """

    blocks: tuple[tuple[Contrast, ...], ...]
    correction: Correction = "simultaneous"
    level: float = LEVEL

    def __post_init__(self) -> None:
        if self.correction not in get_args(Correction):
            allowed = ", ".join(get_args(Correction))
            raise InvalidProblem(f"correction = {describe(self.correction)}: must be one of {allowed}")
        quantile(self.level)  # refuses a bad level

    @property
    def count(self) -> int:
        """The number of comparisons."""
        return sum(map(len, self.blocks))

    @cached_property
    def level_of_each(self) -> float:
        """The level of one interval with which all of them cover with ``level``."""
        if self.correction == "holm" or self.count <= 1:
            return 1 - (1 - self.level) / max(1, self.count)
        least = quantile(self.level)
        if self._together(least) >= self.level:  # as where no contrast but one has an error
            return self.level
        cautious = quantile(1 - (1 - self.level) / self.count)
        z = brentq(lambda z: self._together(z) - self.level, least, cautious + 1e-3, xtol=1e-4)
        return float(1 - 2 * ndtr(-z))

    def p_values(self) -> list[float]:
        """Return the corrected p-values, in the order of the blocks."""
        import pandas as pd

        alone = [p_value(one) for block in self.blocks for one in block]
        if self.correction == "holm" or self.count == 1:
            return [float(p) for p in corrected(pd.Series(alone, dtype=float))]
        # Far out the points have no digits left; the bounds hold for any correlation.
        return [min(max(p, 1 - self._together(-float(ndtri(p / 2)))), self.count * p, 1.0) for p in alone]

    def _together(self, z: float) -> float:
        """Compute the least P[|Z_j| <= z for all j] that the correlations within the blocks allow."""
        return math.prod(float(np.searchsorted(largest, z, side="right")) / POINTS for largest in self._largest)

    @cached_property
    def _largest(self) -> list[Floats]:
        """Largest |Z_j| of each block at POINTS normal points of equal weight, ascending."""
        return [np.sort(np.abs(_standardised(block)).max(axis=1)) for block in self.blocks]


def _standardised(block: Sequence[Contrast]) -> Floats:
    """Return the contrasts of a block in units of their errors, (POINTS, contrasts), where there is no effect."""
    errors = np.array([one.errors for one in block])
    lengths = np.linalg.norm(errors, axis=1, keepdims=True)
    normal = ndtri(qmc.Sobol(errors.shape[1], rng=0).random(POINTS))
    found: Floats = normal @ np.divide(errors, lengths, where=lengths > 0, out=np.zeros_like(errors)).T
    return found


def _values(ratios: Sequence[Ratio]) -> tuple[Floats, Floats]:
    return np.array([one.value for one in ratios]), np.array([one.size for one in ratios])
