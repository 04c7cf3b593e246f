"""Boundary of a condition, found by bisection."""

from __future__ import annotations

import math
from collections.abc import Callable

# Halvings at most; a double has fewer bits.
MOST_HALVINGS = 60


def boundary(holds: Callable[[float], bool], low: float, high: float, relative: float) -> float:
    """Return where ``holds`` changes from true at ``low`` to false at ``high``, to the precision ``relative``.

    0 < low < high are halved in the logarithm; ValueError if the two ends do not differ so.
    """
    if not holds(low) or holds(high):
        raise ValueError(f"low = {low:g}, high = {high:g}: must hold at the first and not at the second")
    for _ in range(MOST_HALVINGS):
        if high <= low * (1 + relative):
            break
        middle = math.sqrt(low * high)
        low, high = (middle, high) if holds(middle) else (low, middle)
    return math.sqrt(low * high)
