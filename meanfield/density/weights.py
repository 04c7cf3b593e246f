"""The weights of a measure of points."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dincl.checks import shaped
from dincl.errors import InvalidProblem

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray

# Weights that come from a sum of many terms may miss 1 by this much.
SUM_TOLERANCE = 1e-10


def checked(name: str, value: ArrayLike, count: int) -> NDArray[np.float64]:
    """Weights of a user, >= 0, of shape (count,) and sum 1 to 1e-10; InvalidProblem if they are not."""
    weights = shaped(name, value, (count,))
    if (weights < 0).any() or abs(weights.sum() - 1.0) > SUM_TOLERANCE:
        found = f"least {weights.min():.3g}, sum {weights.sum():.12g}"
        raise InvalidProblem(f"{name} ({found}): must be >= 0 and sum to 1")
    return weights
