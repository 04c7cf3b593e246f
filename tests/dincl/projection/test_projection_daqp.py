"""A start from other multipliers may cost time, never the answer."""

import numpy as np

import dincl
from dincl.matrices import from_equal_rows


def test_any_start_gives_the_same_answer(rng):
    """With rows as lower bounds DAQP calls one such program in fourteen infeasible, from an unlucky active set."""
    for _ in range(300):
        n, m = int(rng.integers(1, 7)), int(rng.integers(1, 12))
        rows = rng.choice([-1.0, 0.0, 1.0], size=(m, n))
        rows = rows[np.abs(rows).sum(axis=1) > 0]
        m = len(rows)
        rows /= np.linalg.norm(rows, axis=1, keepdims=True)
        matrix = from_equal_rows(np.tile(np.arange(n), (m, 1)), rows, n)
        least = rows @ rng.normal(size=n) - rng.choice([0.0, 0.1, 1.0], size=m)
        solver = dincl.Daqp(1e-9).solver()
        cold = solver.qp(matrix, least, np.zeros(m), 1e-9)
        warm = solver.qp(matrix, least, rng.integers(0, 2, size=m).astype(float), 1e-9)
        assert np.abs(cold.u - warm.u).max() < 1e-9
        assert (rows @ warm.u >= least - 1e-9).all()
