"""Chapter 3, section 2.2.6: the energy terms one by one, written as they are printed, and their slopes."""

from __future__ import annotations

import math
from collections.abc import Callable

Point = tuple[float, float]
# Of central differences: rounding and curvature cost about 1e-9 of the energies here.
STEP = 1e-5


def slope(f: Callable[[float], float], at: float) -> float:
    """Return f' by a central difference."""
    return (f(at + STEP) - f(at - STEP)) / (2 * STEP)


def spring(d: float, rest: float, stiffness: float, soft: float = 1.0) -> float:
    """Return (3.9) and (3.10)."""
    return stiffness / (soft + rest) * (d - soft - rest) ** 2


def junction(d: float, rest: float, stiffness: float, soft: float = 1.0) -> float:
    """Return (3.11)."""
    return stiffness / (2 * soft) * (d - rest) ** 2


def bending(a: Point, x: Point, b: Point, stiffness: float) -> float:
    """Return (3.12), the first form."""
    u, v = (a[0] - x[0], a[1] - x[1]), (b[0] - x[0], b[1] - x[1])
    return stiffness * ((u[0] * v[0] + u[1] * v[1]) / (math.hypot(*u) * math.hypot(*v)) + 1)


def repulsion(d: float, stiffness: float, soft: float = 1.0) -> float:
    """Return (3.13) without its minus."""
    return stiffness / (2 * soft) * (d - 2 * soft) ** 2 if d <= 2 * soft else 0.0
