"""Rows given by a function and its derivative: in Python, or as one compiled formula for all rows."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.callables import UserFunction
from dincl.errors import StepFailure
from dincl.matrices import from_equal_rows, from_rows
from dincl.rows.base import RowsOfOneKind, TableRows, coordinates
from dincl.status import Status

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray
    from scipy.sparse import csr_array

# Base of the digits by which keys of FormulaRows name up to four particles: there are fewer particles than this.
MOST_PARTICLES = 1_000_003


@dataclass(frozen=True, eq=False)
class SmoothRows(RowsOfOneKind):
    """g(x) >= 0 for callables g: (N, d) -> (m,) and derivative: (N, d) -> (m, N*d), dense or sparse.

    ``index`` lists the rows taken of the ``total`` rows that g has; ``names`` are the names of the two callables in
    messages; ``negated`` says that the second half of the rows are the negatives of the first.
    """

    g: Callable[[NDArray[np.float64]], Any]
    derivative: Callable[[NDArray[np.float64]], Any]
    total: int
    index: NDArray[np.int64]
    names: tuple[str, str] = ("g", "jacobian")
    negated: bool = False

    def __len__(self) -> int:
        return len(self.index)

    @property
    def equal(self) -> bool:
        return self.negated

    def values(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        return _function_of_x(self.names[0]).evaluated(self.g, x, shape=(self.total,))[self.index]

    def jacobian(self, x: NDArray[np.float64]) -> csr_array:
        """Check what ``derivative`` returns: real numbers of shape (m, N*d) or (m, N, d), or a sparse matrix."""
        function, shape = _function_of_x(self.names[1]), (self.total, x.size)
        raw = function.call(self.derivative, x)
        if hasattr(raw, "tocsr"):
            if raw.shape != shape:
                function.refuse(f"returned a sparse matrix of shape {raw.shape}: must have shape {shape}.")
            rows = raw.tocsr()[self.index]
            return from_rows(rows.indptr, rows.indices, function.numbers(rows.data), x.size)
        full = function.numbers(raw)
        full = function.numbers(full.reshape(shape) if full.size == self.total * x.size else full, shape)[self.index]
        # All coordinates of a particle that a row touches: rows of one particle are found by equal columns.
        touched = (full.reshape(len(full), *x.shape) != 0).any(axis=2)
        row, column = np.nonzero(np.repeat(touched, x.shape[1], axis=1))
        return from_rows(np.searchsorted(row, np.arange(len(full) + 1)), column, full[row, column], x.size)

    def take(self, keep: NDArray[np.bool_]) -> SmoothRows:
        return replace(self, index=self.index[keep], negated=self.negated and bool(keep.all()))

    def keys(self) -> NDArray[np.int64]:
        return np.column_stack((self.index, self.index))

    def label(self, k: int, d: int) -> str:
        return f"row {self.index[k]} of {self.names[0]}"


def all_rows(
    g: Callable[[NDArray[np.float64]], Any],
    derivative: Callable[[NDArray[np.float64]], Any],
    x: NDArray[np.float64],
    names: tuple[str, str] = ("g", "jacobian"),
    *,
    negated: bool = False,
) -> SmoothRows:
    """Return all rows of g, as many as g has at x (N, d)."""
    total = len(_function_of_x(names[0]).evaluated(g, x, shape=(None,)))
    return SmoothRows(g, derivative, total, np.arange(total), names=names, negated=negated)


@cache
def _function_of_x(name: str) -> UserFunction:
    return UserFunction(name, ("x",), Status.CONSTRAINT_FAILED)


@dataclass(frozen=True, eq=False)
class FormulaRows(RowsOfOneKind):
    """g_k(X_i, X_j, ...) >= 0 for the particles of each row, by one compiled formula.

    Parameters
    ----------
    formula
        Made by ``dincl.rows.formulas.row_formula``.
    particles
        The particles of each row, shape (m, p).
    parameters
        The parameters of each row, shape (m, q), q <= p d.

    All rows are candidates in compiled code, since no Lipschitz constant of the formula is known.
    """

    formula: Any
    particles: NDArray[np.int64]
    parameters: NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.particles)

    def values(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        return self._evaluated(x)[:, -1]

    def jacobian(self, x: NDArray[np.float64]) -> csr_array:
        return from_equal_rows(coordinates(self.particles, x.shape[1]), self._evaluated(x)[:, :-1], x.size)

    def take(self, keep: NDArray[np.bool_]) -> FormulaRows:
        return replace(self, particles=self.particles[keep], parameters=self.parameters[keep])

    def keys(self) -> NDArray[np.int64]:
        """Two numbers, each with half of the particles as its digits."""
        halves = np.array_split(self.particles, 2, axis=1)
        return np.column_stack([half @ MOST_PARTICLES ** np.arange(half.shape[1]) for half in halves])

    def label(self, k: int, d: int) -> str:
        return "particles " + ", ".join(map(str, self.particles[k]))

    def coincidence(self, k: int) -> StepFailure:
        """Return the failure of row k, whose formula has no derivative."""
        return StepFailure(Status.CONSTRAINT_FAILED, f"g has no derivative at {self.label(k, 0)}.")

    def tabulated(self, d: int) -> TableRows:
        from dincl.rows.table import FORMULA

        column = coordinates(self.particles, d)
        coefficient = np.zeros(column.shape)
        coefficient[:, : self.parameters.shape[1]] = self.parameters
        numbers = {"kind": FORMULA, "i": -1, "j": -1, "lipschitz": np.inf}
        entries = np.full(len(self), column.shape[1])
        return TableRows(numbers, entries, column.ravel(), coefficient.ravel(), self.formula.address)

    def _evaluated(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """dg/dx and, last, g, shape (m, p d + 1)."""
        from dincl.rows.formulas import evaluate_formula

        point = x.ravel()[coordinates(self.particles, x.shape[1])]
        out = np.empty((len(self), point.shape[1] + 1))
        failed = evaluate_formula(self.formula.address, point, np.ascontiguousarray(self.parameters), x.shape[1], out)
        if failed >= 0:
            raise self.coincidence(failed)
        return out
