"""Functions that numba compiles, as C functions."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary

import numpy as np

from dincl.drifts.base import CompiledDrift

if TYPE_CHECKING:
    from numpy.typing import NDArray

# None for one that does not compile.
_KNOWN: WeakKeyDictionary[Any, Any] = WeakKeyDictionary()


class DispatchedDrift(CompiledDrift):
    """A function ``@numba.njit def drift(t, x)`` that returns an array of numbers (N, d)."""

    def __init__(self, drift: Any, function: Any) -> None:
        self._drift, self._function = drift, function

    def __call__(self, t: float, x: NDArray[np.float64]) -> Any:
        return self._drift(t, x)

    def pointer(self) -> tuple[int, NDArray[np.float64]]:
        return self._function.address, np.zeros(1)


def compiled(drift: Any) -> CompiledDrift | None:
    """A drift in the form that compiled runs call: itself, or a function that numba compiles; None for any other.

    A function of numba is compiled for (float, read-only array of shape (N, d)), once in its life. It must return
    an array of whole or floating-point numbers with two axes, and leave its types open; else this is None.
    """
    if isinstance(drift, CompiledDrift):
        return drift
    if "numba" not in sys.modules:  # then there is no function of it
        return None
    from dincl.compiled.dispatchers import drift_of, is_dispatcher

    if not is_dispatcher(drift):
        return None
    if drift not in _KNOWN:
        _KNOWN[drift] = drift_of(drift)
    function = _KNOWN[drift]
    return None if function is None else DispatchedDrift(drift, function)
