"""When an EMT event begins: never, at a fixed time, or at a random one (section 2.3.1 of chapter 4)."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import Any

import numpy as np

from tissue.files.units import DURATION, Measure, parse
from tissue.model.cells import Floats

NEVER = "never"
ALLOWED = 'never, a time, or a range of times with a probability: "never", "12 h", "6 h to 24 h", "6 h to 24 h, 70 %"'
_RANGE = re.compile(r"(?P<low>.+?) to (?P<high>[^,]+?)(?: *, *(?P<percent>[0-9]+(?:\.[0-9]+)?) *%)?")


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
        if self.low == self.high and self.percent == 100:
            return str(self.low)
        share = "" if self.percent == 100 else f", {self.percent:g} %"
        return f"{self.low} to {self.high}{share}"

    def times(self, whether: Floats, when: Floats) -> Floats:
        """The times [h] for numbers drawn uniformly from [0, 1): inf for never."""
        if self.low is None or self.high is None:
            return np.full(len(when), math.inf)
        low, high = self.low.value, self.high.value
        return np.where(100 * whether < self.percent, low + (high - low) * when, math.inf)


def timing(text: Any) -> Timing:
    """The timing that a text stands for; raises ValueError, which says what is wrong with it."""
    if not isinstance(text, str):
        raise ValueError("it must be a text")  # noqa: TRY004 - input errors are of one class
    if text.strip() == NEVER:
        return Timing()
    match = _RANGE.fullmatch(text.strip())
    if match is None:
        time = _time(text)
        return Timing(time, time)
    low, high, percent = _time(match["low"]), _time(match["high"]), float(match["percent"] or 100)
    if low.value > high.value:
        raise ValueError("the first time must be the earlier one")
    if percent > 100:
        raise ValueError("the probability must be 100 % at most")
    return Timing(low, high, percent)


def _time(text: str) -> Measure:
    time = parse(text, DURATION)
    if not time.value >= 0:
        raise ValueError("times must be >= 0")
    return time
