"""The factor of the Gram matrix, while rows come and go, against NumPy; what lies left of an envelope is never read."""

import numpy as np
import pytest

from dincl.compiled import kernel
from dincl.rows.candidates import no_candidates, sort_candidates
from dincl.rows.table import ROW, row_table
from dincl.solvers.envelope_factor import (
    append,
    border,
    clear,
    drop,
    envelope_factor,
    orthogonal_square,
    solve_envelope,
)


@kernel
def take(rows, gradient, factor, r):
    border(rows, r, gradient, factor)
    square = orthogonal_square(rows, r, gradient, factor)
    if square > 1e-6:
        append(rows, factor, r, square)
    return square


@kernel
def leave(rows, factor, k):
    drop(rows, factor, k)


@kernel
def solve_gram(factor):
    solve_envelope(factor)


@kernel
def empty(factor):
    clear(factor)


def random_rows(rng, n, m, entries, spread):
    """Unit rows with entries in columns close to each other: (table, gradient, dense)."""
    dense = np.zeros((m, n))
    column, gradient = [], []
    for r in range(m):
        low = int(rng.integers(0, n - entries + 1)) if spread < n else 0
        columns = np.sort(rng.choice(min(spread, n - low), entries, replace=False)) + low
        values = rng.normal(size=entries)
        values /= np.linalg.norm(values)
        dense[r, columns] = values
        column.append(columns)
        gradient.append(values)
    start = entries * np.arange(m + 1)
    return (
        row_table(np.zeros(m, dtype=ROW), start, np.concatenate(column), np.zeros(0)),
        np.concatenate(gradient),
        dense,
    )


def spoil(factor):
    """NaN wherever the factor has no entry: left of the envelope, right of the diagonal, below the last row."""
    count = factor.number[0]
    for k in range(len(factor.lower)):
        left = factor.first[k] if k < count else len(factor.lower)
        factor.lower[k, :left] = np.nan
        factor.lower[k, k + 1 :] = np.nan


def lower(factor):
    """L as a dense matrix."""
    count = factor.number[0]
    found = np.zeros((count, count))
    for k in range(count):
        found[k, factor.first[k] : k + 1] = factor.lower[k, factor.first[k] : k + 1]
    return found


@pytest.mark.parametrize(("n", "m", "entries", "spread"), [(24, 40, 4, 6), (30, 25, 2, 30), (12, 30, 12, 12)])
def test_rows_come_and_go(n, m, entries, spread, rng):
    rows, gradient, dense = random_rows(rng, n, m, entries, spread)
    factor, refused, dropped = envelope_factor(min(m, n) + 1, n), 0, 0
    empty(factor)
    for _ in range(600):
        now = list(factor.row[: factor.number[0]])
        if len(now) == min(n, m) or (now and rng.random() < 0.45):
            place = int(rng.integers(len(now)))
            leave(rows, factor, place)
            del now[place]
            dropped += 1
        else:
            r = int(rng.choice(np.setdiff1d(np.arange(m), now)))
            others = dense[now]
            part = dense[r] - others.T @ np.linalg.lstsq(others.T, dense[r], rcond=None)[0] if now else dense[r]
            square = take(rows, gradient, factor, r)
            # Cancellation costs as many digits as the others are close to dependent.
            assert square == pytest.approx(part @ part, abs=1e-7)
            refused += square <= 1e-6
            now += [r] if square > 1e-6 else []
        spoil(factor)
        assert list(factor.row[: factor.number[0]]) == now
        cholesky, gram = lower(factor), dense[now] @ dense[now].T
        assert np.abs(cholesky @ cholesky.T - gram).max(initial=0.0) <= 1e-13
        assert (np.diag(cholesky) > 0).all()
        touched = [min([k for k, r in enumerate(now) if dense[r, c]], default=len(factor.row)) for c in range(n)]
        assert list(factor.touched) == touched
        assert not factor.dense.any()
        right = rng.normal(size=len(now))
        factor.right[: len(now)] = right
        solve_gram(factor)
        exact = np.linalg.solve(cholesky @ cholesky.T, right)
        size = 1 + np.abs(exact).max(initial=0.0)
        assert np.abs(gram @ factor.right[: len(now)] - right).max(initial=0.0) <= 1e-12 * size
    assert dropped > 200
    assert refused > 0 or entries > 2


@pytest.mark.parametrize("axis", [0, 1])
def test_rows_are_listed_along_the_axis_along_which_particles_extend_farthest(axis, rng):
    """By the middle of their first and last particle, so that the envelope is narrow; a row without entries is at 0."""
    n, m, count, d = 30, 50, 43, 2
    x = rng.normal(size=(n, d)) * (1.0, 9.0)[:: 1 if axis else -1]
    ends = np.sort(rng.integers(0, n, (m, 2)), axis=1)
    columns = [[d * one + k for one in sorted({*pair}) for k in range(d)] for pair in ends.tolist()]
    columns[7] = []
    start = np.cumsum([0, *map(len, columns)])
    table = row_table(np.zeros(m, dtype=ROW), start, np.array(sum(columns, [])), np.zeros(0))
    near = no_candidates(m, n * d, 1, d)
    listed = rng.permutation(m)
    near.row[:], near.number[0] = listed, count
    sort_candidates(table, x.ravel(), d, near)
    middle = x[ends, axis].sum(axis=1)
    middle[7] = 0.0
    assert sorted(near.row[:count]) == sorted(listed[:count])
    assert (np.diff(middle[near.row[:count]]) >= 0.0).all()
    assert near.row[count:].tolist() == listed[count:].tolist()
