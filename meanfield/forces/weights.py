"""The weights of particles."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dincl.checks import shaped
from dincl.errors import InvalidProblem

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

# Weights that come from a sum of many terms may miss 1 by this much.
SUM_TOLERANCE = 1e-10


def each(weights: NDArray[np.float64] | None, particles: int) -> NDArray[np.float64]:
    """The weight of each particle, shape (Q,): those given, which sum to 1, or 1/Q if there are none."""
    return np.full(particles, 1 / particles) if weights is None else weights


def checked(name: str, value: ArrayLike, particles: int) -> NDArray[np.float64]:
    """Weights of a user, >= 0, of shape (particles,) and sum 1 to 1e-10; InvalidProblem if they are not."""
    weights = shaped(name, value, (particles,))
    if (weights < 0).any() or abs(weights.sum() - 1.0) > SUM_TOLERANCE:
        found = f"least {weights.min():.3g}, sum {weights.sum():.12g}"
        raise InvalidProblem(f"{name} ({found}): must be >= 0 and sum to 1")
    return weights
