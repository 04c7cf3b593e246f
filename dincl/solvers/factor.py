"""The Cholesky factor of the Gram matrix of chosen rows, in envelope form, while rows come and go.

Row k of the factor L is zero left of ``first[k]``: with rows in the order of the cloud only near ones tie the same
particles, so that an envelope is narrow. Appending and dropping a row keep it.
"""

from typing import NamedTuple

import numpy as np

from dincl.compiled import inner
from dincl.compiled.arrays import Floats, Offsets
from dincl.rows.table import RowTable


class Chosen(NamedTuple):
    """The rows ``row[:count[0]]`` with the factor of their Gram matrix; ``dense`` is room for one row, all zeros."""

    row: Offsets
    number: Offsets
    factor: Floats  # (most + 1, most + 1)
    first: Offsets
    touched: Offsets  # (n,): the first of the rows with an entry in this column
    dense: Floats  # (n,)
    right: Floats  # (most,): a right-hand side, solved in place


def room(most: int, n: int) -> Chosen:
    """Room for fewer than ``most`` rows of n coordinates."""
    row, count, first, touched = (np.zeros(size, dtype=np.int64) for size in (most, 1, most, n))
    return Chosen(row, count, np.zeros((most, most)), first, touched, np.zeros(n), np.zeros(most))


@inner
def times(rows: RowTable, r: int, gradient: Floats, x: Floats) -> float:
    """a_r . x."""
    total = 0.0
    for p in range(rows.start[r], rows.stop[r]):
        total += gradient[p] * x[rows.column[p]]
    return total


@inner
def add(rows: RowTable, r: int, gradient: Floats, weight: float, x: Floats) -> None:
    """x += weight a_r."""
    for p in range(rows.start[r], rows.stop[r]):
        x[rows.column[p]] += weight * gradient[p]


@inner
def forward(chosen: Chosen, first: int) -> None:
    """Solve L y = right from row ``first`` on, above which ``right`` is zero."""
    right, factor = chosen.right, chosen.factor
    for k in range(first, chosen.number[0]):
        total = right[k]
        for c in range(max(first, chosen.first[k]), k):
            total -= factor[k, c] * right[c]
        right[k] = total / factor[k, k]


@inner
def backward(chosen: Chosen) -> None:
    """Solve L^T y = right."""
    right, factor = chosen.right, chosen.factor
    for k in range(chosen.number[0] - 1, -1, -1):
        right[k] /= factor[k, k]
        for c in range(chosen.first[k], k):
            right[c] -= factor[k, c] * right[k]


@inner
def border(rows: RowTable, r: int, gradient: Floats, chosen: Chosen) -> None:
    """Write L^-1 A a_r into ``right`` and under the factor, as its next row."""
    count, factor = chosen.number[0], chosen.factor
    first = count
    for p in range(rows.start[r], rows.stop[r]):
        chosen.dense[rows.column[p]] += gradient[p]
        first = min(first, chosen.touched[rows.column[p]])
    for k in range(first):
        chosen.right[k] = 0.0
    for k in range(first, count):
        chosen.right[k] = times(rows, chosen.row[k], gradient, chosen.dense)
    for p in range(rows.start[r], rows.stop[r]):
        chosen.dense[rows.column[p]] = 0.0
    forward(chosen, first)
    for k in range(first, count):
        factor[count, k] = chosen.right[k]
    chosen.first[count] = first


@inner
def clear(chosen: Chosen) -> None:
    """Choose no row."""
    chosen.number[0] = 0
    for column in range(chosen.touched.size):
        chosen.touched[column] = chosen.row.size


@inner
def append(rows: RowTable, chosen: Chosen, r: int, square: float) -> None:
    """Take row r, for which ``border`` was called; ``square`` > 0 is that of its part across the other rows."""
    count = chosen.number[0]
    chosen.factor[count, count] = np.sqrt(square)
    chosen.row[count] = r
    for p in range(rows.start[r], rows.stop[r]):
        chosen.touched[rows.column[p]] = min(chosen.touched[rows.column[p]], count)
    chosen.number[0] = count + 1


@inner
def drop(rows: RowTable, chosen: Chosen, k: int) -> None:
    """Take out the row at place k: its column is turned into those to the right of it, which widens no envelope."""
    count, factor, first, column = chosen.number[0], chosen.factor, chosen.first, chosen.right
    for i in range(k + 1, count):
        column[i] = factor[i, k] if first[i] <= k else 0.0
    for c in range(k + 1, count):
        if column[c] == 0.0:
            continue
        radius = np.sqrt(factor[c, c] * factor[c, c] + column[c] * column[c])
        cosine, sine = factor[c, c] / radius, column[c] / radius
        factor[c, c] = radius
        for i in range(c + 1, count):
            if first[i] <= c:
                entry = factor[i, c]
                factor[i, c] = cosine * entry + sine * column[i]
                column[i] = cosine * column[i] - sine * entry
    for i in range(k + 1, count):
        for c in range(first[i], min(k, i)):
            factor[i - 1, c] = factor[i, c]
        for c in range(max(k + 1, first[i]), i + 1):
            factor[i - 1, c - 1] = factor[i, c]
        first[i - 1] = first[i] - 1 if first[i] > k else first[i]
        chosen.row[i - 1] = chosen.row[i]
    clear(chosen)
    for i in range(count - 1):
        r = chosen.row[i]
        for p in range(rows.start[r], rows.stop[r]):
            chosen.touched[rows.column[p]] = min(chosen.touched[rows.column[p]], i)
    chosen.number[0] = count - 1
