r"""The rows of an iteration with their multipliers, which stay with a row while the list of near rows changes.

Where distances are taken squared, a row g = sign (|X_i - X_j| - L) is replaced by sign (|X_i - X_j|^2 - L^2), which is
>= 0 just where g is. The gradient is 2 |X_i - X_j| times as long; the multipliers of g are that many times larger.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, TypeVar

import numpy as np

from dincl.checks import bounded
from dincl.constants import LARGEST
from dincl.constraints.near import Near, row_names
from dincl.errors import StepFailure
from dincl.matrices import combined, stacked
from dincl.status import Status

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray
    from scipy.sparse import csr_array

    from dincl.problem import Problem
    from dincl.rows.base import RowsOfOneKind
    from dincl.work import Work


Numbers = TypeVar("Numbers", bound=np.generic)


class Point(NamedTuple):
    """An iterate with everything that its step and its residual need.

    ``gaps`` (m,) are the g of the package, ``values`` those of the iteration, ``steep`` the ratio of their gradients;
    ``multipliers`` belong to ``values``; ``matrix`` has the gradients of the rows where ``active``: multiplier > 0.
    """

    x: NDArray[np.float64]
    gradient: NDArray[np.float64]
    gaps: NDArray[np.float64]
    values: NDArray[np.float64]
    steep: NDArray[np.float64]
    multipliers: NDArray[np.float64]
    active: NDArray[np.bool_]
    matrix: csr_array

    def pull(self, weights: NDArray[np.float64]) -> NDArray[np.float64]:
        """sum_k weights_k grad g_k over the active rows, shape (N, d)."""
        return combined(self.matrix, weights[self.active]).reshape(self.x.shape)

    def residual(self) -> float:
        """The largest of the residuals that ``Minimum`` has."""
        slope = float(np.abs(self.gradient - self.pull(self.multipliers)).max())
        both = np.minimum(self.steep * self.multipliers, self.gaps)
        return max(slope, float(np.max(-self.gaps, initial=0.0)), float(np.max(np.abs(both), initial=0.0)))


class IterationRows:
    """Rows near the iterate, and rows that are no longer near but still have a multiplier; all others have zero.

    ``ahead`` is for how many moves of the present length a list of near rows is made.
    """

    def __init__(self, problem: Problem, work: Work, *, squared: bool, ahead: float) -> None:
        self._near = Near(problem.constraints, work)
        self._size = problem.x0.size
        self._squared = squared
        self._ahead = ahead
        families = len(problem.constraints)
        # For each constraint its near rows and, after them, its rows left over from earlier lists.
        self._lists: list[tuple[RowsOfOneKind, ...]] = [()] * families
        self._kept: list[NDArray[np.float64]] = [np.zeros(0)] * families

    @property
    def blocks(self) -> list[RowsOfOneKind]:
        """All rows, block after block."""
        return [block for family in self._lists for block in family]

    @property
    def families(self) -> NDArray[np.int64]:
        """For each row the index of its constraint, shape (m,)."""
        return np.repeat(np.arange(len(self._kept)), [len(kept) for kept in self._kept])

    @property
    def multipliers(self) -> NDArray[np.float64]:
        """One for each row, >= 0, shape (m,)."""
        return np.concatenate([np.zeros(0), *self._kept])

    def set(self, multipliers: NDArray[np.float64]) -> None:
        """Take new multipliers, in the order of the rows."""
        if not bounded(multipliers):
            raise StepFailure(Status.NON_FINITE, f"A multiplier is beyond {LARGEST:g}.")
        self._kept = parts(multipliers, [len(kept) for kept in self._kept])

    def update(self, x: NDArray[np.float64], move: float) -> None:
        """Hold every row that is violated at x (N, d); the last step moved a particle by at most ``move``."""
        for k, near in enumerate(self._near.rows(0.0, x, self._ahead * move).blocks):
            if not self._lists[k] or self._lists[k][0] is not near:
                self._lists[k], self._kept[k] = left_over(near, self._lists[k], self._kept[k])

    def gaps(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """g(x) of the package, shape (m,)."""
        return np.concatenate([np.zeros(0), *(block.values(x) for block in self.blocks)])

    def point(self, x: NDArray[np.float64], gradient: NDArray[np.float64]) -> Point:
        """All that belongs to x, where the rows have been updated."""
        multipliers = self.multipliers
        active = multipliers > 0
        gaps, steep = self.gaps(x), self.steepness(x)
        matrix = self.gradients(self.take(active), x)
        return Point(x, gradient, gaps, self.taken(gaps, steep), steep, multipliers, active, matrix)

    def values(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """The values that the iteration works with, shape (m,)."""
        return self.taken(self.gaps(x), self.steepness(x))

    def taken(self, gaps: NDArray[np.float64], steep: NDArray[np.float64]) -> NDArray[np.float64]:
        """The same from g and the steepness."""
        if not self._squared:
            return gaps
        sizes = [len(block) for block in self.blocks]
        each = zip(self.blocks, parts(gaps, sizes), parts(steep, sizes), strict=True)
        return np.concatenate([np.zeros(0), *(block.squared_values(own, length) for block, own, length in each)])

    def steepness(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """By how much the gradients of these values are longer than those of g, shape (m,)."""
        if not self._squared:
            return np.ones(sum(len(block) for block in self.blocks))
        return np.concatenate([np.zeros(0), *(block.squared_steepness(x) for block in self.blocks)])

    def take(self, keep: NDArray[np.bool_]) -> list[RowsOfOneKind]:
        """The rows where ``keep`` is true, block after block."""
        kept = zip(self.blocks, parts(keep, [len(block) for block in self.blocks]), strict=True)
        return [block.take(part) for block, part in kept if part.any()]

    def gradients(self, blocks: list[RowsOfOneKind], x: NDArray[np.float64]) -> csr_array:
        """The Jacobian of some of the rows at x, in the form that the iteration works with."""
        found = [block.squared_jacobian(x) if self._squared else block.jacobian(x) for block in blocks]
        return stacked(found, self._size)


def parts(values: NDArray[Numbers], sizes: Sequence[int]) -> list[NDArray[Numbers]]:
    """Consecutive parts of these sizes."""
    ends = np.cumsum(sizes)
    return [values[end - size : end] for end, size in zip(ends, sizes, strict=True)]


def left_over(
    near: RowsOfOneKind, before: Sequence[RowsOfOneKind], multipliers: NDArray[np.float64]
) -> tuple[tuple[RowsOfOneKind, ...], NDArray[np.float64]]:
    """The rows ``near``, then those of ``before`` that have a multiplier and are not near; and the multipliers of all.

    ``multipliers`` (m,) belong to the rows ``before``, block after block.
    """
    carried = np.zeros(len(near))
    names = row_names(near)
    kept, kept_multipliers = [], []
    first = 0
    for block in before:
        own = multipliers[first : first + len(block)]
        first += len(block)
        held = block.take(own > 0)
        own = own[own > 0]
        _, here, there = np.intersect1d(row_names(held), names, return_indices=True)
        carried[there] = own[here]
        missing = np.ones(len(own), dtype=bool)
        missing[here] = False
        if missing.any():
            kept.append(held.take(missing))
            kept_multipliers.append(own[missing])
    return (near, *kept), np.concatenate((carried, *kept_multipliers))
