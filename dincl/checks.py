"""Checks of user input: each returns the checked value or raises InvalidProblem: name, value and what is allowed.

Numbers are what ``numpy.asarray`` makes of a value, if that loses nothing: lists, arrays of whole or floating-point
numbers, matrices; no masked, complex, ragged or object arrays, text, truth values, sets, generators. Whatever a value
raises while it is looked at, it is refused.
"""

from __future__ import annotations

import math
import os
import re
import sys
from collections.abc import Callable, Sequence
from numbers import Real
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dincl.constants import LARGEST, LARGEST_INTEGER, SMALLEST
from dincl.errors import InvalidProblem

Floats = NDArray[np.float64]

T = TypeVar("T")

# Longest text [characters] and list [entries] that messages write out.
LONGEST_TEXT, LONGEST_LIST = 80, 100


def attempt(convert: Callable[[Any], T], value: Any) -> T | None:
    """Return ``convert(value)``; None if that raises, as a class of the user may. MemoryError is passed on."""
    try:
        return convert(value)
    except MemoryError:
        raise
    except Exception:  # noqa: BLE001  # whatever the value raises, it is not what was asked for
        return None


def plain(value: Any) -> Floats | None:
    """Return ``value`` as float64 numbers, which may be infinite or NaN; None if it is not real numbers.

    An array of float64 is returned as it is.
    """
    if type(value) is np.ndarray and value.dtype.kind == "f" and value.dtype.itemsize == 8:
        return value.astype(np.float64, copy=False)
    if type(value) is float:
        return np.array(value)
    raw = attempt(as_array, value)
    if raw is None or raw.dtype.kind not in "fiu":
        return None
    with np.errstate(all="ignore"):
        return raw.astype(np.float64, copy=False)


def as_array(value: Any) -> NDArray[Any]:
    """Return the value as numpy sees it; TypeError for bytes and masked arrays, also in a list, whose mask would go."""
    masked: Any = sys.modules.get("numpy.ma")  # imported by whoever made one
    parts = (value, *value) if type(value) in (list, tuple) else (value,)
    if isinstance(value, (bytes, bytearray)) or (
        masked and any(isinstance(part, masked.MaskedArray) for part in parts)
    ):
        raise TypeError
    return np.asarray(value)


def _one(value: Any) -> float:
    """Return a single real number as a float, a fraction or a long whole number, too; NaN for anything else."""
    found = plain(value)
    if found is None and not isinstance(value, bool) and isinstance(value, Real):
        found = attempt(lambda given: np.array(float(given)), value)
    return math.nan if found is None or found.ndim else float(found)


def _whole(value: Any) -> int | None:
    """Return a whole number as an int; None for anything else."""
    if not isinstance(value, (int, np.integer)) or isinstance(value, (bool, np.timedelta64)):
        return None
    return attempt(int, value)


def bounded(x: Floats) -> bool:
    """Return whether all numbers are finite and at most LARGEST in magnitude; a NaN is neither above nor below."""
    return bool(x.max(initial=0.0) <= LARGEST and x.min(initial=0.0) >= -LARGEST)


def describe(value: Any) -> str:
    """Write a short form of a value for an error message, whatever it is."""
    if isinstance(value, np.ndarray) and value.size > 4:
        return f"an array of shape {value.shape}"
    if type(value) in (list, tuple, set, frozenset, dict) and len(value) > LONGEST_LIST:
        return f"a {type(value).__name__} of {len(value)} entries"
    if type(value) is int and value.bit_length() > 256:
        return f"an integer of {value.bit_length()} bits"
    try:
        text = str(repr(value))
    except Exception:  # noqa: BLE001  # of the user's own class, or of a list that holds itself
        return f"an object of type {type(value).__name__}"
    text = " ".join(text.split()) if "\n" in text else text
    return text if len(text) <= LONGEST_TEXT else text[: LONGEST_TEXT - 3] + "..."


def array(name: str, value: ArrayLike, allowed: str = "finite real numbers") -> Floats:
    """Return a new read-only array of finite numbers, none beyond LARGEST in magnitude."""
    found = plain(value)
    if found is None:
        raise InvalidProblem(f"{name} = {describe(value)}: must be {allowed}")
    checked = np.array(found, order="C", subok=False)
    bad = ~(np.abs(checked) <= LARGEST)
    if bad.any():
        where = tuple(int(k) for k in np.argwhere(bad)[0])
        raise InvalidProblem(
            f"{name} = {checked[where]} at index {where}: must be {allowed} of magnitude at most {LARGEST:g}"
        )
    checked.flags.writeable = False
    return checked


def shape_in_words(shape: Sequence[int | str | None]) -> str:
    """Write a shape for a message: (n, 2). Lengths that may differ have different letters."""
    letters = iter("nmkl")
    words = [next(letters) if s is None else str(s) for s in shape]
    return f"({', '.join(words)}{',' if len(words) == 1 else ''})"


def shaped(name: str, value: ArrayLike, shape: tuple[int | str | None, ...]) -> Floats:
    """Return an ``array`` of a shape, not empty; None or a name in it is any length > 0."""
    allowed = f"finite real numbers of shape {shape_in_words(shape)}"
    checked = array(name, value, allowed)
    fits = checked.ndim == len(shape) and checked.size > 0
    if not fits or any(isinstance(s, int) and s != n for s, n in zip(shape, checked.shape, strict=True)):
        raise InvalidProblem(f"{name} = {describe(value)}: must be {allowed}, not {shape_in_words(checked.shape)}")
    return checked


def times(name: str, value: ArrayLike, start: float = 0.0) -> Floats:
    """Return output times (K,), K >= 1, from one number or a list: >= ``start`` and increasing."""
    checked = np.atleast_1d(array(name, value))
    if checked.ndim != 1 or checked.size == 0 or checked[0] < start or (np.diff(checked) <= 0).any():
        raise InvalidProblem(f"{name} = {describe(value)}: must be one or more increasing times >= {start:.10g}")
    return checked


def number(name: str, value: Any, *, positive: bool = False, non_negative: bool = False) -> float:
    """Return a finite float, on request > 0, and then at least SMALLEST, or >= 0."""
    allowed = "a finite number" + (" > 0" if positive else " >= 0" if non_negative else "")
    checked = value if type(value) is float else _one(value)
    if not abs(checked) <= LARGEST or (positive and checked < SMALLEST) or (non_negative and checked < 0):
        allowed += f", at least {SMALLEST:g}" if positive and checked > 0 else ""
        allowed += f", at most {LARGEST:g}" if abs(checked) > LARGEST else ""
        raise InvalidProblem(f"{name} = {describe(value)}: must be {allowed}")
    return checked


def integer(name: str, value: Any, *, least: int, most: int | None = None) -> int:
    """Return an int that is at least ``least`` and at most ``most``; None: at most what fits into 64 bits."""
    checked = _whole(value)
    if checked is None or not least <= checked <= (LARGEST_INTEGER if most is None else most):
        allowed = f"an integer >= {least}" if most is None else f"an integer from {least} to {most}"
        if most is None and checked is not None and checked > LARGEST_INTEGER:
            allowed += f" and at most {LARGEST_INTEGER}"
        raise InvalidProblem(f"{name} = {describe(value)}: must be {allowed}")
    return checked


def seed(name: str, value: Any) -> int:
    """Return an int >= 0 of any size, as the generators of numpy take it."""
    checked = _whole(value)
    if checked is None or checked < 0:
        raise InvalidProblem(f"{name} = {describe(value)}: must be an integer >= 0")
    return checked


def flag(name: str, value: Any) -> bool:
    """Return True or False; nothing that counts as one of them is taken."""
    if not isinstance(value, (bool, np.bool_)):
        raise InvalidProblem(f"{name} = {describe(value)}: must be True or False")
    return bool(value)


def text(name: str, value: Any, choices: tuple[str, ...]) -> str:
    """Return one of some words."""
    found = str.__str__(value) if isinstance(value, str) else None
    if found not in choices:
        raise InvalidProblem(f"{name} = {describe(value)}: must be one of {', '.join(map(repr, choices))}")
    return found


def string(name: str, value: Any, form: re.Pattern[str] | None = None, allowed: str = "text") -> str:
    """Return any text, or one of a form, which ``allowed`` says in words."""
    found = str.__str__(value) if isinstance(value, str) else None
    if found is None or (form is not None and not form.fullmatch(found)):
        raise InvalidProblem(f"{name} = {describe(value)}: must be {allowed}")
    return found


def path(name: str, value: Any) -> Path:
    """Return the path of a file or a folder, which need not be there."""
    found = attempt(lambda given: Path(given) if isinstance(given, (str, os.PathLike)) else None, value)
    if found is None or "\0" in str(found):
        raise InvalidProblem(f"{name} = {describe(value)}: must be the path of a file or a folder")
    return found


def function(name: str, value: Any, allowed: str) -> Callable[..., Any]:
    """Return something to call; ``allowed`` says with what."""
    if not callable(value):
        raise InvalidProblem(f"{name} = {describe(value)}: must be {allowed}")
    checked: Callable[..., Any] = value
    return checked


def instance(name: str, value: Any, kind: type[Any], allowed: str) -> Any:
    """Return a value of a class; ``allowed`` says which: "a dincl.Problem"."""
    if not isinstance(value, kind):
        raise InvalidProblem(f"{name} = {describe(value)}: must be {allowed}")
    return value


def generator(name: str, value: Any) -> np.random.Generator:
    """Return a random generator of numpy."""
    checked: np.random.Generator = instance(name, value, np.random.Generator, "a numpy.random.Generator")
    return checked


def items(name: str, value: Any, kind: type[Any] | tuple[type[Any], ...], allowed: str) -> tuple[Any, ...]:
    """Return the entries of a list, all of one class; ``allowed`` says which: "a list of constraints".

    A list has an order and a length: no set, mapping or generator, which may never end.
    """
    listed = isinstance(value, (Sequence, np.ndarray)) and not isinstance(value, (str, bytes, bytearray, memoryview))
    found = attempt(tuple, value) if listed else None
    if found is None or not all(isinstance(entry, kind) for entry in found):
        raise InvalidProblem(f"{name} = {describe(value)}: must be {allowed}")
    return found


def indices(name: str, value: ArrayLike, columns: int | None = None, *, distinct: bool = False) -> NDArray[np.int64]:
    """Return particle indices >= 0 of shape (m,), or (m, columns); each at most once if ``distinct``."""
    allowed = "integers >= 0 of shape " + ("(m,)" if columns is None else f"(m, {columns})")
    found = attempt(as_array, value)
    raw = np.asarray(None) if found is None else found
    if raw.size == 0 and raw.dtype.kind == "f":
        raw = np.zeros((0,) if columns is None else (0, columns), dtype=np.int64)
    shaped = raw.ndim == 1 if columns is None else raw.ndim == 2 and raw.shape[1] == columns
    if not shaped or raw.dtype.kind not in "iu" or (raw < 0).any() or (raw > LARGEST_INTEGER).any():
        raise InvalidProblem(f"{name} = {describe(value)}: must be {allowed}")
    if distinct and len(np.unique(raw)) != raw.size:
        raise InvalidProblem(f"{name} = {describe(value)}: must name each particle at most once")
    checked = raw.astype(np.int64)
    checked.flags.writeable = False
    return checked


def lengths(name: str, value: ArrayLike, *, positive: bool, of: str = "length") -> Floats:
    """Return one length or a list of them, shape () or (m,), all > 0 or all >= 0; none but 0 is below SMALLEST."""
    allowed = f"one {of} or a list of {of}s, " + ("> 0" if positive else ">= 0")
    checked = array(name, value, allowed)
    vanishing = (checked > 0) & (checked < SMALLEST)
    if checked.ndim > 1 or (checked < 0).any() or (positive and (checked == 0).any()) or vanishing.any():
        allowed += f", and at least {SMALLEST:g}" if vanishing.any() else ""
        raise InvalidProblem(f"{name} = {describe(value)}: must be {allowed}")
    return checked


def spread(name: str, value: Floats, count: int, per: str) -> Floats:
    """Return lengths of shape () or (count,) as an array of shape (count,)."""
    if value.ndim == 1 and len(value) != count:
        raise InvalidProblem(f"{name} has {len(value)} entries: must have one, or one for each of the {count} {per}")
    return np.ascontiguousarray(np.broadcast_to(value, (count,)))


def within(name: str, index: NDArray[np.int64], count: int) -> None:
    """Refuse indices of particles that do not exist, ``count`` and above."""
    if index.size and index.max() >= count:
        raise InvalidProblem(
            f"{name} = {int(index.max())}: must be an index below the number of particles, here {count}"
        )


def vector(name: str, value: Floats, d: int) -> None:
    """Refuse a vector that has not the problem's dimension."""
    if value.shape != (d,):
        raise InvalidProblem(f"{name} of shape {value.shape}: must have shape ({d},), as the particles have d = {d}")
