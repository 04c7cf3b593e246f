"""The narrowest wedge of rows that share their coordinates, such as two nearly opposite walls of one particle."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dincl.compiled import inner, kernel
from dincl.compiled.arrays import Floats, Offsets
from dincl.constants import NARROW, OPPOSITE
from dincl.rows.candidates import CandidateRows, no_candidates
from dincl.rows.table import AFFINE, DISTANCE, ROW, RowTable, row_table

if TYPE_CHECKING:
    from scipy.sparse import csr_array


@inner
def narrowest(rows: RowTable, near: CandidateRows, gradient: Floats, listed: Offsets, count: int) -> float:
    """Compute the least |sum_k mu_k a_k| between OPPOSITE and NARROW of two or, in space, three rows; inf without one.

    A point that is off by g from rows with this value w may be off by g / w from where they meet: 2 w is the opening of
    a wedge. Rows have length 1. Pairs of particles are left out, since no two such rows share their coordinates.
    """
    least, head, link = np.inf, near.head, near.link
    for p in range(count):
        if has_entries(rows, listed[p]):
            head[rows.column[rows.start[listed[p]]]] = -1
    for p in range(count):
        r = listed[p]
        if not has_entries(rows, r) or is_pair(rows, r):
            continue
        # Earlier rows with the same first coordinate.
        first = rows.column[rows.start[r]]
        q = head[first]
        while q >= 0:
            if share_columns(rows, r, listed[q]):
                width = between_two(rows, gradient, r, listed[q])
                if OPPOSITE < width < least:
                    least = width
                k = link[q] if rows.stop[r] - rows.start[r] == 3 else -1
                while k >= 0:
                    if share_columns(rows, r, listed[k]):
                        width = between_three(rows, gradient, r, listed[q], listed[k])
                        if OPPOSITE < width < least:
                            least = width
                    k = link[k]
            q = link[q]
        link[p], head[first] = head[first], p
    return least if least < NARROW else np.inf


@inner
def has_entries(rows: RowTable, r: int) -> bool:
    """Return whether row r has a gradient that is not empty."""
    return bool(rows.stop[r] > rows.start[r])


@inner
def is_pair(rows: RowTable, r: int) -> bool:
    """Return whether row r is the distance of two particles."""
    return bool(rows.row[r].kind == DISTANCE and rows.row[r].j >= 0)


@inner
def share_columns(rows: RowTable, r: int, s: int) -> bool:
    """Return whether two rows, no pairs, have entries in the same coordinates."""
    entries, first, second = rows.stop[r] - rows.start[r], rows.start[r], rows.start[s]
    if is_pair(rows, s) or rows.stop[s] - second != entries:
        return False
    same = True
    for e in range(entries):
        same = same and rows.column[first + e] == rows.column[second + e]
    return same


@inner
def between_two(rows: RowTable, gradient: Floats, r: int, s: int) -> float:
    """Compute |a_r + a_s| / 2, the distance of the segment between a_r and a_s from the origin."""
    square, second = 0.0, rows.start[s] - rows.start[r]
    for e in range(rows.start[r], rows.stop[r]):
        total = gradient[e] + gradient[second + e]
        square += total * total
    return 0.5 * float(np.sqrt(square))


@inner
def between_three(rows: RowTable, gradient: Floats, r: int, s: int, t: int) -> float:
    """Compute the distance of the triangle of three vectors in space from the origin, inf if its nearest point is none.

    The origin lies over the triangle if the three tetrahedra with the normal n of its plane have one sign.
    """
    a, b, c = gradient[rows.start[r] :], gradient[rows.start[s] :], gradient[rows.start[t] :]
    n0 = (b[1] - a[1]) * (c[2] - a[2]) - (b[2] - a[2]) * (c[1] - a[1])
    n1 = (b[2] - a[2]) * (c[0] - a[0]) - (b[0] - a[0]) * (c[2] - a[2])
    n2 = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    if not triple(a, b, n0, n1, n2) > 0.0 or not triple(b, c, n0, n1, n2) > 0.0 or not triple(c, a, n0, n1, n2) > 0.0:
        return np.inf
    return float(abs(a[0] * n0 + a[1] * n1 + a[2] * n2) / np.sqrt(n0 * n0 + n1 * n1 + n2 * n2))


@inner
def triple(a: Floats, b: Floats, n0: float, n1: float, n2: float) -> float:
    """Compute (a x b) . n."""
    return float((a[1] * b[2] - a[2] * b[1]) * n0 + (a[2] * b[0] - a[0] * b[2]) * n1 + (a[0] * b[1] - a[1] * b[0]) * n2)


@kernel
def _narrowest(rows: RowTable, near: CandidateRows, gradient: Floats, listed: Offsets) -> float:
    return narrowest(rows, near, gradient, listed, listed.size)


def narrowest_of(matrix: csr_array) -> float:
    """Compute the same for all rows of a sparse matrix, none of which is a pair."""
    m, n = matrix.shape
    row = np.zeros(m, dtype=ROW)
    row["kind"] = AFFINE
    rows = row_table(row, matrix.indptr, matrix.indices, np.zeros(0))
    return float(_narrowest(rows, no_candidates(m, n, 0, 1), matrix.data, np.arange(m)))
