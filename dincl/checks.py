"""Checks of user input: each returns the checked value or raises InvalidProblem: name, value and what is allowed."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.errors import InvalidProblem

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

# Coordinates beyond this overflow when distances are squared.
LARGEST = 1e100


def bounded(x: NDArray[np.float64]) -> bool:
    """Whether all numbers are finite and at most LARGEST in magnitude; a NaN is neither above nor below."""
    return bool(x.max(initial=0.0) <= LARGEST and x.min(initial=0.0) >= -LARGEST)


def describe(value: Any) -> str:
    """A short form of a value for an error message."""
    if isinstance(value, np.ndarray) and value.size > 4:
        return f"an array of shape {value.shape}"
    text = repr(value)
    return text if len(text) <= 80 else text[:77] + "..."


def array(name: str, value: ArrayLike, allowed: str = "finite real numbers") -> NDArray[np.float64]:
    """A new array of finite numbers, none beyond LARGEST in magnitude; read-only, so that it stays as checked."""
    try:
        raw = np.asarray(value)
        checked = np.array(raw, dtype=np.float64, order="C") if raw.dtype.kind in "fiu" else None
    except (TypeError, ValueError):
        checked = None
    if checked is None:
        raise InvalidProblem(f"{name} = {describe(value)}: must be {allowed}")
    bad = ~(np.abs(checked) <= LARGEST)
    if bad.any():
        where = tuple(int(k) for k in np.argwhere(bad)[0])
        raise InvalidProblem(
            f"{name} = {checked[where]} at index {where}: must be {allowed} of magnitude at most {LARGEST:g}"
        )
    checked.flags.writeable = False
    return checked


def shaped(name: str, value: ArrayLike, shape: tuple[int | None, ...]) -> NDArray[np.float64]:
    """As ``array``, not empty and of a shape; None in ``shape`` is any length > 0, fewer axes are not filled up."""
    allowed = "finite real numbers of shape (" + ", ".join("n" if s is None else str(s) for s in shape) + ")"
    checked = array(name, value, allowed)
    fits = checked.ndim == len(shape) and checked.size > 0
    if not fits or any(s not in (None, n) for s, n in zip(shape, checked.shape, strict=True)):
        raise InvalidProblem(f"{name} = {describe(value)}: must be {allowed}")
    return checked


def number(name: str, value: Any, *, positive: bool = False, non_negative: bool = False) -> float:
    """A finite float, on request > 0 or >= 0."""
    allowed = "a finite number" + (" > 0" if positive else " >= 0" if non_negative else "")
    try:
        checked = float(value)
    except (TypeError, ValueError):
        checked = math.nan
    is_text = isinstance(value, (str, bytes, bool, np.bool_))
    if is_text or not abs(checked) <= LARGEST or (positive and checked <= 0) or (non_negative and checked < 0):
        raise InvalidProblem(f"{name} = {describe(value)}: must be {allowed}")
    return checked


def integer(name: str, value: Any, *, least: int, most: int | None = None) -> int:
    """An int that is at least ``least`` and at most ``most``."""
    is_integer = isinstance(value, (int, np.integer)) and not isinstance(value, bool)
    if not is_integer or value < least or (most is not None and value > most):
        allowed = f"an integer >= {least}" if most is None else f"an integer from {least} to {most}"
        raise InvalidProblem(f"{name} = {describe(value)}: must be {allowed}")
    return int(value)


def indices(name: str, value: ArrayLike, columns: int | None = None) -> NDArray[np.int64]:
    """Particle indices >= 0 of shape (m,), or (m, columns)."""
    allowed = "integers >= 0 of shape " + ("(m,)" if columns is None else f"(m, {columns})")
    try:
        raw = np.asarray(value)
    except ValueError:
        raw = np.asarray(None)
    if raw.size == 0 and raw.dtype.kind == "f":
        raw = np.zeros((0,) if columns is None else (0, columns), dtype=np.int64)
    shaped = raw.ndim == 1 if columns is None else raw.ndim == 2 and raw.shape[1] == columns
    if not shaped or raw.dtype.kind not in "iu" or (raw < 0).any():
        raise InvalidProblem(f"{name} = {describe(value)}: must be {allowed}")
    checked = raw.astype(np.int64)
    checked.flags.writeable = False
    return checked


def lengths(name: str, value: ArrayLike, *, positive: bool) -> NDArray[np.float64]:
    """One length or a list of them, shape () or (m,), all > 0 or all >= 0."""
    allowed = "one length or a list of lengths, " + ("> 0" if positive else ">= 0")
    checked = array(name, value, allowed)
    if checked.ndim > 1 or (checked < 0).any() or (positive and (checked == 0).any()):
        raise InvalidProblem(f"{name} = {describe(value)}: must be {allowed}")
    return checked


def spread(name: str, value: NDArray[np.float64], count: int, per: str) -> NDArray[np.float64]:
    """Lengths of shape () or (count,) as an array of shape (count,)."""
    if value.ndim == 1 and len(value) != count:
        raise InvalidProblem(f"{name} has {len(value)} entries: must have one, or one for each of the {count} {per}")
    return np.ascontiguousarray(np.broadcast_to(value, (count,)))


def within(name: str, index: NDArray[np.int64], count: int) -> None:
    """Indices that exist: all below ``count``."""
    if index.size and index.max() >= count:
        raise InvalidProblem(
            f"{name} = {int(index.max())}: must be an index below the number of particles, here {count}"
        )


def vector(name: str, value: NDArray[np.float64], d: int) -> None:
    """A vector of the problem's dimension."""
    if value.shape != (d,):
        raise InvalidProblem(f"{name} of shape {value.shape}: must have shape ({d},), as the particles have d = {d}")
