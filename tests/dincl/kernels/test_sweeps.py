"""The sweeps do what their formulas say, and equal their plain twins bit for bit."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from numpy.typing import NDArray
from scipy.optimize import nnls
from scipy.sparse import csr_array

from dincl.kernels import neighbours, sweeps
from tests.twins import dincl_kernels as twins

Array = NDArray[np.float64]
DIMENSIONS = (1, 2, 3, 4)
FAR = 1e3


def heap(rng: np.random.Generator, n: int, d: int) -> tuple[Array, Array]:
    """Scatter overlapping discs of unequal radii."""
    return rng.uniform(0.0, n ** (1 / d), (n, d)), rng.uniform(0.3, 0.7, n)


def rows_of(rng: np.random.Generator, m: int, n: int) -> tuple[Array, list[Array]]:
    """Draw affine rows a_k.z >= b_k with about half of all entries: dense, and as the arguments of the kernels."""
    dense = rng.normal(size=(m, n)) * (rng.uniform(size=(m, n)) < 0.5)
    dense[np.arange(m), np.arange(m) % n] = 1.0
    sparse = csr_array(dense)
    return dense, [sparse.indptr, sparse.indices, sparse.data, rng.normal(size=m), (dense**2).sum(axis=1)]


def test_overlapping_pair_moves_apart_by_half_each() -> None:
    x = np.array([[0.0, 0.0], [3.0, 4.0], [0.0, 9.0]])
    start, partner = np.array([0, 0, 1, 3]), np.array([0, 0, 1], dtype=np.int32)
    radius = np.array([4.0, 3.0, 0.5])
    assert sweeps.sweep_pairs(x, start, partner, radius, x.copy(), 2.0) == (1, sweeps.OK, -1, -1)
    np.testing.assert_allclose(x, [[-0.6, -0.8], [3.6, 4.8], [0.0, 9.0]], rtol=1e-15)


def test_later_pairs_see_earlier_moves() -> None:
    x = np.array([[0.0], [1.0], [2.5]])
    start, partner = np.array([0, 0, 1, 2]), np.array([0, 1], dtype=np.int32)
    assert sweeps.sweep_pairs(x, start, partner, np.ones(3), x.copy(), FAR)[0] == 2
    # (1, 0): overlap 1 -> -0.5, 1.5;  (2, 1): overlap 1 -> 1.0, 3.0.
    np.testing.assert_allclose(x, [[-0.5], [1.0], [3.0]], rtol=1e-15)


@pytest.mark.parametrize("gap", [0.0, 1e-310, 1e-200])
def test_coincident_centres_stop_the_sweep(gap: float) -> None:
    x = np.array([[0.0, 0.0], [5.0, 0.0], [5.0 if gap == 0.0 else 0.0, gap]])
    before = x.copy()
    start, partner = np.array([0, 0, 1, 3]), np.array([0, 0, 1], dtype=np.int32)
    assert sweeps.sweep_pairs(x, start, partner, np.ones(3), before, FAR) == (0, sweeps.COINCIDENT, 2, int(gap == 0.0))
    assert np.array_equal(x, before)


@pytest.mark.parametrize("moved", [0, 1])
def test_a_disc_farther_than_slack_stops_the_sweep(moved: int) -> None:
    x = np.array([[0.0, 0.0], [1.0, 0.0]])
    reference = x.copy()
    reference[moved, 1] = 0.6
    start, partner = np.array([0, 0, 1]), np.array([0], dtype=np.int32)
    # Each disc moves by 0.5 along x, the chosen one ends sqrt(0.25 + 0.36) = 0.781 from its reference.
    assert sweeps.sweep_pairs(x.copy(), start, partner, np.ones(2), reference, 0.79) == (1, sweeps.OK, -1, -1)
    assert sweeps.sweep_pairs(x.copy(), start, partner, np.ones(2), reference, 0.78) == (1, sweeps.STALE, 1, 0)


@pytest.mark.parametrize("d", DIMENSIONS)
@pytest.mark.parametrize("slack", [FAR, 0.25])
@pytest.mark.parametrize("n", [0, 1, 7, 150])
def test_pair_sweep_equals_twin(d: int, slack: float, n: int, rng: np.random.Generator) -> None:
    x, radius = heap(rng, n, d)
    pairs = neighbours.near_pairs(x, radius + 0.1)
    other, reference = x.copy(), x + rng.uniform(-0.05, 0.05, x.shape)
    result = sweeps.sweep_pairs(x, *pairs, radius, reference, slack)
    assert result == twins.sweep_pairs(other, *pairs, radius, reference, slack)
    assert np.array_equal(x, other)
    if n == 150:
        assert result[0] > 0
        assert (result[1] == sweeps.STALE) == (slack < FAR)


@given(data=st.data(), d=st.sampled_from(DIMENSIONS), n=st.integers(1, 12), slack=st.sampled_from([0.5, FAR]))
def test_pair_sweep_equals_twin_on_generated_discs(data: st.DataObject, d: int, n: int, slack: float) -> None:
    x = data.draw(hnp.arrays(np.float64, (n, d), elements=st.floats(-2.0, 2.0)))
    radius = data.draw(hnp.arrays(np.float64, n, elements=st.floats(0.01, 1.5)))
    start, partner = neighbours.brute_force_pairs(x, radius)
    other, reference = x.copy(), x.copy()
    result = sweeps.sweep_pairs(x, start, partner, radius, reference, slack)
    assert result == twins.sweep_pairs(other, start, partner, radius, reference, slack)
    assert np.array_equal(x, other)
    assert np.isfinite(x).all()


@pytest.mark.parametrize("d", DIMENSIONS)
@pytest.mark.parametrize("slack", [0.2, 3.0])
def test_drifted_copies_and_compares(d: int, slack: float, rng: np.random.Generator) -> None:
    x = rng.normal(size=(40, d))
    reference = x + rng.uniform(-0.5, 0.5, x.shape)
    backups = np.empty_like(x), np.empty_like(x)
    result = sweeps.drifted(x, reference, slack, backups[0])
    assert result == twins.drifted(x, reference, slack, backups[1]) == (slack < 1.0)
    assert np.array_equal(backups[0], x)
    assert np.array_equal(backups[1], x)


def test_drifted_at_exactly_slack_is_not_drifted() -> None:
    x = np.array([[3.0, 4.0], [0.0, 0.0]])
    assert not sweeps.drifted(x, np.zeros((2, 2)), 5.0, np.empty_like(x))
    assert sweeps.drifted(x, np.zeros((2, 2)), np.nextafter(5.0, 0.0), np.empty_like(x))
    assert not sweeps.drifted(np.empty((0, 2)), np.empty((0, 2)), 0.0, np.empty((0, 2)))


def distance_rows(
    i: list[int], j: list[int], length: list[float]
) -> tuple[NDArray[np.int32], NDArray[np.int32], Array]:
    """Give the row arguments of `sweep_distance`."""
    return np.array(i, dtype=np.int32), np.array(j, dtype=np.int32), np.array(length)


def test_distance_rows_by_hand() -> None:
    none = np.empty((0, 2))
    x = np.array([[0.0, 0.0], [3.0, 4.0]])
    assert sweeps.sweep_distance(x, *distance_rows([0], [1], [4.0]), 1.0, none) == (0, sweeps.OK, -1)
    assert sweeps.sweep_distance(x, *distance_rows([0], [1], [4.0]), -1.0, none) == (1, sweeps.OK, -1)
    np.testing.assert_allclose(x, [[0.3, 0.4], [2.7, 3.6]], rtol=1e-15)
    x = np.array([[3.0, 4.0], [1.0, 1.0]])
    anchor = np.array([[0.0, 0.0], [1.0, 2.0]])
    assert sweeps.sweep_distance(x, *distance_rows([0, 1], [-1, -1], [10.0, 0.5]), 1.0, anchor) == (1, sweeps.OK, -1)
    np.testing.assert_allclose(x, [[6.0, 8.0], [1.0, 1.0]], rtol=1e-15)


def test_distance_rows_with_coincident_points() -> None:
    x = np.array([[1.0, 1.0], [1.0, 1.0], [1.0, 2.0]])
    none = np.empty((0, 2))
    rows = distance_rows([2, 1], [1, 0], [1.5, 0.25])
    rest = x.copy()
    assert sweeps.sweep_distance(rest, *rows, -1.0, none) == (0, sweeps.OK, -1)
    assert np.array_equal(rest, x)
    assert sweeps.sweep_distance(x, *distance_rows([1, 1], [0, 2], [0.25, 1.5]), 1.0, none) == (0, sweeps.COINCIDENT, 0)
    anchor = np.array([[1.0, 2.0]])
    assert sweeps.sweep_distance(x, *distance_rows([2], [-1], [0.5]), 1.0, anchor) == (0, sweeps.COINCIDENT, 0)


@pytest.mark.parametrize("d", DIMENSIONS)
@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("anchored", [True, False])
def test_distance_sweep_equals_twin(d: int, sign: float, anchored: bool, rng: np.random.Generator) -> None:
    n, m = 20, 60
    x = rng.normal(size=(n, d))
    i = rng.integers(0, n, m).astype(np.int32)
    j = ((i + rng.integers(1, n, m)) % n).astype(np.int32)
    if anchored:
        j[::3] = -1
    rows = (i, j, rng.uniform(0.5, 2.0, m), sign, rng.normal(size=(m if anchored else 0, d)))
    other = x.copy()
    result = sweeps.sweep_distance(x, *rows)
    assert result == twins.sweep_distance(other, *rows)
    assert 0 < result[0] < m
    assert np.array_equal(x, other)


def test_affine_row_by_hand() -> None:
    x = np.array([1.0, 1.0, 1.0])
    indptr, indices = np.array([0, 2, 3], dtype=np.int32), np.array([0, 2, 1], dtype=np.int32)
    # 3 x_0 + 4 x_2 >= 32 lacks 25 = |a|^2, so a itself is added;  x_1 >= 1 holds.
    moved = sweeps.sweep_affine(
        x, indptr, indices, np.array([3.0, 4.0, 1.0]), np.array([32.0, 1.0]), np.array([25.0, 1.0])
    )
    assert moved == 1
    assert x.tolist() == [4.0, 1.0, 5.0]


@pytest.mark.parametrize(("m", "n"), [(0, 3), (1, 1), (30, 12)])
def test_affine_sweep_equals_twin(m: int, n: int, rng: np.random.Generator) -> None:
    x = rng.normal(size=n)
    _, rows = rows_of(rng, m, n)
    other = x.copy()
    assert sweeps.sweep_affine(x, *rows) == twins.sweep_affine(other, *rows)
    assert np.array_equal(x, other)


def test_half_space_by_hand() -> None:
    x = np.array([[0.0, 0.0], [10.0, 10.0]])
    assert sweeps.sweep_half_space(x, np.array([0.6, 0.8]), np.array([5.0, 5.0])) == 1
    np.testing.assert_allclose(x, [[3.0, 4.0], [10.0, 10.0]], rtol=1e-15)


@pytest.mark.parametrize("d", DIMENSIONS)
@pytest.mark.parametrize("n", [0, 1, 50])
def test_half_space_sweep_equals_twin(d: int, n: int, rng: np.random.Generator) -> None:
    x, bound = rng.normal(size=(n, d)), rng.uniform(-0.5, 0.5, n)
    normal = rng.normal(size=d)
    normal /= np.linalg.norm(normal)
    other = x.copy()
    assert sweeps.sweep_half_space(x, normal, bound) == twins.sweep_half_space(other, normal, bound)
    assert np.array_equal(x, other)


def test_dual_sweep_by_hand() -> None:
    # Nearest point of x_0 >= 2 to the origin: one sweep finds it, the second confirms.
    z, multipliers = np.zeros(2), np.zeros(1)
    rows = [np.array([0, 1]), np.array([0]), np.array([2.0]), np.array([4.0]), np.array([4.0])]
    assert sweeps.dual_sweeps(z, *rows, multipliers, 1, 1e-12) == (1, 2.0)
    assert z.tolist() == [2.0, 0.0]
    assert multipliers.tolist() == [1.0]
    assert sweeps.dual_sweeps(z, *rows, multipliers, 9, 1e-12) == (1, 0.0)
    assert sweeps.dual_sweeps(z, *rows, multipliers, 0, 1e-12) == (0, np.inf)


def test_dual_sweep_lets_go_of_a_multiplier_it_does_not_need() -> None:
    # z = y + A^T lambda with y = 3 and lambda = 5: the row x >= 2 is slack at y.
    z, multipliers = np.array([8.0]), np.array([5.0])
    rows = [np.array([0, 1]), np.array([0]), np.ones(1), np.array([2.0]), np.ones(1)]
    assert sweeps.dual_sweeps(z, *rows, multipliers, 5, 0.0) == (2, 0.0)
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
    done, residual = sweeps.dual_sweeps(z, *rows, multipliers, 100_000, 1e-14)
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
    result = sweeps.dual_sweeps(z, *rows, multipliers, max_sweeps, 1e-12)
    assert result == twins.dual_sweeps(other, *rows, other_multipliers, max_sweeps, 1e-12)
    assert np.array_equal(z, other)
    assert np.array_equal(multipliers, other_multipliers)
