"""The sparse factor of a Gram matrix against NumPy: rows that are switched on and off, dependent rows, new lists."""

import numpy as np
import pytest

from dincl.compiled import kernel
from dincl.rows.table import ROW, row_table
from dincl.solvers.sparse_factor import FILL, analyse, covers, refactor, solve_sparse, sparse_factor


@kernel
def analysed(rows, listed, gram):
    return analyse(rows, listed, listed.size, gram)


@kernel
def is_covered(listed, gram):
    return covers(listed, listed.size, gram)


@kernel
def factorised(rows, gradient, gram, least):
    return refactor(rows, gradient, gram, least)


@kernel
def solved(gram):
    solve_sparse(gram)


def contacts(rng, n, d, m):
    """A network of m contacts, of a particle with one nearby or with a wall: (table, gradient, dense)."""
    dense = np.zeros((m, n * d))
    column, gradient, start = [], [], [0]
    for r in range(m):
        i = int(rng.integers(0, n))
        others = [j for j in range(i - 8, i + 9) if 0 <= j < n and j != i]
        ends = [(i, 1.0)] + ([(int(rng.choice(others)), -1.0)] if others and rng.random() < 0.9 else [])
        normal = rng.normal(size=d)
        normal /= np.linalg.norm(normal)
        for end, sign in ends:
            dense[r, end * d : end * d + d] = sign * normal
            column += range(end * d, end * d + d)
            gradient += list(sign * normal)
        start.append(len(column))
    table = row_table(np.zeros(m, dtype=ROW), np.array(start), np.array(column), np.zeros(0))
    return table, np.array(gradient), dense


def room(table, dense):
    m, n = dense.shape
    return sparse_factor(m, n, m, len(table.column))


def use(gram, listed):
    gram.used[:] = 0
    gram.used[gram.place[listed]] = 1


def solve(gram, right):
    """The solution by row, of a right-hand side by row."""
    places = gram.place >= 0
    gram.right[gram.place[places]] = right[places]
    solved(gram)
    found = np.zeros(len(right))
    found[places] = gram.right[gram.place[places]]
    return found


@pytest.mark.parametrize(
    ("n", "d", "m"), [(40, 2, 60), (40, 3, 100), (8, 2, 12), (150, 2, 240), (70, 1, 62), (1, 1, 1)]
)
def test_solutions_of_networks(n, d, m, rng):
    table, gradient, dense = contacts(rng, n, d, m)
    gram = room(table, dense)
    for part in (1.0, 0.8, 0.3):
        listed = np.flatnonzero(rng.random(m) < part)
        assert analysed(table, rng.permutation(listed), gram)
        assert sorted(gram.row[: gram.number[0]]) == list(listed)
        assert is_covered(listed, gram)
        use(gram, listed)
        factorised(table, gradient, gram, 1e-9)
        for on in (gram.row[: gram.number[0]][gram.used[: gram.number[0]] == 1], listed[::2]):
            use(gram, on)
            assert factorised(table, gradient, gram, 1e-9) <= len(on) // 10 + 1
            used = gram.row[: gram.number[0]][gram.used[: gram.number[0]] == 1]
            right, matrix = np.where(np.isin(np.arange(m), used), rng.normal(size=m), 0.0), dense[used] @ dense[used].T
            found = solve(gram, right)
            assert not found[np.setdiff1d(np.arange(m), used)].any()
            size = 1.0 + np.abs(found).max()
            assert np.abs(matrix @ found[used] - right[used]).max(initial=0.0) <= 1e-13 * size
            assert not gram.work.any()
            assert not gram.dense.any()


def test_rows_that_depend_on_others_are_switched_off(rng):
    """As many as the rank leaves, whatever the order, and what is left spans the same space."""
    for _ in range(20):
        table, gradient, dense = contacts(rng, 12, 2, 40)
        gram = room(table, dense)
        assert analysed(table, np.arange(40), gram)
        use(gram, np.arange(40))
        dropped = factorised(table, gradient, gram, 1e-11)
        used = gram.row[:40][gram.used[:40] == 1]
        assert len(used) == 40 - dropped == gram.number[1] == np.linalg.matrix_rank(dense, tol=1e-5)
        assert np.linalg.matrix_rank(dense[used], tol=1e-5) == len(used)


def test_a_chain_is_eliminated_without_fill():
    """Discs in a row: each contact is tied to two others, and the factor has as many entries as the matrix."""
    m = 200
    columns = np.array([[r, r + 1] for r in range(m)]).ravel()
    table = row_table(np.zeros(m, dtype=ROW), 2 * np.arange(m + 1), columns, np.zeros(0))
    gram = sparse_factor(m, m + 1, m, 2 * m)
    assert analysed(table, np.arange(m), gram)
    assert gram.start[m] == m - 1


def test_a_list_without_room_is_not_analysed(rng):
    """Rows that all tie the same coordinates fill the factor; with too few places for them nothing is kept."""
    table, _, _ = contacts(rng, 30, 2, 50)
    short = sparse_factor(49, 60, 50, len(table.column))
    assert not analysed(table, np.arange(50), short)
    assert (short.place == -1).all()
    assert analysed(table, np.arange(49), short)
    m = 2 * FILL + 10
    full = row_table(np.zeros(m, dtype=ROW), np.arange(m + 1), np.zeros(m, dtype=np.int64), np.zeros(0))
    gram = sparse_factor(m, 1, m, m)
    assert not analysed(full, np.arange(m), gram)
    assert (gram.place == -1).all()
    assert gram.number[0] == 0
    assert not is_covered(np.arange(3), gram)
    assert analysed(full, np.arange(FILL), gram)
