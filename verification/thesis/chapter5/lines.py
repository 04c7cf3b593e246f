"""The line of least squares through points that scatter about it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import stdtrit

from verification.order import CONFIDENCE


class Slope(NamedTuple):
    """Slope of a line with the ends of its 95 % interval."""

    value: float
    low: float
    high: float


def slope(x: ArrayLike, y: ArrayLike) -> Slope:
    """The slope of y (n,) against x (n,), n >= 3, with Student's interval from the residuals."""
    x, y = np.asarray(x, dtype=np.float64), np.asarray(y, dtype=np.float64)
    centred = x - x.mean()
    spread = float(centred @ centred)
    value = float(centred @ y) / spread
    residual = y - y.mean() - value * centred
    freedom = len(x) - 2
    half = float(stdtrit(freedom, 0.5 + 0.5 * CONFIDENCE) * np.sqrt(residual @ residual / freedom / spread))
    return Slope(value, value - half, value + half)
