"""Sweeps on multipliers solve least-distance programs, and equal their reference implementation bit for bit."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import nnls
from scipy.sparse import csr_array

from dincl.solvers.dual import dual_sweeps
from tests.twins import neighbours as twins

Array = NDArray[np.float64]


def rows_of(rng: np.random.Generator, m: int, n: int) -> tuple[Array, list[Array]]:
    """Draw affine rows a_k.z >= b_k with about half of all entries: dense, and as the arguments of the kernels."""
    dense = rng.normal(size=(m, n)) * (rng.uniform(size=(m, n)) < 0.5)
    dense[np.arange(m), np.arange(m) % n] = 1.0
    sparse = csr_array(dense)
    return dense, [sparse.indptr, sparse.indices, sparse.data, rng.normal(size=m), (dense**2).sum(axis=1)]


def test_dual_sweep_by_hand() -> None:
    # Nearest point of x_0 >= 2 to the origin: one sweep finds it, the second confirms.
    z, multipliers = np.zeros(2), np.zeros(1)
    rows = [np.array([0, 1]), np.array([0]), np.array([2.0]), np.array([4.0]), np.array([4.0])]
    assert dual_sweeps(z, *rows, multipliers, 1, 1e-12) == (1, 2.0)
    assert z.tolist() == [2.0, 0.0]
    assert multipliers.tolist() == [1.0]
    assert dual_sweeps(z, *rows, multipliers, 9, 1e-12) == (1, 0.0)
    assert dual_sweeps(z, *rows, multipliers, 0, 1e-12) == (0, np.inf)


def test_dual_sweep_lets_go_of_a_multiplier_it_does_not_need() -> None:
    # z = y + A^T lambda with y = 3 and lambda = 5: the row x >= 2 is slack at y.
    z, multipliers = np.array([8.0]), np.array([5.0])
    rows = [np.array([0, 1]), np.array([0]), np.ones(1), np.array([2.0]), np.ones(1)]
    assert dual_sweeps(z, *rows, multipliers, 5, 0.0) == (2, 0.0)
    assert z.tolist() == [3.0]
    assert multipliers.tolist() == [0.0]


@pytest.mark.parametrize("seed", range(20))
def test_dual_sweeps_solve_small_quadratic_programs(seed: int) -> None:
    rng = np.random.default_rng(seed)
    n, m = 6, 5
    dense, rows = rows_of(rng, m, n)
    y = rng.normal(size=n)
    rows[3] = dense @ rng.normal(size=n) + rng.uniform(-0.5, 0.0, m)  # feasible
    z, multipliers = y.copy(), np.zeros(m)
    done, residual = dual_sweeps(z, *rows, multipliers, 100_000, 1e-14)
    assert done < 100_000
    assert residual <= 1e-14
    # Nearest point as a least-distance problem, solved by nonnegative least squares (Lawson and Hanson, chapter 23).
    stacked = np.vstack([dense.T, rows[3] - dense @ y])
    u, _ = nnls(stacked, np.r_[np.zeros(n), 1.0])
    rest = stacked @ u - np.r_[np.zeros(n), 1.0]
    np.testing.assert_allclose(z - y, -rest[:n] / rest[n], atol=1e-10)
    assert (multipliers >= 0.0).all()
    np.testing.assert_allclose(y + dense.T @ multipliers, z, atol=1e-13)


@pytest.mark.parametrize("max_sweeps", [0, 1, 7])
def test_dual_sweeps_equal_twin(max_sweeps: int, rng: np.random.Generator) -> None:
    dense, rows = rows_of(rng, 25, 10)
    multipliers = rng.uniform(0.0, 1.0, 25)
    z = rng.normal(size=10) + dense.T @ multipliers
    other, other_multipliers = z.copy(), multipliers.copy()
    result = dual_sweeps(z, *rows, multipliers, max_sweeps, 1e-12)
    assert result == twins.dual_sweeps(other, *rows, other_multipliers, max_sweeps, 1e-12)
    assert np.array_equal(z, other)
    assert np.array_equal(multipliers, other_multipliers)
