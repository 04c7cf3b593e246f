"""The active set with a sparse factor against the one with an envelope, on programs that are hard."""

import numpy as np
import pytest

from dincl.compiled import kernel
from dincl.rows.table import ROW, row_table
from dincl.solvers.active_set import CYCLES, OK, UNMET, least_distance, nearest_sparse
from dincl.solvers.sparse_factor import analyse, sparse_factor
from tests.dincl.solvers.test_active_set import KINDS, compiled, programs, residual
from tests.dincl.solvers.test_sparse_factor import contacts


@kernel
def solve(rows, listed, program, gram):
    analyse(rows, listed, listed.size, gram)
    return nearest_sparse(rows, listed, listed.size, program, gram, 0.0)


def sparse(rows, gradient, n, bound, y, start):
    """The code, z and multipliers of min |z - y| s.t. a_r . z >= bound_r."""
    m = len(bound)
    program = least_distance(gradient, bound, start.copy(), n)
    program.y[:] = y
    code = solve(rows, np.arange(m), program, sparse_factor(m, n, m, len(rows.column)))
    return code, program.z, program.multiplier


@pytest.mark.parametrize("kind", KINDS)
def test_nearest_points_of_polyhedra(kind, rng):
    """Where rows are nearly dependent rounding may have the last word, and it is said; else the point is nearest."""
    cycles = total = 0
    for dense, bound, y in programs(rng, kind, 300):
        m, n = dense.shape
        rows = row_table(np.zeros(m, dtype=ROW), n * np.arange(m + 1), np.tile(np.arange(n), m), np.zeros(0))
        wrong = np.where(rng.random(m) < 0.4, rng.exponential(size=m), 0.0)
        for start in (np.zeros(m), wrong, 1e6 * wrong):
            code, z, multiplier = sparse(rows, dense.ravel().copy(), n, bound, y, start)
            total, cycles = total + 1, cycles + (code == CYCLES)
            if code == OK:
                size = np.abs(y).max() + np.abs(multiplier).max(initial=0.0)
                assert residual(dense, bound, y, z, multiplier) <= 1e-11 * size
            else:
                assert code == CYCLES
    assert cycles <= (0.1 * total if kind.startswith("angle") else 0)


def test_networks_of_contacts(rng):
    """Of many rows, some of them redundant, started with those that pushed before."""
    for _ in range(10):
        rows, gradient, dense = contacts(rng, 60, 2, 200)
        bound, y = -np.where(rng.random(200) < 0.6, 0.0, rng.exponential(size=200)), rng.normal(size=120)
        code, z, multiplier = sparse(rows, gradient, 120, bound, y, np.zeros(200))
        assert code == OK
        assert residual(dense, bound, y, z, multiplier) <= 1e-12
        assert (multiplier > 0).sum() > 20
        later = y + 1e-3 * rng.normal(size=120)
        code, z, multiplier = sparse(rows, gradient, 120, bound, later, multiplier)
        other, nearest, _ = compiled(dense, bound, later, np.zeros(200))
        assert code == other == OK
        assert np.abs(z - nearest).max() <= 1e-11


def test_empty_polyhedra_are_called_empty(rng):
    for dense, bound, _ in programs(rng, "plain", 100):
        rows, bounds = np.vstack((dense, -dense[:1])), np.append(bound, 1.0 - bound[0])
        m, n = rows.shape
        table = row_table(np.zeros(m, dtype=ROW), n * np.arange(m + 1), np.tile(np.arange(n), m), np.zeros(0))
        code, _, _ = sparse(table, rows.ravel().copy(), n, bounds, np.zeros(n), np.zeros(m))
        assert code == UNMET
