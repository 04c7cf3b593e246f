"""Calls of user functions: what they return is checked, what they raise becomes a Status."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.checks import LARGEST, bounded, describe
from dincl.errors import StepFailure

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from dincl.status import Status

# What a function raises when its arithmetic, its indexing or its types are wrong.
CALLABLE_ERRORS = (ArithmeticError, AttributeError, LookupError, NameError, TypeError, ValueError)


def call(name: str, status: Status, function: Callable[..., Any], *arguments: Any) -> Any:
    """function(*arguments); StepFailure with ``status``, naming the function, if it raises."""
    try:
        return function(*arguments)
    except CALLABLE_ERRORS as error:
        raise StepFailure(status, f"{name} raised {type(error).__name__}: {error}.") from error


def numbers(name: str, status: Status, raw: Any, shape: tuple[int, ...] | None = None) -> NDArray[np.float64]:
    """What ``name`` returned as float64 numbers, of the given shape if one is given; StepFailure if it is not that."""
    try:
        values = np.asarray(raw)
    except ValueError:
        values = np.asarray(None)
    if values.dtype.kind not in "fiu" or (shape is not None and values.shape != shape):
        wanted = "real numbers" + ("" if shape is None else f" of shape {shape}")
        found = describe(raw) if values.dtype.kind not in "fiu" else f"an array of shape {values.shape}"
        raise StepFailure(status, f"{name} returned {found}: must be {wanted}.")
    values = values.astype(np.float64, copy=False)
    if not bounded(values):
        where = tuple(int(k) for k in np.argwhere(~np.isfinite(values) | (np.abs(values) > LARGEST))[0])
        raise StepFailure(
            status,
            f"{name} returned {values[where]} at index {where}: must be finite, of magnitude at most {LARGEST:g}.",
        )
    return values
