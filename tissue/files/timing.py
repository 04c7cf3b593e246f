"""When an EMT event begins: never, at a fixed time, or at a random one (section 2.3.1 of chapter 4)."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import Any

import numpy as np

from tissue.files.units import DURATION, Measure, parse
from tissue.state.cells import Floats

NEVER = "never"
ALLOWED = (
    "never, a time, or a range of times, the last two also with a probability: "
    '"never", "12 h", "18 h, 50 %", "6 h to 24 h", "6 h to 24 h, 70 %"'
)
_PERCENT = re.compile(r" *([0-9]+(?:\.[0-9]+)?) *% *")


@dataclass(frozen=True)
class Timing:
    """U^p(low, high): with probability p uniform between low and high [h], else never; ``str`` writes it for a file."""

    low: Measure | None = None  # None: never
    high: Measure | None = None
    percent: float = 100.0

    @property
    def ever(self) -> bool:
        """Whether it may begin."""
        return self.low is not None and self.percent > 0

    @property
    def sure(self) -> bool:
        """Whether it begins in any case."""
        return self.low is not None and self.percent == 100

    @property
    def fixed(self) -> float | None:
        """The one time at which it may begin [h]; None if there are none, or many."""
        return None if self.low is None or self.low != self.high else self.low.value

    def __str__(self) -> str:
        if self.low is None:
            return NEVER
        when = f"{self.low}" if self.low == self.high else f"{self.low} to {self.high}"
        return when if self.percent == 100 else f"{when}, {np.format_float_positional(self.percent, trim='-')} %"

    def times(self, whether: Floats, when: Floats) -> Floats:
        """Compute the times [h] from numbers drawn uniformly from [0, 1); inf for never."""
        if self.low is None or self.high is None:
            return np.full(len(when), math.inf)
        low, high = self.low.value, self.high.value
        return np.where(100 * whether < self.percent, low + (high - low) * when, math.inf)


def timing(text: Any) -> Timing:
    """Read a timing; raises ValueError, which says what is wrong with the text."""
    if not isinstance(text, str):
        raise ValueError("it must be a text")  # noqa: TRY004 - input errors are of one class
    if text.strip() == NEVER:
        return Timing()
    when, comma, share = text.strip().partition(",")
    first, to, last = when.partition(" to ")
    low = _time(first)
    high = _time(last) if to else low
    if low.value > high.value:
        raise ValueError("the first time must be the earlier one")
    return Timing(low, high, _percent(share) if comma else 100.0)


def _percent(text: str) -> float:
    match = _PERCENT.fullmatch(text)
    if match is None:
        raise ValueError("behind the comma must stand a probability such as 70 %")
    if float(match[1]) > 100:
        raise ValueError("the probability must be 100 % at most")
    return float(match[1])


def _time(text: str) -> Measure:
    time = parse(text, DURATION)
    if not time.value >= 0:
        raise ValueError("times must be >= 0")
    return time
