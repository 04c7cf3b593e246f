"""The line of least squares through points that scatter about it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import ndtri, stdtrit

CONFIDENCE = 0.95


class Slope(NamedTuple):
    """Slope of a line with the ends of its 95 % interval."""

    value: float
    low: float
    high: float


class WeightedLine(NamedTuple):
    """A line: its slope, its value at x = 0, and chi^2 per degree of freedom, NaN for points without errors."""

    slope: Slope
    at_zero: float
    misfit: float


def slope(x: ArrayLike, y: ArrayLike) -> Slope:
    """Return the slope of y (n,) against x (n,), n >= 3, with Student's interval from the residuals."""
    x, y = np.asarray(x, dtype=np.float64), np.asarray(y, dtype=np.float64)
    centred = x - x.mean()
    spread = float(centred @ centred)
    value = float(centred @ y) / spread
    residual = y - y.mean() - value * centred
    freedom = len(x) - 2
    half = float(stdtrit(freedom, 0.5 + 0.5 * CONFIDENCE) * np.sqrt(residual @ residual / freedom / spread))
    return Slope(value, value - half, value + half)


def weighted_line(x: ArrayLike, y: ArrayLike, error: ArrayLike) -> WeightedLine:
    """Fit a line through (x, y) (n,), n >= 3, weighted by the standard errors of y; all of them 0: equal weights.

    The interval of the slope is the larger one of two: from the errors, and by Student's t from the scatter of the
    points about the line.
    """
    x, y, error = (np.asarray(values, dtype=np.float64) for values in (x, y, error))
    exact = not error.any()
    weight = np.ones(len(x)) if exact else error**-2.0
    centre = np.average(x, weights=weight)
    spread = float(weight @ (x - centre) ** 2)
    value = float(weight @ ((x - centre) * y)) / spread
    at_zero = float(np.average(y, weights=weight)) - value * centre
    misfit = float(weight @ (y - at_zero - value * x) ** 2) / (len(x) - 2)
    by_scatter = float(stdtrit(len(x) - 2, (1 + CONFIDENCE) / 2)) * np.sqrt(misfit)
    by_error = 0.0 if exact else float(ndtri((1 + CONFIDENCE) / 2))
    half = max(by_error, by_scatter) * spread**-0.5
    return WeightedLine(Slope(value, value - half, value + half), at_zero, np.nan if exact else misfit)
