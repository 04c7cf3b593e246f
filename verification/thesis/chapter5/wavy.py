"""Motions and the flow of the fibre g = X + sin(X)/2 - y without forces, which fulfils all assumptions of chapter 5."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from verification.claims.formal.algebra import library
from verification.thesis.chapter5.instant import Floats

T, STEPS = 3.0, 200


def soft(x: Floats) -> Floats:
    """Return Phi of g = X + sin(X)/2 - y: bounded by 2, with bounded derivatives, as (A4) and (A5) ask."""
    return 1 / (1 + np.cos(x) / 2)


def symbolic_soft(x: Any) -> Any:
    """Return Phi of ``soft`` for a symbol."""
    return 1 / (1 + library().cos(x) / 2)


def runge_kutta(rate: Callable[[Floats], Floats], z: Floats, t: float = T, steps: int = STEPS) -> Floats:
    """Integrate z' = rate(z) by the classical method of order 4: z(0), ..., z(t), (steps + 1, n)."""
    dt, path = t / steps, [z]
    for _ in range(steps):
        k1 = rate(z)
        k2 = rate(z + dt / 2 * k1)
        k3 = rate(z + dt / 2 * k2)
        z = z + dt / 6 * (k1 + 2 * k2 + 2 * k3 + rate(z + dt * k3))
        path.append(z)
    return np.array(path)
