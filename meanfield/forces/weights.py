"""The weights of particles."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray


def each(weights: NDArray[np.float64] | None, particles: int) -> NDArray[np.float64]:
    """The weight of each particle, shape (Q,): those given, which sum to 1, or 1/Q if there are none."""
    return np.full(particles, 1 / particles) if weights is None else weights
