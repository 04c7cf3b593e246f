"""Sets and paths of chapter 1 in closed form: two discs, the outside of the unit disc."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

# Of checks that draw random numbers.
SAMPLES, SEED = 300, 12
# What is left of numbers of size 1 after some hundred operations.
ROUNDING = 1e-12

DOWN = np.array([0.0, -1.0])


def apart(y: Floats, least: float = 1.0) -> Floats:
    """Project pairs of points, (..., 2, d), that must be ``least`` apart, as in Example 2.5: half each."""
    arrow = y[..., 1, :] - y[..., 0, :]
    length = np.linalg.norm(arrow, axis=-1, keepdims=True)
    push = np.maximum(least - length, 0.0) / 2 * arrow / length
    return np.stack((y[..., 0, :] - push, y[..., 1, :] + push), axis=-2)


def outside(y: Floats) -> Floats:
    """Return the projection onto the outside of the unit disc, which is 1-prox-regular; y of shape (..., 2), not 0."""
    length = np.linalg.norm(y, axis=-1, keepdims=True)
    return np.asarray(y / np.minimum(length, 1.0))


def catch_up(start: Floats, drift: Callable[[Floats], Floats], h: float, steps: int) -> Floats:
    """Return x_0, x_1, ... of (1.39) outside of the unit disc, (steps + 1, K, 2) for K starts."""
    path = [start]
    for _ in range(steps):
        path.append(outside(path[-1] + h * drift(path[-1])))
    return np.array(path)


def falling(x: Floats) -> Floats:
    """Return the drift of points that fall onto the disc from above."""
    return np.broadcast_to(DOWN, x.shape)


def contact_gradients(x: Floats, pairs: list[tuple[int, int]]) -> Floats:
    """Return the gradients of |X_i - X_j| for the pairs given, (M, 2 N); they span -N."""
    rows = np.zeros((len(pairs), *x.shape))
    for k, (i, j) in enumerate(pairs):
        unit = (x[i] - x[j]) / np.linalg.norm(x[i] - x[j])
        rows[k, i], rows[k, j] = unit, -unit
    return rows.reshape(len(pairs), x.size)
