"""What ``minimise`` returns: the point, its multipliers, how the iteration ended, and proofs that can be recomputed."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from dincl.errors import StepFailure
from dincl.matrices import combined

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dincl.minimise.base import Minimiser
    from dincl.problem import Problem
    from dincl.rows.together import RowsTogether
    from dincl.status import Status
    from dincl.work import Work


@dataclass(frozen=True, eq=False, repr=False)
class Minimum:
    """A point x and multipliers >= 0 with, up to the residuals, grad W = J^T multipliers, g >= 0, multipliers . g = 0.

    Attributes
    ----------
    x
        Shape (N, d); after a failure the last iterate of finite numbers.
    rows, families, multipliers
        The rows that were held at the end, for each the index of its constraint in the problem, shape (m,), and its
        multiplier >= 0, shape (m,). Rows of the problem that are not among them have the multiplier zero.
    status, detail
        How the iteration ended, and the particulars in words ("" when its rule was met).
    iterations
        Steps made.
    stats
        The counted work.
    stationarity, violation, complementarity
        max |grad W - J^T multipliers|, max_k max(0, -g_k), max_k |min(multipliers_k, g_k)|, recomputed from the
        problem; infinite where they are not defined.
    """

    x: NDArray[np.float64]
    rows: RowsTogether
    families: NDArray[np.int64]
    multipliers: NDArray[np.float64]
    status: Status
    detail: str
    iterations: int
    stats: Work
    problem: Problem
    minimiser: Minimiser
    stationarity: float
    violation: float
    complementarity: float

    @property
    def residual(self) -> float:
        """The largest of the three residuals."""
        return max(self.stationarity, self.violation, self.complementarity)

    def reactions(self) -> dict[tuple[int, str], float]:
        """The multipliers > 0, by the index of their constraint in the problem and the row in words."""
        d = self.x.shape[1]
        labels = [block.label(k, d) for block in self.rows.blocks for k in range(len(block))]
        found = zip(self.families.tolist(), labels, self.multipliers.tolist(), strict=True)
        return {(family, label): multiplier for family, label, multiplier in found if multiplier > 0}

    def __repr__(self) -> str:
        how = f"{self.status.name}, {type(self.minimiser).__name__}, {self.iterations} iterations"
        return f"Minimum({how}, residual = {self.residual:.2g})"


class MinimisationFailed(RuntimeError):
    """An iteration that did not meet its rule; ``minimum`` holds its last point, with its Status."""

    def __init__(self, minimum: Minimum) -> None:
        super().__init__(f"{minimum.status.name}: {minimum.detail}")
        self.minimum = minimum


def residuals(
    problem: Problem, x: NDArray[np.float64], rows: RowsTogether, multipliers: NDArray[np.float64]
) -> tuple[float, float, float]:
    """Stationarity, violation and complementarity of x with the multipliers of some rows, all others being zero."""
    violation = problem.violation(0.0, x)
    try:
        gradient = -problem.velocity(0.0, x).ravel()
        reaction = _reaction(rows, x, multipliers)
        gaps = rows.values(x)
    except StepFailure:
        return math.inf, violation, math.inf
    both = float(np.max(np.abs(np.minimum(multipliers, gaps)), initial=0.0))
    return float(np.abs(gradient - reaction).max()), violation, both


def _reaction(rows: RowsTogether, x: NDArray[np.float64], multipliers: NDArray[np.float64]) -> NDArray[np.float64]:
    """sum_k multipliers_k grad g_k; rows without a multiplier need no gradient."""
    total = np.zeros(x.size)
    first = 0
    for block in rows.blocks:
        own = multipliers[first : first + len(block)]
        first += len(block)
        total += combined(block.take(own > 0).jacobian(x), own[own > 0])
    return total
