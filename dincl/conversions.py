"""Numbers that a value of any kind stands for; the checks of user input refuse a value that stands for none.

One rule says which numbers are taken: what ``numpy.asarray`` makes of a value, if that loses nothing. So lists, arrays
of whole or floating-point numbers, whole numbers of any length and matrices are; masked, complex, ragged and object
arrays, text, truth values, sets and generators are not.
"""

from __future__ import annotations

import math
import sys
from decimal import Decimal
from itertools import chain
from numbers import Real
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

T = TypeVar("T")
# Numbers that numpy does not know, but float does.
FRACTIONS: tuple[type, ...] = (Real, Decimal)
# Lists in lists: no argument has as many axes.
DEEPEST = 8
REFUSED = BYTES, MASK, TOO_DEEP = (
    "bytes",
    "a masked array, whose missing entries must be filled in",
    "lists without an end",
)


def attempt(convert: Callable[[Any], T], value: Any) -> T | None:
    """Return ``convert(value)``; None if that raises, as a class of the user may. MemoryError is passed on."""
    try:
        return convert(value)
    except MemoryError:
        raise
    except Exception:  # noqa: BLE001  # whatever the value raises, it is not what was asked for
        return None


def plain(value: Any) -> NDArray[np.float64] | None:
    """``value`` as float64 numbers, which may be infinite or NaN; None if it is not real numbers.

    The array is the value itself, where that is one of float64.
    """
    if type(value) is np.ndarray and value.dtype.kind == "f" and value.dtype.itemsize == 8:
        return value.astype(np.float64, copy=False)
    return attempt(_floats, value)


# What arrays of numpy that are not real numbers hold, by the kind of their type.
KINDS = {
    "b": "truth values (bool)",
    "c": "complex numbers",
    "U": "text",
    "S": "bytes",
    "V": "records",
    "M": "dates",
    "m": "durations",
}


def because(value: Any) -> str:
    """Return why ``value`` is not real numbers, as the end of a message: ", not complex numbers"; "" if it is."""
    try:
        raw = as_array(value)
    except MemoryError:
        raise
    except TypeError as refused:
        return f", not {refused}" if str(refused) in REFUSED else ""
    except Exception:  # noqa: BLE001  # numpy makes no array of it
        return ", not lists of different lengths" if isinstance(value, (list, tuple)) else ""
    if plain(value) is not None:
        return ""
    if raw.dtype.kind in KINDS:
        return f", not {KINDS[raw.dtype.kind]}"
    kinds = sorted({type(entry).__name__ for entry in raw.flat if type(entry) not in (int, float)})
    return f", not objects of type {', '.join(kinds)}" if raw.ndim else ""


def _floats(value: Any) -> NDArray[np.float64] | None:
    raw = as_array(value)
    if raw.dtype.kind == "O" and all(type(entry) in (int, float) for entry in raw.flat):
        return np.array([_as_float(entry) for entry in raw.flat]).reshape(raw.shape)
    if raw.dtype.kind not in "fiu":
        return None
    with np.errstate(all="ignore"):
        return raw.astype(np.float64, copy=False)


def as_array(value: Any) -> NDArray[Any]:
    """The value as numpy sees it; TypeError for bytes, a mask, and lists in lists without an end."""
    if isinstance(value, (bytes, bytearray)):
        raise TypeError(BYTES)
    masked: Any = sys.modules.get("numpy.ma")  # imported by whoever made one
    level, depth = [value], 0
    while level:
        if masked is not None and any(issubclass(kind, masked.MaskedArray) for kind in set(map(type, level))):
            raise TypeError(MASK)
        lists = {id(part): part for part in level if type(part) in (list, tuple)}
        level, depth = list(chain.from_iterable(lists.values())), depth + 1
        if depth > DEEPEST + 1:
            raise TypeError(TOO_DEEP)
    return np.asarray(value)


def _as_float(value: float) -> float:
    """A number as a float; a whole number beyond all floats is infinite."""
    try:
        return float(value)
    except OverflowError:
        return math.inf if value > 0 else -math.inf


def one(value: Any) -> float:
    """A single real number as a float, a fraction or a decimal, too; NaN for anything else."""
    found = plain(value)
    if found is None and issubclass(type(value), FRACTIONS) and not isinstance(value, bool):
        fraction = attempt(float, value)
        return math.nan if fraction is None else fraction
    return math.nan if found is None or found.ndim else float(found)


def whole(value: Any) -> int | None:
    """A whole number as an int; None for anything else, and for one of the user's own class that cannot tell."""
    if not isinstance(value, (int, np.integer)) or isinstance(value, (bool, np.timedelta64)):
        return None
    return attempt(int, value)
