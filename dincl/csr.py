"""A sparse matrix by rows, as light as the small problems of a time step need it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from dincl import kernels

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray


class Csr(NamedTuple):
    """Row k holds ``data[indptr[k]:indptr[k+1]]`` in the columns ``indices[...]``; an index appears once in a row.

    ``row_of_entry`` names the row of each entry. Building one costs a few array operations; scipy.sparse checks and
    sorts at every construction, which at ten discs takes longer than the quadratic program that the matrix is for.
    """

    indptr: NDArray[np.int64]
    row_of_entry: NDArray[np.int64]
    indices: NDArray[np.int64]
    data: NDArray[np.float64]
    columns: int

    @property
    def rows(self) -> int:
        """Number of rows."""
        return len(self.indptr) - 1

    def times(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """A x for x of shape (columns,)."""
        product = np.empty(self.rows)
        kernels.products.times(self.indptr, self.indices, self.data, x, product)
        return product

    def transposed_times(self, y: NDArray[np.float64]) -> NDArray[np.float64]:
        """A^T y for y of shape (rows,)."""
        product = np.empty(self.columns)
        kernels.products.transposed_times(self.indptr, self.indices, self.data, y, product)
        return product

    def norms_squared(self) -> NDArray[np.float64]:
        """|a_k|^2 for each row, shape (rows,)."""
        squares = np.empty(self.rows)
        kernels.products.row_squares(self.indptr, self.data, squares)
        return squares

    def dense(self) -> NDArray[np.float64]:
        """A as a new array of shape (rows, columns)."""
        full = np.zeros((self.rows, self.columns))
        full[self.row_of_entry, self.indices] = self.data
        return full

    def scipy(self) -> Any:
        """A as scipy.sparse.csr_array."""
        from scipy.sparse import csr_array

        return csr_array((self.data, self.indices, self.indptr), shape=(self.rows, self.columns))

    def take(self, keep: NDArray[np.bool_]) -> Csr:
        """The rows where ``keep`` is true, in their order."""
        width = np.diff(self.indptr)
        entries = np.repeat(keep, width)
        indptr = np.concatenate(([0], np.cumsum(width[keep])))
        return csr(indptr, self.indices[entries], self.data[entries], self.columns)


def csr(indptr: NDArray[np.int64], indices: NDArray[np.int64], data: NDArray[np.float64], columns: int) -> Csr:
    """The matrix with rows of any widths."""
    return Csr(indptr, np.repeat(np.arange(len(indptr) - 1), np.diff(indptr)), indices, data, columns)


def uniform(indices: NDArray[np.int64], data: NDArray[np.float64], columns: int) -> Csr:
    """The matrix with the same number of entries in each row: indices and data of shape (rows, entries)."""
    m, width = indices.shape
    row_of_entry = np.repeat(np.arange(m), width)
    return Csr(np.arange(0, m * width + 1, max(width, 1)), row_of_entry, indices.ravel(), data.ravel(), columns)


def stack(blocks: Sequence[Csr], columns: int) -> Csr:
    """The blocks, one below the other."""
    if len(blocks) == 1:
        return blocks[0]
    indptr, row_of_entry = [np.zeros(1, dtype=np.int64)], [np.zeros(0, dtype=np.int64)]
    rows = entries = 0
    for block in blocks:
        indptr.append(block.indptr[1:] + entries)
        row_of_entry.append(block.row_of_entry + rows)
        rows, entries = rows + block.rows, entries + len(block.data)
    return Csr(
        np.concatenate(indptr),
        np.concatenate(row_of_entry),
        np.concatenate([np.zeros(0, dtype=np.int64), *(block.indices for block in blocks)]),
        np.concatenate([np.zeros(0), *(block.data for block in blocks)]),
        columns,
    )
