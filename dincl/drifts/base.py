"""Drifts in machine code, functions of numba as such drifts, and drifts that count their evaluations."""

from __future__ import annotations

import sys
from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary

import numpy as np

if TYPE_CHECKING:
    from dincl.compiled.arrays import Floats


class CompiledDrift(ABC):
    """A drift F that compiled runs call as a C function, and that others call as an ordinary function.

    Both forms give the same numbers, and fail at the same states.

    Attributes
    ----------
    autonomous
        Whether F is known not to depend on t.
    """

    autonomous: bool = False

    @abstractmethod
    def __call__(self, t: float, x: Floats) -> Any:
        """Compute F(t, x), (N, d) -> (N, d) [length / time]."""

    @abstractmethod
    def pointer(self) -> tuple[int, Floats]:
        """Return the address of F as a C function, and its data; both live as long as the drift.

        ``int64 f(double t, double *x, double *out, int64 n, int64 d, double *data)`` writes F(t, x) to out and returns
        0, or another number if it fails; the ordinary form is then called for the reason. The data are float64 numbers,
        at least one.
        """

    def check(self, count: int, d: int) -> None:  # noqa: B027  # most drifts take any shape
        """Raise InvalidProblem if this drift does not fit ``count`` particles in d dimensions."""

    def count_evaluations(self, number: int) -> None:  # noqa: B027  # for drifts that count
        """Take note of so many more evaluations by a compiled run; an exception ends the run."""


class DispatchedDrift(CompiledDrift):
    """A function ``@numba.njit def drift(t, x)`` that returns an array of numbers (N, d)."""

    def __init__(self, drift: Any, function: Any) -> None:
        self._drift, self._function = drift, function

    def __call__(self, t: float, x: Floats) -> Any:
        return self._drift(t, x)

    def pointer(self) -> tuple[int, Floats]:
        return self._function.address, np.zeros(1)


# C functions of numba's functions; None for a function that does not compile.
_C_FUNCTIONS: WeakKeyDictionary[Any, Any] = WeakKeyDictionary()


def compiled(drift: Any) -> CompiledDrift | None:
    """Return a drift in the form that compiled runs call: itself, or a function of numba; None for any other.

    A function of numba is compiled for (float, read-only array of shape (N, d)), once. It must return an array of whole
    or floating-point numbers with two axes, and must not fix its types; else this returns None.
    """
    if isinstance(drift, CompiledDrift):
        return drift
    if "numba" not in sys.modules:  # then there are no functions of numba
        return None
    from dincl.compiled.calls import compile_drift, is_dispatcher

    if not is_dispatcher(drift):
        return None
    if drift not in _C_FUNCTIONS:
        _C_FUNCTIONS[drift] = compile_drift(drift)
    function = _C_FUNCTIONS[drift]
    return None if function is None else DispatchedDrift(drift, function)


class OutOfBudgetError(BaseException):
    """End of a run that spent its budget; a BaseException, so that no scheme takes it for a failure of the drift."""


class CountedDrift:
    """A drift with the number of its ``evaluations``; it raises OutOfBudgetError once ``is_spent(evaluations)``."""

    def __init__(self, drift: Any, is_spent: Callable[[int], bool] | None = None) -> None:
        self._drift, self._is_spent = drift, is_spent
        self.evaluations = 0

    def __call__(self, t: float, x: Any) -> Any:
        self.count_evaluations(1)
        return self._drift(t, x)

    def count_evaluations(self, number: int) -> None:
        """Count so many evaluations."""
        self.evaluations += number
        if self._is_spent is not None and self._is_spent(self.evaluations):
            raise OutOfBudgetError


class CountedCompiledDrift(CountedDrift, CompiledDrift):
    """The same for a compiled drift, whose evaluations compiled runs report now and then."""

    def __init__(self, drift: CompiledDrift, is_spent: Callable[[int], bool] | None = None) -> None:
        super().__init__(drift, is_spent)
        self._compiled, self.autonomous = drift, drift.autonomous

    def pointer(self) -> tuple[int, Floats]:
        return self._compiled.pointer()
