"""Weights of points and particles, which sum to 1."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dincl.checks import shaped
from dincl.errors import InvalidProblem

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

# Weights that come from a sum of many terms may miss 1 by this much.
SUM_TOLERANCE = 1e-10


def checked_weights(name: str, value: ArrayLike, count: int) -> NDArray[np.float64]:
    """Return a user's weights as an array of shape (count,).

    Raises
    ------
    InvalidProblem
        if a weight is negative or the weights do not sum to 1 within 1e-10.
    """
    weights = shaped(name, value, (count,))
    if (weights < 0).any() or abs(weights.sum() - 1.0) > SUM_TOLERANCE:
        found = f"least {weights.min():.3g}, sum {weights.sum():.12g}"
        raise InvalidProblem(f"{name} ({found}): must be >= 0 and sum to 1")
    return weights


def full_weights(weights: NDArray[np.float64] | None, particles: int) -> NDArray[np.float64]:
    """Return the weights of Q particles, shape (Q,): the given ones, or 1/Q each for None."""
    return np.full(particles, 1 / particles) if weights is None else weights
