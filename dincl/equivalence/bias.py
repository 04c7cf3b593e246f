"""Bias of a simpler model with the interval that decides whether it is enough."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Literal, Self

from dincl.checks import describe
from dincl.errors import InvalidProblem

Verdict = Literal["enough", "not enough", "open"]


@dataclass(frozen=True)
class Bias:
    """Bias of a simpler model with the interval that decides.

    Attributes
    ----------
    bias
        Quantity of the simpler model minus that of the full model, or the distance of both, >= 0.
    low, high
        Interval of the true bias: of both one-sided tests, or proved by estimates of errors.
    tolerance
        The largest bias that does not matter, > 0, in the same unit.
    """

    bias: float
    low: float
    high: float
    tolerance: float

    @property
    def verdict(self) -> Verdict:
        """Whether the interval lies within the tolerance, outside of it, or neither."""
        if -self.tolerance < self.low and self.high < self.tolerance:
            return "enough"
        return "not enough" if self.low > self.tolerance or self.high < -self.tolerance else "open"

    def widened(self, error: float) -> Self:
        """Return the same bias with an interval that is longer by ``error`` >= 0 at both ends."""
        return replace(self, low=self.low - error, high=self.high + error)


def check_tolerance(tolerance: object, *, shares: bool = False) -> float:
    """Return a tolerance > 0, of shares < 1; raises InvalidProblem."""
    number = isinstance(tolerance, int | float) and not isinstance(tolerance, bool) and math.isfinite(tolerance)
    if not number or not tolerance > 0 or (shares and tolerance >= 1):  # type: ignore[operator]
        allowed = "above 0 and below 1, such as 0.03 for 3 points" if shares else "above 0, in the unit of the outcome"
        raise InvalidProblem(f"tolerance = {describe(tolerance)}: must be a number {allowed}")
    return float(tolerance)  # type: ignore[arg-type]
