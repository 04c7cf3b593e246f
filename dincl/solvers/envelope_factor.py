"""The Cholesky factor L of the Gram matrix of active rows in envelope form, updated while rows come and go.

Row k of L is zero left of ``first[k]``: with rows in the order of the cloud only rows close to each other share
particles, so that an envelope is narrow. Appending and dropping a row keep it.
"""

from typing import NamedTuple

import numpy as np

from dincl.compiled import inner
from dincl.compiled.arrays import Floats, Offsets, Table
from dincl.rows.table import RowTable


class EnvelopeFactor(NamedTuple):
    """The active rows ``row[:number[0]]`` and the factor of their Gram matrix."""

    row: Offsets
    number: Offsets
    used: Offsets  # (most,): 1, as all rows of this factor are active; see ``SparseFactor``
    lower: Table  # (most, most): L
    first: Offsets
    touched: Offsets  # (n,): the first of the rows with an entry in this column
    dense: Floats  # (n,): workspace for one row, all zeros
    right: Floats  # (most,): a right-hand side, solved in place


def envelope_factor(most: int, n: int) -> EnvelopeFactor:
    """Allocate a factor for fewer than ``most`` rows of n coordinates."""
    row, number, first, touched = (np.zeros(size, dtype=np.int64) for size in (most, 1, most, n))
    used = np.ones(most, dtype=np.int64)
    return EnvelopeFactor(row, number, used, np.zeros((most, most)), first, touched, np.zeros(n), np.zeros(most))


@inner
def row_dot(rows: RowTable, r: int, gradient: Floats, x: Floats) -> float:
    """a_r . x."""
    total = 0.0
    for p in range(rows.start[r], rows.stop[r]):
        total += gradient[p] * x[rows.column[p]]
    return total


@inner
def add_row(rows: RowTable, r: int, gradient: Floats, scale: float, x: Floats) -> None:
    """x += scale a_r."""
    for p in range(rows.start[r], rows.stop[r]):
        x[rows.column[p]] += scale * gradient[p]


@inner
def solve_lower(factor: EnvelopeFactor, first: int) -> None:
    """Solve L y = right from row ``first`` on, above which ``right`` is zero."""
    right, lower = factor.right, factor.lower
    for k in range(first, factor.number[0]):
        total = right[k]
        for c in range(max(first, factor.first[k]), k):
            total -= lower[k, c] * right[c]
        right[k] = total / lower[k, k]


@inner
def solve_upper(factor: EnvelopeFactor) -> None:
    """Solve L^T y = right."""
    right, lower = factor.right, factor.lower
    for k in range(factor.number[0] - 1, -1, -1):
        right[k] /= lower[k, k]
        for c in range(factor.first[k], k):
            right[c] -= lower[k, c] * right[k]


@inner
def solve_envelope(factor: EnvelopeFactor) -> None:
    """Solve L L^T y = right."""
    solve_lower(factor, 0)
    solve_upper(factor)


@inner
def border(rows: RowTable, r: int, gradient: Floats, factor: EnvelopeFactor) -> None:
    """Write L^-1 A a_r into ``right`` and into L as its next row."""
    count, lower, right = factor.number[0], factor.lower, factor.right
    first = count
    for p in range(rows.start[r], rows.stop[r]):
        factor.dense[rows.column[p]] += gradient[p]
        first = min(first, factor.touched[rows.column[p]])
    for k in range(first):
        right[k] = 0.0
    for k in range(first, count):
        right[k] = row_dot(rows, factor.row[k], gradient, factor.dense)
    for p in range(rows.start[r], rows.stop[r]):
        factor.dense[rows.column[p]] = 0.0
    solve_lower(factor, first)
    for k in range(first, count):
        lower[count, k] = right[k]
    factor.first[count] = first


@inner
def orthogonal_square(rows: RowTable, r: int, gradient: Floats, factor: EnvelopeFactor) -> float:
    """The square of the part of a_r orthogonal to the active rows, after ``border``."""
    square = 0.0
    for p in range(rows.start[r], rows.stop[r]):
        square += gradient[p] * gradient[p]
    for k in range(factor.first[factor.number[0]], factor.number[0]):
        square -= factor.right[k] * factor.right[k]
    return square


@inner
def clear(factor: EnvelopeFactor) -> None:
    """Leave no row active."""
    factor.number[0] = 0
    for column in range(factor.touched.size):
        factor.touched[column] = factor.row.size


@inner
def append(rows: RowTable, factor: EnvelopeFactor, r: int, square: float) -> None:
    """Add row r after ``border``, which returned ``square`` > 0."""
    count = factor.number[0]
    factor.lower[count, count] = np.sqrt(square)
    factor.row[count] = r
    for p in range(rows.start[r], rows.stop[r]):
        factor.touched[rows.column[p]] = min(factor.touched[rows.column[p]], count)
    factor.number[0] = count + 1


@inner
def drop(rows: RowTable, factor: EnvelopeFactor, k: int) -> None:
    """Remove the row at place k: rotations of its column with the columns to its right widen no envelope."""
    count, lower, first, column = factor.number[0], factor.lower, factor.first, factor.right
    for i in range(k + 1, count):
        column[i] = lower[i, k] if first[i] <= k else 0.0
    for c in range(k + 1, count):
        if column[c] == 0.0:
            continue
        radius = np.sqrt(lower[c, c] * lower[c, c] + column[c] * column[c])
        cosine, sine = lower[c, c] / radius, column[c] / radius
        lower[c, c] = radius
        for i in range(c + 1, count):
            if first[i] <= c:
                entry = lower[i, c]
                lower[i, c] = cosine * entry + sine * column[i]
                column[i] = cosine * column[i] - sine * entry
    for i in range(k + 1, count):
        for c in range(first[i], min(k, i)):
            lower[i - 1, c] = lower[i, c]
        for c in range(max(k + 1, first[i]), i + 1):
            lower[i - 1, c - 1] = lower[i, c]
        first[i - 1] = first[i] - 1 if first[i] > k else first[i]
        factor.row[i - 1] = factor.row[i]
    clear(factor)
    for i in range(count - 1):
        r = factor.row[i]
        for p in range(rows.start[r], rows.stop[r]):
            factor.touched[rows.column[p]] = min(factor.touched[rows.column[p]], i)
    factor.number[0] = count - 1
