"""A fixed choice of rows of a problem, at any time and state."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from dincl.constraints.rows import RowsTogether

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dincl.constraints.base import Constraint
    from dincl.constraints.rows import RowsOfOneKind
    from dincl.csr import Csr
    from dincl.problem import Problem

# Central and one-sided differences of order 6 for the first derivative.
CENTRAL = np.array([-1, 9, -45, 0, 45, -9, 1]) / 60
FORWARD = np.array([-147, 360, -450, 400, -225, 72, -10]) / 60

Name = tuple[int, str]


@dataclass(frozen=True, eq=False)
class ContactRows:
    """m rows of a problem, in the order of its families.

    Attributes
    ----------
    problem
        Where they come from.
    blocks
        The rows of each family, for its set at rest.
    spacing
        Of the differences that give the velocity of a moving set [time].
    """

    problem: Problem
    blocks: tuple[RowsOfOneKind, ...]
    spacing: float

    def take(self, keep: NDArray[np.bool_]) -> ContactRows:
        """The rows where ``keep`` (m,) is true."""
        starts = np.cumsum([0, *(len(block) for block in self.blocks)])
        chosen = [block.take(keep[start:][: len(block)]) for block, start in zip(self.blocks, starts, strict=False)]
        return ContactRows(self.problem, tuple(chosen), self.spacing)

    @cached_property
    def names(self) -> tuple[Name, ...]:
        """For each row the index of its family, and the row in words."""
        d = self.problem.x0.shape[1]
        return tuple((family, block.label(k, d)) for family, block in enumerate(self.blocks) for k in range(len(block)))

    def values(self, t: float, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """g(t, x), shape (m,)."""
        return self._rows(t).values(x)

    def gradients(self, t: float, x: NDArray[np.float64]) -> tuple[Csr, NDArray[np.float64], NDArray[np.float64]]:
        """Unit gradients (m, N d), the lengths that they had (m,), and the least speeds along them, b (m,).

        A contact is kept where the velocity v has n_k . v >= b_k; b is zero for sets at rest. A gradient that vanishes
        stays as it is, with length 1.
        """
        matrix = self._rows(t).jacobian(x)
        length = np.sqrt(matrix.norms_squared())
        length[length == 0] = 1.0
        unit = matrix._replace(data=matrix.data / length[matrix.row_of_entry])
        return unit, length, self._least_speeds(t, unit)

    def _least_speeds(self, t: float, unit: Csr) -> NDArray[np.float64]:
        least = np.zeros(unit.rows)
        count, d = self.problem.x0.shape
        start = 0
        for family, block in zip(self.problem.constraints, self.blocks, strict=True):
            mine = slice(start, start + len(block))
            start += len(block)
            if len(block) and family.displacement(t, d) is not None:
                least[mine] = unit.times(np.tile(self._set_velocity(t, family), count))[mine]
        return least

    def _set_velocity(self, t: float, family: Constraint) -> NDArray[np.float64]:
        """The derivative of the displacement, without looking at negative times."""
        d = self.problem.x0.shape[1]
        first, weights = (-3, CENTRAL) if t >= 3 * self.spacing else (0, FORWARD)
        times = [t + (first + k) * self.spacing for k in range(len(weights))]
        places = [family.displacement(time, d) for time in times]
        found: NDArray[np.float64] = weights @ np.array(places) / self.spacing
        return found

    def carried(self, start: float, end: float) -> float:
        """How far the farthest of the sets is carried between two times [length]."""
        d = self.problem.x0.shape[1]
        moves = [0.0]
        for family in self.problem.constraints:
            before, after = family.displacement(start, d), family.displacement(end, d)
            if before is not None and after is not None:
                moves.append(float(np.sqrt(((after - before) ** 2).sum())))
        return max(moves)

    def _rows(self, t: float) -> RowsTogether:
        d = self.problem.x0.shape[1]
        shifts = [family.displacement(t, d) for family in self.problem.constraints]
        moved = [
            block if shift is None else block.shifted(shift) for block, shift in zip(self.blocks, shifts, strict=True)
        ]
        return RowsTogether(tuple(moved), self.problem.x0.size)


def near(problem: Problem, t: float, x: NDArray[np.float64], reach: float, spacing: float) -> ContactRows:
    """All rows that can be violated at time t after every particle moved by at most ``reach`` from x."""
    blocks = []
    for family in problem.constraints:
        shift = family.displacement(t, x.shape[1])
        blocks.append(family.select(x if shift is None else x - shift, reach))
    return ContactRows(problem, tuple(blocks), spacing)
