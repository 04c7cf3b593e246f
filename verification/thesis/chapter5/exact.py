"""Closed forms: y is harmonic for Examples 5.2 and 5.3 with linear forces."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from verification.thesis.chapter5.cases import CASES, FIBRE

Floats = NDArray[np.float64]


class ExactMotion(NamedTuple):
    """y, v (K, ny), X and multipliers (K, N, nx) at K times."""

    y: Floats
    v: Floats
    X: Floats
    multipliers: Floats


def harmonic(name: str, X: Floats, t: Floats, v0: float | None = None) -> ExactMotion:
    """Return the motion of particles X (N, 1) with StraightFibre ("straight") or LinearFibre ("linear")::

    straight: (1 + m s) y'' = -k0 (y - y_rest) - k1 s y,  s = <X^2>/y^2;  lambda = -y (k1 X + m X y''/y)
    linear:   (1 + m) y'' = -k0 (y - y_rest) - k1 <X>,  X - y constant;   lambda = -(k1 X + m y'')

    from y(0) and y'(0) of the case, unless ``v0`` is another y'(0).
    """
    m, k0, rest, k1 = (FIBRE[key] for key in ("m", "k0", "y_rest", "k1"))
    (y0,) = CASES[name].y0
    v0 = CASES[name].v0[0] if v0 is None else v0
    share, offset = (float((X**2).mean()) / y0**2, 0.0) if name == "straight" else (1.0, float(X.mean()) - y0)
    stiffness = k0 + k1 * share
    middle, rate = (k0 * rest - k1 * offset) / stiffness, np.sqrt(stiffness / (1 + m * share))
    cos, sin = np.cos(rate * t)[:, None], np.sin(rate * t)[:, None]
    y = middle + (y0 - middle) * cos + v0 / rate * sin
    v = -(y0 - middle) * rate * sin + v0 * cos
    a = -(rate**2) * (y - middle)
    if name == "straight":
        moved, pushed = X * y[:, None] / y0, X * a[:, None] / y0
        return ExactMotion(y, v, moved, -y[:, None] * (k1 * moved + m * pushed))
    moved = X + y[:, None] - y0
    return ExactMotion(y, v, moved, -(k1 * moved + m * a[:, None]))
