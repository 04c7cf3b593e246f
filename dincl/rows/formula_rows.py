"""Rows of a compiled formula: a kind of row of your own, as fast as those of the package."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.errors import StepFailure
from dincl.matrices import from_equal_rows
from dincl.rows.base import RowsOfOneKind, TableRows
from dincl.status import Status

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.sparse import csr_array

# For keys of rows: of up to four particles, they are told apart among so many.
MOST_PARTICLES = 1_000_003


@dataclass(frozen=True, eq=False)
class FormulaRows(RowsOfOneKind):
    """g_k(X_i, X_j, ...) >= 0 for the particles of each row, by one formula.

    Parameters
    ----------
    formula
        Made by ``dincl.rows.formulas.row_formula``.
    particles
        Those of each row, shape (m, p).
    parameters
        Those of each row, shape (m, q), q <= p d.
    rate
        How fast g changes at most while no particle moves faster than 1: rows with a larger g than this times the reach
        are left out. Without it, all rows are looked at.
    """

    formula: Any
    particles: NDArray[np.int64]
    parameters: NDArray[np.float64]
    rate: float = np.inf
    shift: NDArray[np.float64] | float = 0.0

    def __len__(self) -> int:
        return len(self.particles)

    def values(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        return self._evaluated(x)[:, -1]

    def jacobian(self, x: NDArray[np.float64]) -> csr_array:
        return from_equal_rows(self._columns(x.shape[1]), self._evaluated(x)[:, :-1], x.size)

    def take(self, keep: NDArray[np.bool_]) -> FormulaRows:
        return replace(self, particles=self.particles[keep], parameters=self.parameters[keep])

    def shifted(self, displacement: NDArray[np.float64]) -> FormulaRows:
        return replace(self, shift=self.shift + displacement)

    def keys(self) -> NDArray[np.int64]:
        """Two numbers, each with half of the particles as its digits."""
        halves = np.array_split(self.particles, 2, axis=1)
        return np.column_stack([half @ MOST_PARTICLES ** np.arange(half.shape[1]) for half in halves])

    def label(self, k: int, d: int) -> str:
        return "particles " + ", ".join(map(str, self.particles[k]))

    def coincidence(self, k: int) -> StepFailure:
        """Why row k has no direction."""
        return StepFailure(Status.CONSTRAINT_FAILED, f"g has no derivative at {self.label(k, 0)}.")

    def tabulated(self, d: int) -> TableRows:
        from dincl.rows.table import FORMULA

        column = self._columns(d)
        coefficient = np.zeros(column.shape)
        coefficient[:, : self.parameters.shape[1]] = self.parameters
        numbers = {"kind": FORMULA, "i": -1, "j": -1, "sway": self.rate, "formula": self.formula.address}
        return TableRows(numbers, np.full(len(self), column.shape[1]), column.ravel(), coefficient.ravel())

    def _columns(self, d: int) -> NDArray[np.int64]:
        """The coordinates of each row, shape (m, p d)."""
        return (d * self.particles[:, :, None] + np.arange(d)).reshape(len(self), -1)

    def _evaluated(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """dg/dx and, last, g, shape (m, p d + 1)."""
        from dincl.rows.formulas import evaluate_formula

        point = (x - self.shift)[self.particles].reshape(len(self), -1)
        out = np.empty((len(self), point.shape[1] + 1))
        failed = evaluate_formula(self.formula.address, point, np.ascontiguousarray(self.parameters), x.shape[1], out)
        if failed >= 0:
            raise self.coincidence(failed)
        return out
