"""Numbers that a value of any kind stands for; the checks of user input refuse a value that stands for none.

One rule says which numbers are taken: what ``numpy.asarray`` makes of a value, if that loses nothing. So lists, arrays
of whole or floating-point numbers, whole numbers of any length and matrices are; masked, complex, ragged and object
arrays, text, truth values, sets and generators are not.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from decimal import Decimal
from numbers import Real
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

T = TypeVar("T")
# Numbers that float knows and numpy does not.
FRACTIONS: tuple[type, ...] = (Real, Decimal)


def attempt(convert: Callable[[Any], T], value: Any) -> T | None:
    """Return ``convert(value)``; None if that raises, as a class of the user may. MemoryError is passed on."""
    try:
        return convert(value)
    except MemoryError:
        raise
    except Exception:  # noqa: BLE001  # whatever the value raises, it is not what was asked for
        return None


def plain(value: Any) -> NDArray[np.float64] | None:
    """Return ``value`` as float64 numbers, which may be infinite or NaN; None if it is not real numbers.

    An array of float64 is returned as it is.
    """
    if type(value) is np.ndarray and value.dtype.kind == "f" and value.dtype.itemsize == 8:
        return value.astype(np.float64, copy=False)
    return np.array(value) if type(value) is float else attempt(_floats, value)


def as_array(value: Any) -> NDArray[Any]:
    """Return the value as numpy sees it; TypeError for bytes and masked arrays, also in a list."""
    if isinstance(value, (bytes, bytearray)) or _is_masked(value):
        raise TypeError
    return np.asarray(value)


def one(value: Any) -> float:
    """Return a single real number as a float, a fraction or a decimal, too; NaN for anything else."""
    found = plain(value)
    if found is None and issubclass(type(value), FRACTIONS) and not isinstance(value, bool):
        fraction = attempt(float, value)
        return math.nan if fraction is None else fraction
    return math.nan if found is None or found.ndim else float(found)


def whole(value: Any) -> int | None:
    """Return a whole number as an int; None for anything else."""
    if not isinstance(value, (int, np.integer)) or isinstance(value, (bool, np.timedelta64)):
        return None
    return attempt(int, value)


def _is_masked(value: Any) -> bool:
    """Return whether a value is a masked array, or a list or tuple with one in it, whose mask numpy would drop."""
    masked: Any = sys.modules.get("numpy.ma")  # imported by whoever made one
    parts = (value, *value) if type(value) in (list, tuple) else (value,)
    return masked is not None and any(isinstance(part, masked.MaskedArray) for part in parts)


def _floats(value: Any) -> NDArray[np.float64] | None:
    raw = as_array(value)
    if raw.dtype.kind == "O" and all(type(entry) in (int, float) for entry in raw.flat):
        return np.array([_as_float(entry) for entry in raw.flat]).reshape(raw.shape)
    if raw.dtype.kind not in "fiu":
        return None
    with np.errstate(all="ignore"):
        return raw.astype(np.float64, copy=False)


def _as_float(value: float) -> float:
    """Return a number as a float; a whole number beyond all floats is infinite."""
    try:
        return float(value)
    except OverflowError:
        return math.inf if value > 0 else -math.inf
