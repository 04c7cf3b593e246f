"""A drift that counts its evaluations, and ends a run that makes too many."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dincl.drifts.base import CompiledDrift

if TYPE_CHECKING:
    from collections.abc import Callable

    import numpy as np
    from numpy.typing import NDArray


class OutOfBudgetError(BaseException):
    """A run that cost as much as it may; like an interrupt, no scheme takes it for a failure of the drift."""


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
    """A drift that compiled runs call without Python: they say themselves how often, now and then."""

    def __init__(self, drift: CompiledDrift, is_spent: Callable[[int], bool] | None = None) -> None:
        super().__init__(drift, is_spent)
        self._compiled, self.autonomous = drift, drift.autonomous

    def pointer(self) -> tuple[int, NDArray[np.float64]]:
        return self._compiled.pointer()
