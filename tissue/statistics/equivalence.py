"""Equivalence of two models that were run with the same seeds: two one-sided tests at a few looks.

A model is as good as another one for a question if their outcomes differ by less than a tolerance. That a difference is
not shown does not say so; here the hypothesis that is refuted is a bias of at least the tolerance. The unit is the run:
cells of one run are not independent, runs with different seeds are.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from dincl.checks import describe
from dincl.errors import InvalidProblem

Floats = NDArray[np.float64]
Verdict = Literal["enough", "not enough", "open"]
# Numbers of runs after which one may look, and the probability that "enough" is said at any of them of a model whose
# bias is the tolerance. Each look has an equal part of it (Bonferroni).
LOOKS = tuple(64 << k for k in range(8))
ERROR = 0.05
# Probability that the runs which are said to be missing decide.
POWER = 0.8


@dataclass(frozen=True)
class Equivalence:
    """Mean bias of paired runs, with the interval of both one-sided tests.

    Each end of the interval is passed by the true bias with the probability ``level``.

    Attributes
    ----------
    bias
        Quantity of the simpler model minus that of the full model.
    low, high
        Interval of the true bias.
    tolerance
        The largest bias that does not matter, > 0, in the same unit.
    spread
        Standard deviation of the difference in one run, as the tests take it.
    runs
        Pairs of runs.
    level
        The error of one look.
    """

    bias: float
    low: float
    high: float
    tolerance: float
    spread: float
    runs: int
    level: float

    @property
    def verdict(self) -> Verdict:
        """Whether the interval lies within the tolerance, outside of it, or neither."""
        if -self.tolerance < self.low and self.high < self.tolerance:
            return "enough"
        return "not enough" if self.low > self.tolerance or self.high < -self.tolerance else "open"

    @property
    def missing(self) -> int | None:
        """The further runs that will probably decide, at 80 %, if bias and spread stay; None if none are needed or do.

        Of n runs the interval is shorter than the distance d of bias and tolerance if
        n = ((z_level + z_power) spread/d)^2.
        """
        from scipy.special import ndtri

        distance = abs(self.tolerance - abs(self.bias))
        if self.verdict != "open" or distance == 0 or self.spread == 0:
            return None
        needed = (float(ndtri(1 - self.level) + ndtri(POWER)) * self.spread / distance) ** 2
        return max(LOOKS[0], math.ceil((needed - self.runs) / LOOKS[0]) * LOOKS[0])


def check_tolerance(tolerance: object, *, shares: bool = False) -> float:
    """Return a tolerance > 0, of shares < 1; raises InvalidProblem."""
    number = isinstance(tolerance, int | float) and not isinstance(tolerance, bool) and math.isfinite(tolerance)
    if not number or not tolerance > 0 or (shares and tolerance >= 1):  # type: ignore[operator]
        allowed = "above 0 and below 1, such as 0.03 for 3 points" if shares else "above 0, in the unit of the outcome"
        raise InvalidProblem(f"tolerance = {describe(tolerance)}: must be a number {allowed}")
    return float(tolerance)  # type: ignore[arg-type]


def equivalence(
    differences: Floats, tolerance: float, *, shares: bool, level: float = ERROR / len(LOOKS)
) -> Equivalence:
    """Compare the outcomes of pairs of runs by two one-sided t tests.

    The ends of the interval are b -+ (t s/sqrt(n) + c/n), t the quantile of Student's distribution with n - 1 degrees
    of freedom. For numbers c = 0, and "enough" is said where ``statsmodels.stats.weightstats.ttost_paired`` has p <
    level. Differences of shares need more care, as rare runs with a large effect may not have been seen at all: with a
    bias of the tolerance e, differences 0, 1 and -1 have a variance of at least e (1 - e), so s^2 is not taken below
    this, and c = 1/2 is the correction for continuity. Without both "enough" is said of a model with a bias of 3 points
    in up to 21 % of the cases.

    Parameters
    ----------
    differences
        Simpler minus full of each run, in any unit; two runs at least.
    tolerance
        The bias that does not matter, in the same unit, > 0.
    shares
        Whether outcomes are shares from 0 to 1, or numbers without bounds.
    level
        The error of this look.

    Raises
    ------
    InvalidProblem
        If there are fewer than two runs, a difference is not finite, or the tolerance is not positive, or a share of
        which there is none.

    Source
    ------
    D. J. Schuirmann, A comparison of the two one-sided tests procedure and the power approach for assessing the
    equivalence of average bioavailability, Journal of Pharmacokinetics and Biopharmaceutics 15 (1987).
    """
    from scipy.special import stdtrit

    if not 0 < level < 1:
        raise InvalidProblem(f"level = {describe(level)}: must be between 0 and 1, such as 0.05")
    x = np.asarray(differences, dtype=np.float64)
    if len(x) < 2 or not np.isfinite(x).all():
        raise InvalidProblem(f"differences = {describe(differences)}: must be finite, of two runs or more")
    check_tolerance(tolerance, shares=shares)
    variance = float(x.var(ddof=1))
    if shares:
        variance = max(variance, tolerance * (1 - tolerance))
    n, spread = len(x), math.sqrt(variance)
    half = float(-stdtrit(n - 1, level)) * spread / math.sqrt(n) + (0.5 / n if shares else 0.0)
    bias = float(x.mean())
    return Equivalence(bias, bias - half, bias + half, tolerance, spread, n, level)
