"""Checks of user input: each returns the checked value or raises InvalidModel: name, value and what is allowed."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from meanfield.errors import InvalidModel

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

# Beyond this, squares overflow.
LARGEST = 1e100
# Tolerances of the integrators: below, rounding decides; above, nothing is computed.
TIGHTEST, LOOSEST = 1e-13, 1e-1


def describe(value: Any) -> str:
    """A short form of a value for an error message."""
    if isinstance(value, np.ndarray) and value.size > 4:
        return f"an array of shape {value.shape}"
    text = repr(value)
    return text if len(text) <= 80 else text[:77] + "..."


def number(name: str, value: Any, *, positive: bool = False, least: float = -LARGEST) -> float:
    """A finite float, on request > 0 or at least a bound."""
    allowed = "a finite number" + (" > 0" if positive else f" >= {least:g}" if least > -LARGEST else "")
    try:
        checked = float(value)
    except (TypeError, ValueError):
        checked = math.nan
    is_text = isinstance(value, (str, bytes, bool, np.bool_))
    if is_text or not least <= checked <= LARGEST or (positive and checked <= 0):
        raise InvalidModel(f"{name} = {describe(value)}: must be {allowed}")
    return checked


def integer(name: str, value: Any, *, least: int, most: int | None = None) -> int:
    """An int that is at least ``least`` and at most ``most``."""
    is_integer = isinstance(value, (int, np.integer)) and not isinstance(value, bool)
    if not is_integer or value < least or (most is not None and value > most):
        allowed = f"an integer >= {least}" if most is None else f"an integer from {least} to {most}"
        raise InvalidModel(f"{name} = {describe(value)}: must be {allowed}")
    return int(value)


def array(name: str, value: ArrayLike, shape: tuple[int | None, ...]) -> NDArray[np.float64]:
    """A new read-only array of finite numbers; None in ``shape`` is any length > 0, fewer axes are not filled up."""
    allowed = "finite real numbers of shape (" + ", ".join("n" if s is None else str(s) for s in shape) + ")"
    try:
        raw = np.asarray(value)
        checked = np.array(raw, dtype=np.float64, order="C") if raw.dtype.kind in "fiu" else None
    except (TypeError, ValueError):
        checked = None
    fits = checked is not None and checked.ndim == len(shape) and checked.size > 0
    if checked is None or not fits or any(s not in (None, n) for s, n in zip(shape, checked.shape, strict=True)):
        raise InvalidModel(f"{name} = {describe(value)}: must be {allowed}")
    bad = ~(np.abs(checked) <= LARGEST)
    if bad.any():
        where = tuple(int(k) for k in np.argwhere(bad)[0])
        raise InvalidModel(f"{name} = {checked[where]} at index {where}: must be {allowed}")
    checked.flags.writeable = False
    return checked


def times(value: ArrayLike) -> NDArray[np.float64]:
    """Times to keep, >= 0 and increasing, of shape (K,); a run starts at 0 and ends at the last one."""
    t = array("t", value, (None,))
    if t[0] < 0 or (np.diff(t) <= 0).any() or t[-1] == 0:
        raise InvalidModel(f"t = {describe(t)}: must be increasing times >= 0, the last one > 0")
    return t


def tolerance(value: Any) -> float:
    """A tolerance that double precision can keep."""
    tol = number("tol", value, positive=True)
    if not TIGHTEST <= tol <= LOOSEST:
        raise InvalidModel(f"tol = {tol:g}: must be from {TIGHTEST:g} to {LOOSEST:g}")
    return tol
