"""The Gram matrix of chosen rows has the entries and numbers of the dense one; its factors outlive changes of rows."""

import numpy as np
import pytest
from scipy.sparse import csr_array

from dincl.matrices import from_rows
from dincl.projection.gram_factor import GramFactor
from dincl.solvers.gram import gram_pattern, gram_values


def sparse(rng: np.random.Generator, m: int, n: int) -> csr_array:
    """Draw rows of unequal widths; one is empty, and one has an entry in each column, in no order."""
    widths = rng.integers(1, 5, m)
    widths[0], widths[m // 2] = 0, n
    indices = np.concatenate([rng.permutation(n)[:width] for width in widths])
    return from_rows(np.concatenate(([0], np.cumsum(widths))), indices, rng.normal(size=len(indices)), n)


@pytest.mark.parametrize("compiled", [True, False])
def test_entries_and_numbers_are_those_of_the_dense_matrix(rng: np.random.Generator, compiled: bool) -> None:
    pattern, values = (f if compiled else f.py_func for f in (gram_pattern, gram_values))  # type: ignore[attr-defined]
    matrix = sparse(rng, 40, 12)
    chosen = np.flatnonzero(rng.uniform(size=40) < 0.7)
    free = rng.uniform(size=40) < 0.8
    start, entry = pattern(matrix.indptr, matrix.indices, matrix.shape[1], chosen)
    out = np.full(len(entry), np.nan)
    arrays = matrix.indptr, matrix.indices, matrix.data, matrix.shape[1]
    values(*arrays, chosen, free, 0.25, start, entry, out)
    found = np.zeros((len(chosen), len(chosen)))
    for k in range(len(chosen)):
        rows = entry[start[k] : start[k + 1]]
        assert (np.diff(rows) > 0).all()
        assert rows[-1] == k
        found[rows, k] = out[start[k] : start[k + 1]]
    dense = matrix.toarray()[chosen]
    touching = np.abs(dense) @ np.abs(dense).T > 0
    assert len(entry) == np.triu(touching | np.eye(len(chosen), dtype=bool)).sum()
    among = free[chosen]
    expected = np.where(np.outer(among, among), dense @ dense.T + 0.25 * np.eye(len(chosen)), np.diag(~among))
    np.testing.assert_allclose(found, np.triu(expected), atol=1e-14)


def test_factors_solve_for_the_free_rows_whichever_they_are(rng: np.random.Generator) -> None:
    factor, matrix = GramFactor(), sparse(rng, 60, 25)
    free, slope = rng.uniform(size=60) < 0.4, rng.normal(size=60)
    for _ in range(20):
        factor.factorise(matrix, free, slope, 1e-6)
        right = np.where(free, slope, 0.0)
        y = factor.solve(right)
        rows = matrix.toarray()[free]
        np.testing.assert_allclose(rows @ (rows.T @ y[free]) + 1e-6 * y[free], right[free], atol=1e-7)
        assert not y[~free].any()
        free = free ^ (rng.uniform(size=60) < 0.05)
        data = matrix.data + 0.1 * rng.normal(size=len(matrix.data))
        matrix = from_rows(matrix.indptr, matrix.indices, data, matrix.shape[1])


def test_rows_that_nearly_touched_find_their_pattern_made(rng: np.random.Generator) -> None:
    factor, matrix = GramFactor(), sparse(rng, 60, 25)
    slope = np.linspace(-1.0, 1.0, 60)
    factor.factorise(matrix, slope < 0, slope, 1e-6)
    first = factor._gram
    factor.factorise(matrix, slope < 0.1, slope, 1e-6)
    assert factor._gram is first
    factor.factorise(matrix, slope < 0.9, slope, 1e-6)
    assert factor._gram is not first
