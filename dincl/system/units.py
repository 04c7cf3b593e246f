"""Units of length and time of a run, powers of two: its numbers are of size one, and no bit of them changes."""

from __future__ import annotations

import math
from typing import NamedTuple


class Units(NamedTuple):
    """Numbers of a run times ``length`` and ``time`` are those of the user."""

    length: float = 1.0
    time: float = 1.0

    @property
    def speed(self) -> float:
        """The unit of velocities [length / time]."""
        return self.length / self.time


def units_of(length: float, time: float) -> Units:
    """The powers of two next below a length and a time; 1 for a zero."""
    return Units(*(math.ldexp(0.5, math.frexp(value)[1]) if value > 0 else 1.0 for value in (length, time)))
