"""Accelerated sweeps: the same text run by Python, and where they end."""

import numpy as np

from dincl import scenes
from dincl.rows.affine import linearised
from dincl.solvers.dual import accelerated_sweeps, dual_sweeps
from tests.dincl.dense import full


def program(count: int) -> tuple[tuple, np.ndarray]:
    """Rows of a pile pulled down, and their right-hand sides: the arguments of the kernel before the multipliers."""
    scene = scenes.pile(count)
    rows = linearised(scene.rows_within(0.0, scene.x0, 0.2), scene.x0)
    least = -rows.values(scene.x0 - [0.0, 0.1])
    matrix = rows.matrix
    return (matrix.indptr, matrix.indices, matrix.data, matrix.shape[1], least), matrix.toarray()


def residual(dense: np.ndarray, least: np.ndarray, mu: np.ndarray) -> float:
    return float(np.abs(np.minimum(mu, dense @ (dense.T @ mu) - least)).max())


def test_the_kernel_is_its_own_text_run_by_python() -> None:
    arrays, _ = program(12)
    compiled, plain = np.zeros(len(arrays[-1])), np.zeros(len(arrays[-1]))
    accelerated_sweeps(*arrays, compiled, 40)
    accelerated_sweeps.py_func(*arrays, plain, 40)  # type: ignore[attr-defined]
    assert compiled.any()
    assert (compiled == plain).all()


def test_they_end_at_the_solution_long_before_sweeps_without() -> None:
    column = np.sqrt(0.5) * (np.eye(40) - np.eye(40, k=-1))
    column[0, 0] = 1.0
    matrix, least = full(column), np.zeros(40)
    least[0] = 1.0
    fast, slow = np.zeros(40), np.zeros(40)
    accelerated_sweeps(matrix.indptr, matrix.indices, matrix.data, 40, least, fast, 300)
    dual_sweeps(np.zeros(40), matrix.indptr, matrix.indices, matrix.data, least, np.ones(40), slow, 300, 0.0)
    assert (fast >= 0).all()
    assert residual(column, least, fast) < 1e-2 * residual(column, least, slow)


def test_they_never_lift_what_they_minimise(rng: np.random.Generator) -> None:
    arrays, dense = program(30)
    mu = rng.exponential(size=len(dense))
    last = np.inf
    for _ in range(50):
        accelerated_sweeps(*arrays, mu, 7)
        value = 0.5 * ((dense.T @ mu) ** 2).sum() - arrays[-1] @ mu
        assert value <= last + 1e-12 * abs(value)
        last = value


def test_no_sweep_changes_nothing() -> None:
    arrays, _ = program(12)
    mu = np.ones(len(arrays[-1]))
    accelerated_sweeps(*arrays, mu, 0)
    assert (mu == 1).all()
