"""Rows of which nothing is known but a function and its derivative."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.callables import call, numbers
from dincl.csr import csr
from dincl.errors import StepFailure
from dincl.rows.curved import CurvedRows
from dincl.status import Status

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from dincl.csr import Csr


@dataclass(frozen=True, eq=False)
class SmoothRows(CurvedRows):
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
        name = self.names[0]
        raw = call(name, Status.CONSTRAINT_FAILED, self.g, x - self.shift)
        return numbers(name, Status.CONSTRAINT_FAILED, raw, (self.total,))[self.index]

    def jacobian(self, x: NDArray[np.float64]) -> Csr:
        """What ``derivative`` returns, checked: real numbers of shape (m, N*d) or (m, N, d), or a sparse matrix."""
        name = self.names[1]
        raw = call(name, Status.CONSTRAINT_FAILED, self.derivative, x - self.shift)
        shape = (self.total, x.size)
        if hasattr(raw, "tocsr"):
            return self._from_sparse(raw, shape)
        raw = np.reshape(raw, shape) if np.size(raw) == self.total * x.size else raw
        full = numbers(name, Status.CONSTRAINT_FAILED, raw, shape)[self.index]
        row, column = np.nonzero(full)
        return csr(np.searchsorted(row, np.arange(len(full) + 1)), column, full[row, column], x.size)

    def _from_sparse(self, raw: Any, shape: tuple[int, int]) -> Csr:
        """A matrix of scipy.sparse, which is not imported for those who return none."""
        from scipy.sparse import csr_array

        name = self.names[1]
        if raw.shape != shape:
            found = f"{name} returned a sparse matrix of shape {raw.shape}: must have shape {shape}."
            raise StepFailure(Status.CONSTRAINT_FAILED, found)
        rows = csr_array(raw)[self.index]
        data = numbers(name, Status.CONSTRAINT_FAILED, rows.data)
        return csr(rows.indptr.astype(np.int64), rows.indices.astype(np.int64), data, shape[1])

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
    value = numbers(names[0], Status.CONSTRAINT_FAILED, call(names[0], Status.CONSTRAINT_FAILED, g, x))
    if value.ndim != 1:
        raise StepFailure(
            Status.CONSTRAINT_FAILED, f"{names[0]} returned an array of shape {value.shape}: must be (m,)."
        )
    return SmoothRows(g, derivative, len(value), np.arange(len(value)), names=names)
