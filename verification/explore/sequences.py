"""Confidence sequences: intervals that cover at all numbers of runs at once, so that one may look after every run.

A 95 % interval of a fixed number of runs, looked at again and again until it leaves out zero, does so in far more than
5 % of the cases in which there is no effect. These do not: the chance that a sequence ever leaves out the true value,
at any number of runs, is at most 1 - ``LEVEL``. So a study may stop, or go on, by what was seen. Values are those of
independent runs in an order that their outcomes do not affect, one value of each run.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri

from dincl.checks import describe
from dincl.errors import InvalidProblem
from tissue.study.estimates import LEVEL, POWER

Floats = NDArray[np.float64]
Interval = tuple[float, float]
# Means that are tried, over the range of the values; and the most that a bet stakes of what a mean allows.
GRID, STAKE = 2001, 0.8
# Sequences are tightest at about this number of runs: by the size of bets; and by the variance of the prior of an
# effect, in units of that of one run.
USUAL = 100
PRIOR = 9 / USUAL
MOST_RUNS = 10_000_000


def bounded(values: Floats, least: float = 0.0, most: float = 1.0) -> Interval:
    """Enclose the mean of bounded values, such as shares of cells of each run, or differences of two shares.

    A fair bet against each mean m gains K_t(m) = prod_i (1 + lambda_i (x_i - m)), with bets lambda_i that the values
    before x_i suggest. If m is the mean, K ever exceeds 2/(1 - LEVEL) for bets upwards, or for bets downwards, with a
    probability of at most 1 - LEVEL. The interval holds the means that were never refuted so.

    Parameters
    ----------
    values
        Of each run, in their order; none may lie outside of the bounds.
    least, most
        Bounds of the values, known beforehand: least < most.

    Returns
    -------
    low, high
        From ``least`` to ``most`` without values.

    Raises
    ------
    InvalidProblem
        If a value lies outside of the bounds.

    Source
    ------
    I. Waudby-Smith, A. Ramdas, Estimating means of bounded random variables by betting, JRSS B 86 (2024), section 4.
    """
    x = (np.asarray(values, dtype=np.float64) - least) / (most - least)
    if not ((x >= -1e-12) & (x <= 1 + 1e-12)).all():
        raise InvalidProblem(f"values = {describe(values)}: must be from {least:g} to {most:g}")
    if not len(x):
        return least, most
    bets, limit = _bets(x), math.log(2 / (1 - LEVEL))
    means = np.linspace(0, 1, GRID)
    up, down = _capital(x, bets, means), _capital(1 - x, bets, 1 - means)
    kept = np.flatnonzero(np.maximum(up, down) < limit)
    if not len(kept):  # all are refuted only if the mean changes from run to run
        return least, most
    low, high = means[max(0, kept[0] - 1)], means[min(GRID - 1, kept[-1] + 1)]
    return least + (most - least) * float(low), least + (most - least) * float(high)


def _bets(x: Floats) -> Floats:
    """Return lambda_i = sqrt(2 log(2/(1 - LEVEL))/(s_{i-1}^2 (USUAL + i/2))), from the values before x_i alone.

    Any such bets are fair. The sum of lambda_i^2 grows as log t, as it must for intervals that shrink for ever.
    """
    count = np.arange(1, len(x) + 1)
    means = (0.5 + np.cumsum(x)) / (count + 1)
    variances = (0.25 + np.cumsum((x - means) ** 2)) / (count + 1)
    before = np.concatenate([[0.25], variances[:-1]])
    bets: Floats = np.sqrt(2 * math.log(2 / (1 - LEVEL)) / (before * (USUAL + count / 2)))
    return bets


def _capital(x: Floats, bets: Floats, means: Floats) -> Floats:
    """Compute the largest log K_t(m) over t for bets that the mean is larger than m; of shape (means,)."""
    with np.errstate(divide="ignore"):
        stakes = np.minimum(bets[:, None], STAKE / means)
    gains = np.log1p(stakes * (x[:, None] - means))
    largest: Floats = np.cumsum(gains, axis=0).max(axis=0)
    return largest


def unbounded(values: Floats) -> Interval:
    """Enclose the mean of values without known bounds, such as heights: exact for normal ones, else asymptotically.

    m is refuted where the likelihood of the t statistics with a prior N(0, c^2) of the effect in units of the spread
    ever exceeds that without effect by 1/(1 - LEVEL): |mean - m| >= s sqrt((n - 1) r/n), with
    r = (1 - q)/(q - g), q = ((1 - LEVEL)^2 g)^(1/n), g = 1/(1 + n c^2); infinite for q <= g.

    Parameters
    ----------
    values
        Of each run, in their order.

    Returns
    -------
    low, high
        -inf and inf for fewer than about ten values.

    Source
    ------
    H. Wang, A. Ramdas, Anytime-valid t-tests and confidence sequences for Gaussian means with unknown variance,
    Sequential Analysis 44 (2025).
    """
    x = np.asarray(values, dtype=np.float64)
    n = np.arange(1, len(x) + 1)
    means = np.cumsum(x) / n
    centred = x - means[-1] if len(x) else x
    spreads = np.sqrt(np.maximum(np.cumsum(centred**2) / n - (np.cumsum(centred) / n) ** 2, 0))
    half = _half(n)
    halves = np.where(half < np.inf, spreads, 1.0) * half
    low, high = float((means - halves).max(initial=-np.inf)), float((means + halves).min(initial=np.inf))
    return (low, high) if low <= high else (-math.inf, math.inf)


def _half(n: NDArray[np.int64]) -> Floats:
    """Return half of the length of ``unbounded`` for n values of spread 1, with the divisor n."""
    g = 1 / (1 + n * PRIOR)
    q = ((1 - LEVEL) ** 2 * g) ** (1 / n)
    half: Floats = np.sqrt(np.where(q > g, (1 - q) / np.where(q > g, q - g, 1.0), np.inf))
    return half


def runs_to_decide(size: float, spread: float) -> int | None:
    """Return the number of runs at which a sequence will probably leave out zero, if the effect is as it seems.

    The least n with half(n) spread + z_power spread/sqrt(n) <= size, at a probability of 80 %; by ``unbounded``, which
    is of the same order for bounded values.

    Parameters
    ----------
    size
        Of the effect, > 0.
    spread
        Standard deviation of its value in one run.

    Returns
    -------
    int | None
        None if ten million runs do not.
    """
    if not size > 0:
        return None
    n = np.unique(np.geomspace(10, MOST_RUNS, 2000).astype(np.int64))
    enough = spread * (_half(n) + float(ndtri(POWER)) / np.sqrt(n)) <= size
    return int(n[np.argmax(enough)]) if enough.any() else None
