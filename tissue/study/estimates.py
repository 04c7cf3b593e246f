"""One estimator for all questions about runs: a weighted sum of means, with Welch's interval.

An outcome is one number per run, such as the share of the EMT cells of the run that left, or the height of its tissue.
Runs are independent, cells of one run are not. The mean of a scenario is the mean over its runs, so each run counts
alike, however many cells it has. A difference of scenarios has the weights 1 and -1, a difference of differences
1, -1, -1 and 1; a ratio is the same sum of logarithms.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri, stdtr, stdtrit

LEVEL, POWER = 0.95, 0.8
ERROR = 0.05  # the chance of any false finding
MOST_RUNS = 10_000_000
# Spreads below this part of the values are rounding.
ROUNDING = 1e-12

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Estimate:
    """A weighted sum of means, or a product of powers of them; each of any shape, such as that of output times.

    Attributes
    ----------
    value
        Of the sum; of a ratio its logarithm. 0 where there is no effect.
    centre
        Middle of its intervals: ``value``, but for shares, see ``estimate``.
    error
        Standard error; 0 if runs have no spread.
    freedom
        Degrees of freedom of the error.
    bounds
        Of the sum: those of a difference of shares are -1 and 1.
    is_ratio
        Whether ``value`` is a logarithm.
    """

    value: Floats
    centre: Floats
    error: Floats
    freedom: Floats
    bounds: tuple[float, float]
    is_ratio: bool

    @property
    def effect(self) -> Floats:
        """The sum, or the ratio."""
        return np.exp(self.value) if self.is_ratio else self.value

    @property
    def p(self) -> Floats:
        """P-value of no effect by Student's t test; 1 without any spread. ``interval`` agrees with it at each level."""
        with np.errstate(divide="ignore", invalid="ignore"):
            found = 2 * stdtr(self.freedom, -np.abs(self.centre) / self.error)
        return np.where(self.error > 0, found, 1.0)

    def interval(self, level: float = LEVEL) -> tuple[Floats, Floats]:
        """Compute centre -+ t error, t the quantile of Student's distribution; infinite without any spread.

        A few runs with one value do not tell that no other occurs.
        """
        half = np.where(self.error > 0, stdtrit(self.freedom, 0.5 + level / 2) * self.error, np.inf)
        low, high = np.clip((self.centre - half, self.centre + half), *self.bounds)
        return (np.exp(low), np.exp(high)) if self.is_ratio else (low, high)

    def runs_to_show(self, runs: int, level: float = LEVEL) -> int | None:
        """Compute how many runs of each scenario show an effect of this size with probability ``POWER``.

        n = runs ((z_level + z_power) error/|value|)^2, with the error of ``runs`` runs of each; None for no effect,
        without any spread, and for more than ``MOST_RUNS``.
        """
        if self.value == 0 or self.error == 0:
            return None
        z = float(ndtri(0.5 + level / 2) + ndtri(POWER))
        found = runs * (z * float(self.error / self.value)) ** 2
        return math.ceil(found) if found <= MOST_RUNS else None


def estimate(
    weights: Sequence[float],
    groups: Sequence[Floats],
    extreme: float = 0.0,
    *,
    ratio: bool = False,
    paired: bool = False,
) -> Estimate:
    """Estimate sum w_i mean(x_i), or prod mean(x_i)^w_i, of groups of independent runs.

    The variance of the sum is sum w_i^2 s_i^2/n_i, its degrees of freedom are those of Satterthwaite. The spread of
    shares near 0 and 1 is larger than few runs show: two pseudo-runs are added to each group, one without hits and one
    with the share ``extreme``, and the interval is that of these n_i + 2 runs. The value is that of the runs alone. The
    error of a logarithm is that of x_i/mean(x_i) with the pseudo-runs, around the logarithm of the means of the runs
    alone; a mean without hits counts as that of half a run with hits.

    Parameters
    ----------
    weights
        w_i.
    groups
        x_i: the values of its runs, shape (n_i, ...); two or more, of shares one or more.
    extreme
        A share that hardly any run has; 0 for numbers that are no shares.
    ratio
        Whether means are multiplied.
    paired
        Whether run k of each group has the same random numbers: then the sum is taken for each run, and its mean has
        the interval of one sample.

    Source
    ------
    B. L. Welch, The generalization of Student's problem when several different population variances are involved,
    Biometrika 34 (1947); pseudo-runs as A. Agresti, B. Caffo, The American Statistician 54 (2000), and for pairs
    D. G. Bonett, R. M. Price, Journal of Educational and Behavioral Statistics 37 (2012), add them to cells.
    """
    w, means = list(weights), [x.mean(axis=0) for x in groups]
    used = [_widened(x, extreme, one < 0) for one, x in zip(w, groups, strict=True)] if extreme else list(groups)
    bounds = (-math.inf, math.inf)
    if ratio:
        means = [np.log(np.where(m > 0, m, 0.5 / (len(x) + 0.5))) for m, x in zip(means, groups, strict=True)]
        used = [x / x.mean(axis=0) for x in used]
    elif extreme:
        bounds = sum(one for one in w if one < 0), sum(one for one in w if one > 0)
    value = sum((one * m for one, m in zip(w, means, strict=True)), np.zeros(()))
    centre = value if ratio else sum((one * x.mean(axis=0) for one, x in zip(w, used, strict=True)), np.zeros(()))
    if paired:
        w, used = [1.0], [sum((one * x for one, x in zip(w, used, strict=True)), np.zeros(()))]
    variances = np.array([one**2 * _variance(x) / len(x) for one, x in zip(w, used, strict=True)])
    total = variances.sum(axis=0)
    with np.errstate(invalid="ignore"):
        freedom = 1 / sum((v / total) ** 2 / (len(x) - 1) for v, x in zip(variances, used, strict=True))
    return Estimate(value, centre, np.sqrt(total), freedom, bounds, ratio)


def _widened(x: Floats, extreme: float, negative: bool) -> Floats:
    """Add the pseudo-runs; of pairs one then has the largest sum that there can be, and the other one the smallest."""
    added = np.zeros((2, *x.shape[1:]))
    added[int(negative)] = extreme
    return np.concatenate([x, added])


def _variance(x: Floats) -> Floats:
    """Return the variance over runs; of equal values it is 0, not rounding."""
    still = np.ptp(x, axis=0) <= ROUNDING * np.abs(x).max(axis=0)
    return np.where(still, 0.0, x.var(axis=0, ddof=1))


def holm(p_values: Sequence[float]) -> tuple[Floats, Floats]:
    """Correct the p-values of comparisons that were planned together, by Holm; with levels of intervals that agree.

    The chance of any false finding p < ERROR among them is at most ERROR. With the m p-values in rising order
    the j-th one is judged at ERROR/(m - j + 1); those behind the first one that is not shown are judged as it is.

    Returns
    -------
    p, levels
        max over i <= j of (m - i + 1) p_(i), at most 1; and the level of the interval of each, at least LEVEL, that
        leaves out no effect if and only if p < ERROR.

    Source
    ------
    S. Holm, A simple sequentially rejective multiple test procedure, Scandinavian Journal of Statistics 6 (1979).
    """
    p = np.asarray(p_values, dtype=np.float64)
    order, m = np.argsort(p), len(p)
    times = m - np.arange(m)
    raised = np.minimum(1.0, np.maximum.accumulate(times * p[order]))
    shown = int((raised < ERROR).sum())
    times[shown:] = m - shown
    corrected, levels = np.empty(m), np.empty(m)
    corrected[order], levels[order] = raised, 1 - ERROR / times
    return corrected, levels
