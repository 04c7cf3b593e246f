"""Least-distance programs that are hard: redundant, nearly dependent, empty, badly scaled, wrongly started.

By the active set with either factor, and by conjugate gradients on multipliers; the certificate is recomputed here.
"""

import numpy as np
import pytest
from scipy.sparse import csr_array

from dincl.compiled import kernel
from dincl.rows.candidates import no_candidates, sort_candidates
from dincl.rows.table import ROW, row_table
from dincl.solvers.active_set import CYCLES, OK, UNMET, least_distance, nearest_sparse, solve
from dincl.solvers.dual import bounded_conjugate_gradients
from dincl.solvers.envelope_factor import envelope_factor
from dincl.solvers.sparse_factor import FILL, analyse, refactor, sparse_factor


@kernel
def analysed(rows, listed, gram):
    return analyse(rows, listed, listed.size, gram)


@kernel
def solve_sparse(rows, listed, program, gram):
    analyse(rows, listed, listed.size, gram)
    return nearest_sparse(rows, listed, listed.size, program, gram, 0.0)


@kernel
def factorised(rows, gradient, gram, least):
    return refactor(rows, gradient, gram, least)


def envelope(table, gradient, n, bound, y, start):
    """The code, z and multipliers of min |z - y| s.t. a_r . z >= bound_r; no entry is read that was not written."""
    m = len(bound)
    program, factor = least_distance(gradient, bound, start.copy(), n), envelope_factor(min(m, n) + 1, n)
    program.y[:], factor.lower[:] = y, np.nan
    code = solve(table, np.arange(m), program, factor)
    return code, program.z, program.multiplier


def sparse(table, gradient, n, bound, y, start):
    """The same with the sparse factor."""
    m = len(bound)
    program = least_distance(gradient, bound, start.copy(), n)
    program.y[:] = y
    code = solve_sparse(table, np.arange(m), program, sparse_factor(m, n, m, len(table.column)))
    return code, program.z, program.multiplier


def full(dense):
    """A table of rows without a zero, and their entries."""
    m, n = dense.shape
    table = row_table(np.zeros(m, dtype=ROW), n * np.arange(m + 1), np.tile(np.arange(n), m), np.zeros(0))
    return table, dense.ravel().copy(), n


def unit(dense):
    return dense / np.linalg.norm(dense, axis=1, keepdims=True)


def residual(dense, bound, y, z, multiplier):
    """How far z is from the nearest point, by the conditions that it must meet."""
    gap = dense @ z - bound
    return max(
        np.abs(z - y - dense.T @ multiplier).max(),
        -gap.min(initial=0.0),
        -multiplier.min(initial=0.0),
        np.abs(np.minimum(gap, multiplier)).max(initial=0.0),
    )


def programs(rng, kind, count):
    """Feasible programs of one kind: (rows, bounds, y)."""
    for _ in range(count):
        n, m = int(rng.integers(1, 13)), int(rng.integers(1, 31))
        dense = unit(rng.normal(size=(m, n)))
        if kind == "redundant":
            dense = np.vstack((dense, dense[rng.integers(0, m, 6)], unit(dense[:m] + dense[rng.permutation(m)] + 1e-3)))
        elif kind.startswith("angle"):
            dense = np.vstack((dense, unit(dense + float(kind[6:]) * rng.normal(size=dense.shape))))
        inside = rng.normal(size=n)
        bound = dense @ inside - np.where(rng.random(len(dense)) < 0.5, 0.0, rng.exponential(size=len(dense)))
        y = inside + rng.choice([1e-6, 1.0, 1e3]) * rng.normal(size=n)
        if kind == "scales":
            scale = 10.0 ** rng.integers(-8, 8)
            inside, bound, y = scale * inside, scale * bound, scale * y
        yield dense, bound, y


def contacts(rng, n, d, m):
    """A network of m contacts, of a particle with one nearby or with a wall: (table, gradient, dense)."""
    dense = np.zeros((m, n * d))
    column, gradient, start = [], [], [0]
    for r in range(m):
        i = int(rng.integers(0, n))
        others = [j for j in range(i - 8, i + 9) if 0 <= j < n and j != i]
        ends = [(i, 1.0)] + ([(int(rng.choice(others)), -1.0)] if others and rng.random() < 0.9 else [])
        normal = unit(rng.normal(size=(1, d)))[0]
        for end, sign in ends:
            dense[r, end * d : end * d + d] = sign * normal
            column += range(end * d, end * d + d)
            gradient += list(sign * normal)
        start.append(len(column))
    table = row_table(np.zeros(m, dtype=ROW), np.array(start), np.array(column), np.zeros(0))
    return table, np.array(gradient), dense


KINDS = ["plain", "redundant", "angle 1e-3", "angle 1e-5", "angle 1e-6", "angle 1e-7", "angle 1e-9", "scales"]
by_either = pytest.mark.parametrize("solver", [envelope, sparse])


@by_either
@pytest.mark.parametrize("kind", KINDS)
def test_nearest_points_of_polyhedra(kind, solver, rng):
    """With the sparse factor rounding may have the last word where rows are nearly dependent, and it is said."""
    cycles = total = 0
    for dense, bound, y in programs(rng, kind, 300):
        wrong = np.where(rng.random(len(bound)) < 0.4, rng.exponential(size=len(bound)), 0.0)
        for start in (np.zeros(len(bound)), wrong, 1e6 * wrong):
            code, z, multiplier = solver(*full(dense), bound, y, start)
            total, cycles = total + 1, cycles + (code == CYCLES)
            assert code in (OK, CYCLES)
            if code == OK:
                size = np.abs(y).max() + np.abs(multiplier).max(initial=0.0)
                assert residual(dense, bound, y, z, multiplier) <= 1e-11 * size
    assert cycles <= (0.1 * total if solver is sparse and kind.startswith("angle") else 0)


@by_either
@pytest.mark.parametrize("depth", [1e-5, 1e-3, 1.0, 1e3])
def test_empty_polyhedra_are_called_empty(depth, solver, rng):
    for dense, bound, y in programs(rng, "plain", 200):
        # Positive weights of a few rows and their negative sum: no point is on the right side of all by ``depth``.
        few = rng.choice(len(dense), min(len(dense), 3), replace=False)
        weight = rng.uniform(0.5, 1.5, len(few))
        against = -weight @ dense[few]
        length = np.linalg.norm(against)
        rows = np.vstack((dense, against / length))
        bounds = np.append(bound, (depth - weight @ bound[few]) / length)
        wrong = np.where(rng.random(len(bounds)) < 0.4, rng.exponential(size=len(bounds)), 0.0)
        for start in (np.zeros(len(bounds)), wrong):
            assert solver(*full(rows), bounds, y, start)[0] in ((UNMET,) if solver is envelope else (UNMET, CYCLES))


@by_either
def test_rows_that_miss_by_rounding_are_met_or_left_to_another(solver):
    """Three rows that meet in one point, moved apart by less than what rounding leaves."""
    for apart in (1e-16, 1e-15, 1e-14, 1e-13):
        dense = np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0]])
        code, z, _ = solver(*full(dense), np.array([1.0 + apart, -1.0, 0.0]), np.array([0.0, -1.0]), np.zeros(3))
        assert code == OK
        assert np.abs(z - [1.0, 0.0]).max() <= 2 * apart + 1e-15


def test_networks_of_contacts(rng):
    """Of many rows, some of them redundant, started with those that pushed before."""
    for n, d, m in [(60, 2, 200), (40, 3, 100), (8, 2, 12), (150, 2, 240), (70, 1, 62), (1, 1, 1)] * 2:
        table, gradient, dense = contacts(rng, n, d, m)
        bound, y = -np.where(rng.random(m) < 0.6, 0.0, rng.exponential(size=m)), rng.normal(size=n * d)
        code, z, multiplier = sparse(table, gradient, n * d, bound, y, np.zeros(m))
        assert code == OK
        assert residual(dense, bound, y, z, multiplier) <= 1e-12
        assert (multiplier > 0).sum() > m // 10 - 1
        later = y + 1e-3 * rng.normal(size=n * d)
        code, z, multiplier = sparse(table, gradient, n * d, bound, later, multiplier)
        other, nearest, _ = envelope(table, gradient, n * d, bound, later, np.zeros(m))
        assert code == other == OK
        assert np.abs(z - nearest).max() <= 1e-11


def test_rows_that_depend_on_others_are_switched_off(rng):
    """As many as the rank leaves, whatever the order, and what is left spans the same space."""
    for _ in range(20):
        table, gradient, dense = contacts(rng, 12, 2, 40)
        gram = sparse_factor(40, 24, 40, len(table.column))
        assert analysed(table, np.arange(40), gram)
        gram.used[:40] = 1
        dropped = factorised(table, gradient, gram, 1e-11)
        used = gram.row[:40][gram.used[:40] == 1]
        assert len(used) == 40 - dropped == gram.number[1] == np.linalg.matrix_rank(dense, tol=1e-5)
        assert np.linalg.matrix_rank(dense[used], tol=1e-5) == len(used)


def test_a_chain_is_eliminated_without_fill_and_a_list_without_room_is_not_analysed(rng):
    m = 200
    columns = np.array([[r, r + 1] for r in range(m)]).ravel()
    table = row_table(np.zeros(m, dtype=ROW), 2 * np.arange(m + 1), columns, np.zeros(0))
    gram = sparse_factor(m, m + 1, m, 2 * m)
    assert analysed(table, np.arange(m), gram)
    assert gram.start[m] == m - 1
    table, _, _ = contacts(rng, 30, 2, 50)
    short = sparse_factor(49, 60, 50, len(table.column))
    assert not analysed(table, np.arange(50), short)
    assert (short.place == -1).all()
    assert analysed(table, np.arange(49), short)
    m = 2 * FILL + 10  # rows that all tie the same coordinate
    tied = row_table(np.zeros(m, dtype=ROW), np.arange(m + 1), np.zeros(m, dtype=np.int64), np.zeros(0))
    gram = sparse_factor(m, 1, m, m)
    assert not analysed(tied, np.arange(m), gram)
    assert (gram.place == -1).all()
    assert gram.number[0] == 0
    assert analysed(tied, np.arange(FILL), gram)


def test_conjugate_gradients_keep_their_word_and_count():
    matrix = csr_array([[1.0, 0.0], [0.6, 0.8], [-1.0, 0.0]])
    least, mu, cut = np.array([1.0, 1.2, -3.0]), np.zeros(3), np.zeros(3)
    arrays, gram = (matrix.indptr, matrix.indices, matrix.data, 2, least), (matrix @ matrix.T).toarray()
    iterations, claimed = bounded_conjugate_gradients(*arrays, mu, 100, 1e-12)
    assert 0 < iterations <= 6
    assert max(claimed, np.abs(np.minimum(mu, gram @ mu - least)).max()) <= 1e-12
    assert bounded_conjugate_gradients(*arrays, mu, 100, 1e-11)[0] == 0
    assert bounded_conjugate_gradients(*arrays, cut, 1, 1e-12)[0] == 1
    assert (cut >= 0).all()


@pytest.mark.parametrize("axis", [0, 1])
def test_rows_are_listed_along_the_axis_along_which_particles_extend_farthest(axis, rng):
    """By the middle of their first and last particle, so that the envelope is narrow; a row without entries is at 0."""
    n, m, count, d = 30, 50, 43, 2
    x = rng.normal(size=(n, d)) * (1.0, 9.0)[:: 1 if axis else -1]
    ends = np.sort(rng.integers(0, n, (m, 2)), axis=1)
    columns = [[d * one + k for one in sorted({*pair}) for k in range(d)] for pair in ends.tolist()]
    columns[7] = []
    start = np.cumsum([0, *map(len, columns)])
    table = row_table(np.zeros(m, dtype=ROW), start, np.concatenate(columns).astype(int), np.zeros(0))
    near = no_candidates(m, n * d, 1, d)
    listed = rng.permutation(m)
    near.row[:], near.number[0] = listed, count
    sort_candidates(table, x.ravel(), d, near)
    middle = x[ends, axis].sum(axis=1)
    middle[7] = 0.0
    assert sorted(near.row[:count]) == sorted(listed[:count])
    assert (np.diff(middle[near.row[:count]]) >= 0.0).all()
    assert near.row[count:].tolist() == listed[count:].tolist()
