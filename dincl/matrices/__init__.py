"""Sparse matrices of rows a_k, as ``scipy.sparse.csr_array``, which is imported when the first one is made."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray
    from scipy.sparse import csr_array

    from dincl.compiled.arrays import Floats


def from_rows(
    indptr: NDArray[np.integer[Any]], indices: NDArray[np.integer[Any]], data: Floats, columns: int
) -> csr_array:
    """Make the matrix whose row k holds ``data[indptr[k]:indptr[k + 1]]`` in the columns ``indices[...]``."""
    made: csr_array = object.__new__(type(_template()))
    whole = {"indices": indices.astype(np.int32, copy=False), "indptr": indptr.astype(np.int32, copy=False)}
    vars(made).update(vars(_template()), _shape=(len(indptr) - 1, columns), data=data, **whole)
    return made


@cache
def _template() -> csr_array:
    """Return a matrix whose attributes others copy: the constructor takes longer than most uses of a small matrix."""
    from scipy.sparse import csr_array

    return csr_array((1, 1))


def from_equal_rows(indices: NDArray[np.int64], data: Floats, columns: int) -> csr_array:
    """Make the matrix with as many entries in each row: indices and data of shape (rows, entries)."""
    m, width = indices.shape
    return from_rows(np.arange(m + 1) * width, indices.ravel(), data.ravel(), columns)


def stacked(blocks: Sequence[csr_array], columns: int) -> csr_array:
    """Put the blocks one below the other."""
    if len(blocks) == 1:
        return blocks[0]
    offsets = np.cumsum([0, *(block.nnz for block in blocks)])
    ends = [block.indptr[1:] + offset for block, offset in zip(blocks, offsets, strict=False)]
    return from_rows(
        np.concatenate([np.zeros(1, dtype=np.int64), *ends]),
        np.concatenate([np.zeros(0, dtype=np.int64), *(block.indices for block in blocks)]),
        np.concatenate([np.zeros(0), *(block.data for block in blocks)]),
        columns,
    )


def row_squares(matrix: csr_array) -> Floats:
    """Compute |a_k|^2 of each row, shape (rows,)."""
    from dincl.matrices import products

    squares = np.empty(matrix.shape[0])
    products.row_squares(matrix.indptr, matrix.data, squares)
    return squares


def divided(matrix: csr_array, lengths: Floats) -> csr_array:
    """Divide the rows by lengths (rows,)."""
    data = matrix.data / np.repeat(lengths, np.diff(matrix.indptr))
    return from_rows(matrix.indptr, matrix.indices, data, matrix.shape[1])


def multiplied(matrix: csr_array, lengths: Floats) -> csr_array:
    """Multiply the rows by lengths (rows,)."""
    data = matrix.data * np.repeat(lengths, np.diff(matrix.indptr))
    return from_rows(matrix.indptr, matrix.indices, data, matrix.shape[1])


def applied(matrix: csr_array, x: Floats) -> Floats:
    """Compute a_k . x, shape (rows,): faster than the product of SciPy for small matrices."""
    from dincl.matrices import products

    out: Any = np.empty(matrix.shape[0])
    products.times(matrix.indptr, matrix.indices, matrix.data, x, out)
    found: Floats = out
    return found


def combined(matrix: csr_array, weights: Floats) -> Floats:
    """Compute sum_k weights_k a_k, shape (columns,): faster than the transpose of SciPy for small matrices."""
    from dincl.matrices import products

    total: Any = np.empty(matrix.shape[1])
    products.transposed_times(matrix.indptr, matrix.indices, matrix.data, weights, total)
    found: Floats = total
    return found
