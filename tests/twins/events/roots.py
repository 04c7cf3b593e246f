"""Where a signal that is known at a few nodes first becomes negative."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

Signal = Callable[[float], float]
# Between three nodes with the lowest one in the middle, a parabola tells how far down the signal goes; it is looked
# at closely when that is less than this part of the value in the middle.
SUSPICIOUS = 0.5
ROUNDING = 4 * np.finfo(float).eps


def first_negative(signal: Signal, nodes: Sequence[float]) -> float | None:
    """The first root of a signal that becomes negative at a node, or dips below zero around one; None if it does not.

    A signal that is negative at the first node has its root there.
    """
    values = [signal(t) for t in nodes]
    if values[0] < 0:
        return nodes[0]
    for j in range(1, len(nodes)):
        if values[j] < 0:
            return root(signal, nodes[j - 1], nodes[j])
        if j + 1 < len(nodes) and 0 <= values[j] <= min(values[j - 1], values[j + 1]):
            lowest = _dip(signal, nodes[j - 1 : j + 2], values[j - 1 : j + 2])
            if lowest is not None:
                return root(signal, nodes[j - 1], lowest)
    return None


def root(signal: Signal, left: float, right: float) -> float:
    """The root, to rounding, of a signal that is >= 0 at the left end and < 0 at the right one."""
    from scipy.optimize import brentq

    if signal(left) <= 0:
        return left
    return float(brentq(signal, left, right, xtol=ROUNDING * max(abs(left), abs(right)), rtol=ROUNDING))


def _dip(signal: Signal, nodes: Sequence[float], values: Sequence[float]) -> float | None:
    """A time between the outer of three nodes at which the signal is negative."""
    from scipy.optimize import minimize_scalar

    bend = values[0] - 2 * values[1] + values[2]
    depth = (values[2] - values[0]) ** 2 / (8 * bend) if bend > 0 else 0.0
    if values[1] - depth > SUSPICIOUS * values[1]:
        return None
    low = minimize_scalar(signal, bounds=(nodes[0], nodes[2]), method="bounded")
    return float(low.x) if low.fun < 0 else None
