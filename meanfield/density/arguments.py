"""What a density is made of, checked: corners of its box, breaks, the covariance of a normal one."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dincl import checks
from dincl.errors import InvalidProblem

Floats = NDArray[np.float64]

MOST_AXES = 3


def row(name: str, value: ArrayLike, length: int | None) -> Floats:
    """Numbers of shape (length,), None: any; a single one is a row of one."""
    return checks.shaped(name, np.atleast_1d(checks.array(name, value)), (length,))


def corners(lower: ArrayLike, upper: ArrayLike) -> tuple[Floats, Floats]:
    """Those of a box, the lower one below the upper one."""
    low = row("lower", lower, None)
    high = row("upper", upper, len(low))
    if len(low) > MOST_AXES:
        raise InvalidProblem(f"lower = {checks.describe(low)}: must have 1, 2 or 3 components")
    if not (low < high).all():
        raise InvalidProblem(f"upper = {checks.describe(high)}: must be > lower = {checks.describe(low)}")
    return low, high


def breaks_within(breaks: tuple[float, ...], lower: Floats, upper: Floats) -> tuple[float, ...]:
    """Breaks as increasing numbers inside the box."""
    listed = checks.items("breaks", breaks, object, "a list of numbers")
    found = tuple(sorted({checks.number("breaks", value) for value in listed}))
    if found and (len(lower) > 1 or not lower[0] < found[0] or not found[-1] < upper[0]):
        raise InvalidProblem(f"breaks = {found}: must lie inside the box, in one dimension")
    return found


def factor_of(deviation: ArrayLike, nx: int) -> tuple[Floats, Floats]:
    """The Cholesky factor L of the covariance, and the deviation of each component."""
    numbers = checks.array("deviation", deviation)
    given = checks.shaped("deviation", numbers, (nx, nx)) if numbers.ndim == 2 else row("deviation", numbers, nx)
    if given.ndim == 1:
        if (given <= 0).any():
            raise InvalidProblem(f"deviation = {checks.describe(given)}: must be > 0")
        return np.diag(given), given
    try:
        factor: Floats = np.linalg.cholesky(given).astype(np.float64)
    except np.linalg.LinAlgError:
        factor = np.zeros((nx, nx))
    if not np.array_equal(given, given.T) or not factor.any():
        raise InvalidProblem(f"deviation = {checks.describe(given)}: must be symmetric and positive definite")
    return factor, np.sqrt(np.diag(given))
