"""Means over runs with Student's intervals, and two of them against each other."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import stdtrit

from tissue.study.answers import mean_and_half
from tissue.study.proportions import LEVEL, sample_size

MAKES_NO_NUMBERS = True

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Mean:
    """Of one value of each run: ``spread`` is its standard deviation, ``half`` half of the 95 % interval."""

    value: float
    half: float
    spread: float
    runs: int

    def interval(self) -> tuple[float, float]:
        """Student's."""
        return self.value - self.half, self.value + self.half


def mean_of(values: Floats) -> Mean:
    """Of two runs at least."""
    value, half = mean_and_half(values)
    return Mean(float(value), float(half), float(values.std(ddof=1)), len(values))


def means_of(values: Any) -> tuple[Floats, Floats, Floats]:
    """The mean over the first axis, of length 2 at least, and the ends of its intervals."""
    mean, half = mean_and_half(values)
    return mean, mean - half, mean + half


def difference(first: Mean, second: Mean) -> tuple[float, float, float]:
    """first - second with the ends of Welch's 95 % interval, as of independent runs.

    Source
    ------
    B. L. Welch, The generalization of Student's problem, Biometrika 34 (1947).
    """
    a, b = first.spread**2 / first.runs, second.spread**2 / second.runs
    value = first.value - second.value
    if a + b == 0:
        return value, value, value
    freedom = (a + b) ** 2 / (a**2 / (first.runs - 1) + b**2 / (second.runs - 1))
    half = float(stdtrit(freedom, 0.5 + LEVEL / 2)) * math.sqrt(a + b)
    return value, value - half, value + half


def runs_to_see(first: Mean, second: Mean) -> int | None:
    """Runs of each with which a difference of this size is seen, as ``runs_needed`` says it of ratios; None: with none.

    n = (z_level + z_power)^2 (s_1^2 + s_2^2)/(m_1 - m_2)^2.
    """
    if first.value == second.value:
        return None
    spread = math.hypot(first.spread, second.spread)
    return max(2, math.ceil(sample_size(first.value - second.value, spread, spread, level=LEVEL)))
