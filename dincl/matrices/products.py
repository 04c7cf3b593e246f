"""Products of a sparse matrix by rows, and of its transpose, with a vector."""

from dincl.compiled import kernel
from dincl.compiled.arrays import Floats, Offsets


@kernel
def times(indptr: Offsets, indices: Offsets, data: Floats, x: Floats, out: Floats) -> None:
    """Write A x into ``out``."""
    for row in range(out.size):
        total = 0.0
        for p in range(indptr[row], indptr[row + 1]):
            total += data[p] * x[indices[p]]
        out[row] = total


@kernel
def transposed_times(indptr: Offsets, indices: Offsets, data: Floats, y: Floats, out: Floats) -> None:
    """Write A^T y into ``out``; rows without weight cost nothing."""
    for column in range(out.size):
        out[column] = 0.0
    for row in range(y.size):
        if y[row] != 0.0:
            for p in range(indptr[row], indptr[row + 1]):
                out[indices[p]] += y[row] * data[p]


@kernel
def row_squares(indptr: Offsets, data: Floats, out: Floats) -> None:
    """Write the sum of the squares of each row into ``out``."""
    for row in range(out.size):
        total = 0.0
        for p in range(indptr[row], indptr[row + 1]):
            total += data[p] * data[p]
        out[row] = total
