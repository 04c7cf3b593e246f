"""The change of a density, tested with a smooth function."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from verification.thesis.chapter5.instant import Floats


def tested(flow: Callable[[Floats], Floats], rate: Callable[[Floats, Floats], Floats], nx: int) -> tuple[float, float]:
    """d/dt int xi f dx by moving each x with the flow, and by a formula for df/dt; f, xi are bells off the centre."""
    line = np.linspace(-8.0, 8.0, 81)
    x = np.stack(np.meshgrid(*[line] * nx, indexing="ij"), axis=-1)
    cell = (line[1] - line[0]) ** nx
    f, xi = np.exp(-((x - 0.3) ** 2).sum(-1) / 2), np.exp(-((x + 0.5) ** 2).sum(-1) / 3)
    moved = (-2 / 3 * (x + 0.5) * flow(x)).sum(-1) * xi
    return float((moved * f).sum() * cell), float((xi * rate(x, f)).sum() * cell)


def shift_rate(x: Floats, f: Floats, v: float) -> Floats:
    """-(f v)' for the bell f = exp(-(x - 0.3)^2/2), x of shape (..., 1)."""
    return np.asarray((x[..., 0] - 0.3) * f * v)
