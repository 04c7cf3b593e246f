"""Catch-up with compiled steps."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dincl.kernels.catch_up import EXACT, LINEARISED, MIDPOINT, advance
from dincl.run.compiled import CompiledStepper

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from dincl.kernels.system import Steps
    from dincl.problem import Problem

__all__ = ["EXACT", "LINEARISED", "MIDPOINT", "CompiledCatchUp"]


class CompiledCatchUp(CompiledStepper):
    """LINEARISED, EXACT or MIDPOINT catch-up with projections by the active set, to the residual ``tol``."""

    def __init__(self, problem: Problem, method: int, tol: float) -> None:
        super().__init__(problem)
        self._method, self._tol = method, tol

    def call(self, steps: Steps, x: NDArray[np.float64], v: NDArray[np.float64]) -> tuple[int, int]:
        return advance(self.system.place, self._method, steps, x, self._tol)

    def fail(self, code: int) -> None:
        self.system.failure(code, self._tol)
