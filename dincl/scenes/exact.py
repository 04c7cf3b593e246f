"""Exact solutions, evaluated to 30 digits and rounded once."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.checks import array, number

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

# Decimal digits of the evaluation, where mpmath is not set to more.
DIGITS = 30


class Exact(ABC):
    """t -> x(t) for a scene; ``exact(t)`` in float64, ``exact.digits(t)`` with all digits."""

    def __call__(self, t: ArrayLike) -> NDArray[np.float64]:
        """x(t), shape (N, d) for one time and (K, N, d) for K of them; InvalidProblem unless all t are finite, >= 0."""
        times = array("t", t)
        states = [self.digits(float(time)).astype(np.float64) for time in times.flat]
        return np.array(states).reshape(*times.shape, *self._shape)

    def digits(self, t: Any) -> NDArray[np.object_]:
        """x(t) for one float or mpf t, shape (N, d), entries mpf of 30 digits, or of mpmath's precision if higher."""
        number("t", t, non_negative=True)
        import mpmath

        with mpmath.workdps(max(DIGITS, mpmath.mp.dps)):
            return np.array(self._at(mpmath.mpf(t)), dtype=object).reshape(self._shape)

    @property
    @abstractmethod
    def _shape(self) -> tuple[int, int]:
        """(N, d)."""

    @abstractmethod
    def _at(self, t: Any) -> list[Any]:
        """x(t) for an mpf t >= 0 at mpmath's working precision, N*d entries in any nesting."""
