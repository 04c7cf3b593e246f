"""The rows that may be in contact, with unit gradients and the speeds of their sets."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from dincl.constraints.selection import select
from dincl.matrices import divided, row_squares

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.sparse import csr_array

    from dincl.constraints.selection import Name, Selection
    from dincl.problem import Problem


@dataclass(frozen=True, eq=False)
class ContactRows:
    """m rows of a problem, in the order of its constraints; ``spacing`` is that of differences of paths [time]."""

    problem: Problem
    rows: Selection
    spacing: float

    def __len__(self) -> int:
        return len(self.rows)

    def take(self, keep: NDArray[np.bool_]) -> ContactRows:
        """The rows where ``keep`` (m,) is true."""
        return ContactRows(self.problem, self.rows.take(keep), self.spacing)

    @property
    def names(self) -> tuple[Name, ...]:
        """For each row the index of its constraint, and the row in words."""
        return self.rows.names

    def values(self, t: float, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """g(t, x), shape (m,)."""
        return self.rows.at(t).values(x)

    def gradients(self, t: float, x: NDArray[np.float64]) -> tuple[csr_array, NDArray[np.float64], NDArray[np.float64]]:
        """Unit gradients (m, N d), the lengths that they had (m,), and the least speeds along them, b (m,).

        A contact is kept where the velocity v has n_k . v >= b_k. A gradient that vanishes keeps its length.
        """
        matrix = self.rows.at(t).jacobian(x)
        length = np.sqrt(row_squares(matrix))
        length[length == 0] = 1.0
        unit = divided(matrix, length)
        return unit, length, self.rows.least_speeds(t, x, unit, self.spacing)

    def largest_change(self, start: float, end: float, x: NDArray[np.float64]) -> float:
        """The largest change of a set between two times [length]."""
        return self.rows.largest_change(start, end, x, 0.0)


def near(problem: Problem, t: float, x: NDArray[np.float64], distance: float, spacing: float) -> ContactRows:
    """All rows that can be violated at time t after each particle moved at most a distance from x."""
    return ContactRows(problem, select(problem.constraints, t, x, distance), spacing)
