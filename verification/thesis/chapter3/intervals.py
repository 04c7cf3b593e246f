"""Means over seeds with their confidence."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import stdtrit

CONFIDENCE = 0.95


class MeanInterval(NamedTuple):
    """A mean with the interval that covers it; NaN for fewer than two values."""

    mean: float
    low: float
    high: float


def over_seeds(values: ArrayLike) -> MeanInterval:
    """Return mean +- t_{n-1} s / sqrt(n): Student's 95 % interval of the mean of values (n,), one for each seed."""
    kept = np.asarray(values, dtype=np.float64)
    if kept.size < 2:
        return MeanInterval(float(kept.mean()) if kept.size else np.nan, np.nan, np.nan)
    half = float(stdtrit(kept.size - 1, 0.5 + 0.5 * CONFIDENCE) * kept.std(ddof=1) / np.sqrt(kept.size))
    return MeanInterval(float(kept.mean()), float(kept.mean()) - half, float(kept.mean()) + half)
