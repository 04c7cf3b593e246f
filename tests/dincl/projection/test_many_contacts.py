"""Projections for many contacts: against all active sets, against Daqp, redundant and empty sets, warm starts."""

from itertools import combinations

import numpy as np
import pytest

import dincl
from dincl import ProjectedCG, ProjectedNewton, scenes
from dincl.errors import StepFailure
from dincl.matrices import from_rows
from dincl.projection import FeasibleSet
from dincl.rows.affine import AffineRows, linearised
from dincl.status import Status
from tests.dincl.dense import full

BOTH = pytest.mark.parametrize("projection", [ProjectedCG, ProjectedNewton])


def shortest(matrix, least):
    """The shortest u with A u >= least, by trying every set of independent rows as equations."""
    best = None
    for count in range(len(matrix) + 1):
        for rows in combinations(range(len(matrix)), count):
            chosen = matrix[list(rows)]
            if np.linalg.matrix_rank(chosen) < count:
                continue
            mu = np.linalg.solve(chosen @ chosen.T, least[list(rows)]) if count else np.zeros(0)
            u = chosen.T @ mu
            if (matrix @ u >= least - 1e-11).all() and (best is None or u @ u < best @ best):
                best = u
    return best


@BOTH
def test_it_finds_what_trying_all_active_sets_finds(projection, rng):
    for _ in range(60):
        n, m = int(rng.integers(1, 5)), int(rng.integers(1, 7))
        matrix = rng.normal(size=(m, n))
        matrix /= np.linalg.norm(matrix, axis=1, keepdims=True)
        inside = rng.normal(size=n)
        least = matrix @ inside - rng.choice([0.0, 0.3, 2.0], size=m)
        answer = projection(1e-9).solver().qp(full(matrix), least, np.zeros(m), 1e-11)
        assert np.abs(answer.u - shortest(matrix, least)).max() < 1e-7
        assert (answer.multipliers >= 0).all()
        assert np.abs(answer.u - matrix.T @ answer.multipliers).max() < 1e-12


@BOTH
def test_redundant_rows_and_any_start(projection, rng):
    row = np.array([[0.6, 0.8]])
    matrix = full(np.repeat(row, 5, axis=0))
    for _ in range(20):
        answer = projection(1e-9).solver().qp(matrix, np.ones(5), rng.exponential(size=5), 1e-12)
        assert np.abs(answer.u - row[0]).max() < 1e-12


def test_newton_from_where_all_rows_push_takes_one_step(rng):
    """A quadratic function has its minimum one step away, if no multiplier ends at its bound."""
    matrix, wanted = rng.normal(size=(4, 6)), rng.exponential(size=4)
    answer = ProjectedNewton(1e-6).solver().qp(full(matrix), matrix @ matrix.T @ wanted, 2 * wanted, 1e-6)
    assert answer.multipliers == pytest.approx(wanted, rel=1e-5)
    assert answer.iterations == 1


@BOTH
@pytest.mark.parametrize("tol", [1e-5, 1e-8, 1e-11])
def test_a_pile_is_certified_and_agrees_with_daqp(projection, tol):
    scene = scenes.pile(60)
    target = scene.x0 - [0.0, 0.05]
    rows = linearised(scene.rows_within(0.0, scene.x0, 0.2), scene.x0)
    found = projection(tol).solver().nearest(rows, target, scene.x0)
    exact = dincl.Daqp(1e-12).solver().nearest(rows, target, scene.x0)
    assert found.residual <= tol
    assert np.abs(found.point - exact.point).max() < 1e3 * tol
    assert found.iterations > 0


@BOTH
def test_an_empty_set_is_called_empty(projection):
    walls = full(np.array([[1.0, 0.0], [-1.0, 0.0]]))
    with pytest.raises(StepFailure) as failed:
        projection(1e-9).solver().nearest(AffineRows(walls, np.array([1.0, 1.0])), np.zeros((1, 2)), np.zeros((1, 2)))
    assert failed.value.status is Status.INFEASIBLE


@BOTH
def test_a_row_without_gradient_is_no_direction(projection):
    nothing = from_rows(np.array([0, 0, 2]), np.array([0, 1]), np.array([0.6, 0.8]), 2)
    found = projection(1e-9).solver().nearest(AffineRows(nothing, np.array([-1.0, 1.0])), np.zeros((1, 2)), None)
    assert np.abs(found.point - [[0.6, 0.8]]).max() < 1e-9
    empty = AffineRows(nothing, np.array([1.0, 1.0]))
    with pytest.raises(StepFailure) as failed:
        projection(1e-9).solver().nearest(empty, np.zeros((1, 2)), np.zeros((1, 2)))
    assert failed.value.status is Status.INFEASIBLE


@BOTH
def test_multipliers_outlive_rows_that_come_and_go(projection):
    """A pile of so many discs that only near rows are listed, which change all the time while contacts stay."""
    scene = scenes.pile(300)
    scheme = dincl.LinearisedCatchUp(0.005, projection(1e-9))
    settled = dincl.solve(scene, scheme, t=[0.5])
    assert settled.stats.neighbour_builds > 10
    feasible = FeasibleSet(scene, projection(1e-9).solver(), dincl.Work(), linearised=True)
    x, iterations = settled.final, []
    for reach in (0.02, 0.1, 0.6):
        found = feasible.nearest(0.0, x - [0.0, 0.005], x, reach)
        iterations.append((found.iterations, len(found.multipliers)))
    assert iterations[0][1] < iterations[1][1] < iterations[2][1]
    assert max(iterations[1][0], iterations[2][0]) < max(iterations[0][0] / 4, 3)


@BOTH
def test_two_walls_at_one_particle_may_swap_their_starts(projection):
    walls = full(np.array([[1.0, 0.0], [0.0, 1.0]]))
    solver = projection(1e-12).solver()
    for bound in ([1.0, 3.0], [3.0, 1.0]):
        for rows in (
            AffineRows(walls, np.array(bound)),
            AffineRows(walls, np.array(bound)).take(np.array([True, False])),
        ):
            found = solver.nearest(rows, np.zeros((1, 2)), np.zeros((1, 2)))
            expected = [bound[0], bound[1] if len(rows) == 2 else 0.0]
            assert np.abs(found.point - [expected]).max() < 1e-11
