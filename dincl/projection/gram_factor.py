"""Factors of the Gram matrix of active rows, by the sparse Cholesky factorisation of QDLDL."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.extras import needs

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.sparse import csr_array

# The part of the active rows that are kept in the factors besides them: those that are nearest to being active. When
# one of them becomes active, the order of elimination and the pattern, which take most of the time, serve once more.
SPARE = 0.3


class GramFactor:
    """Solves (A_F A_F^T + shift) y = r for changing rows F of changing matrices A that tie the same coordinates."""

    def __init__(self) -> None:
        with needs("ProjectedNewton", "yardsticks"):
            import qdldl
            from scipy.sparse import csc_array

        from dincl.solvers import gram

        self._kernels, self._sparse, self._factorise = gram, csc_array, qdldl.Solver
        self._indices = np.zeros(0, dtype=np.int64)
        self._kept = np.zeros(0, dtype=np.bool_)
        self._solver: Any = None

    def factorise(self, matrix: csr_array, free: NDArray[np.bool_], slope: NDArray[np.float64], shift: float) -> None:
        """Factors for the rows F where ``free`` (m,); ``slope`` (m,) says how far the others are from being active."""
        same = len(self._indices) == len(matrix.indices) and len(self._kept) == matrix.shape[0]
        if same and not (free & ~self._kept).any() and np.array_equal(self._indices, matrix.indices):
            self._fill(matrix, free, shift)
            self._solver.update(self._gram, upper=True)
            return
        self._kept, self._indices = _with_spare(free, slope), matrix.indices
        self._chosen = np.flatnonzero(self._kept)
        start, entry = self._kernels.gram_pattern(matrix.indptr, matrix.indices, matrix.shape[1], self._chosen)
        self._start, self._entry = start, entry
        self._gram: Any = self._sparse((np.ones(len(entry)), entry, start), shape=(len(self._chosen),) * 2)
        self._fill(matrix, free, shift)
        self._solver = self._factorise(self._gram, upper=True)

    def solve(self, right: NDArray[np.float64]) -> NDArray[np.float64]:
        """y (m,) for r = ``right`` (m,), which is zero outside of F, as y is."""
        y = np.zeros_like(right)
        y[self._chosen] = self._solver.solve(right[self._chosen])
        return y

    def _fill(self, matrix: csr_array, free: NDArray[np.bool_], shift: float) -> None:
        arrays = matrix.indptr, matrix.indices, matrix.data, matrix.shape[1], self._chosen, free
        self._kernels.gram_values(*arrays, shift, self._start, self._entry, self._gram.data)


def _with_spare(free: NDArray[np.bool_], slope: NDArray[np.float64]) -> NDArray[np.bool_]:
    """The free rows and, of the others, those with the least slopes."""
    count = int(SPARE * np.count_nonzero(free))
    kept = free.copy()
    others = np.flatnonzero(~free)
    if count < len(others):
        others = others[np.argpartition(slope[others], count)[:count]]
    kept[others] = True
    return kept
