"""Rows of which nothing is known but a function and its derivative."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.callables import UserFunction
from dincl.matrices import from_rows
from dincl.rows.base import RowsOfOneKind
from dincl.status import Status

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray
    from scipy.sparse import csr_array


@dataclass(frozen=True, eq=False)
class SmoothRows(RowsOfOneKind):
    """g(x - shift) >= 0 for callables g: (N, d) -> (m,) and derivative: (N, d) -> (m, N*d), dense or sparse.

    ``total`` is m before rows were taken, and ``index`` names those taken; ``names`` are those of the two callables in
    messages.
    """

    g: Callable[[NDArray[np.float64]], Any]
    derivative: Callable[[NDArray[np.float64]], Any]
    total: int
    index: NDArray[np.int64]
    shift: NDArray[np.float64] | float = 0.0
    names: tuple[str, str] = ("g", "jacobian")

    def __len__(self) -> int:
        return len(self.index)

    def values(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        return _known(self.names[0]).evaluated(self.g, x - self.shift, shape=(self.total,))[self.index]

    def jacobian(self, x: NDArray[np.float64]) -> csr_array:
        """What ``derivative`` returns, checked: real numbers of shape (m, N*d) or (m, N, d), or a sparse matrix."""
        known, shape = _known(self.names[1]), (self.total, x.size)
        raw = known.call(self.derivative, x - self.shift)
        if hasattr(raw, "tocsr"):
            return self._from_sparse(raw, shape)
        full = known.numbers(raw)
        in_one = full.reshape(shape) if full.size == self.total * x.size else full
        full = known.numbers(in_one, shape)[self.index]
        row, column = np.nonzero(full)
        return from_rows(np.searchsorted(row, np.arange(len(full) + 1)), column, full[row, column], x.size)

    def _from_sparse(self, raw: Any, shape: tuple[int, int]) -> csr_array:
        """A matrix of scipy.sparse, which is not imported for those who return none."""
        from scipy.sparse import csr_array

        known = _known(self.names[1])
        if raw.shape != shape:
            known.refuse(f"returned a sparse matrix of shape {raw.shape}: must have shape {shape}.")
        rows = csr_array(raw)[self.index]
        return from_rows(rows.indptr, rows.indices, known.numbers(rows.data), shape[1])

    def take(self, keep: NDArray[np.bool_]) -> SmoothRows:
        return replace(self, index=self.index[keep])

    def shifted(self, displacement: NDArray[np.float64]) -> SmoothRows:
        return replace(self, shift=self.shift + displacement)

    def keys(self) -> NDArray[np.int64]:
        return np.column_stack((self.index, self.index))

    def label(self, k: int, d: int) -> str:
        return f"row {self.index[k]} of {self.names[0]}"


def all_rows(
    g: Callable[[NDArray[np.float64]], Any],
    derivative: Callable[[NDArray[np.float64]], Any],
    x: NDArray[np.float64],
    names: tuple[str, str] = ("g", "jacobian"),
) -> SmoothRows:
    """All rows of g, as many as it has at x (N, d)."""
    value = _known(names[0]).evaluated(g, x, shape=(None,))
    return SmoothRows(g, derivative, len(value), np.arange(len(value)), names=names)


@cache
def _known(name: str) -> UserFunction:
    """A function of x by its name."""
    return UserFunction(name, ("x",), Status.CONSTRAINT_FAILED)
