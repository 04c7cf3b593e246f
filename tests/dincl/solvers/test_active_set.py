"""Least-distance programs that are hard: redundant, nearly dependent, infeasible, badly scaled, wrongly started."""

import numpy as np
import pytest

from dincl.rows.table import ROW, row_table
from dincl.solvers.active_set import OK, UNMET, least_distance, solve
from dincl.solvers.envelope_factor import envelope_factor


def compiled(dense, bound, y, start):
    """The code, z and multipliers of min |z - y| s.t. dense z >= bound."""
    m, n = dense.shape
    rows = row_table(np.zeros(m, dtype=ROW), n * np.arange(m + 1), np.tile(np.arange(n), m), np.zeros(0))
    program = least_distance(dense.ravel().copy(), bound, start.copy(), n)
    program.y[:] = y
    code = solve(rows, np.arange(m), program, envelope_factor(min(m, n) + 1, n))
    return code, program.z, program.multiplier


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


KINDS = ["plain", "redundant", "angle 1e-3", "angle 1e-5", "angle 1e-6", "angle 1e-7", "angle 1e-9", "scales"]


@pytest.mark.parametrize("kind", KINDS)
def test_nearest_points_of_polyhedra(kind, rng):
    for dense, bound, y in programs(rng, kind, 300):
        wrong = np.where(rng.random(len(bound)) < 0.4, rng.exponential(size=len(bound)), 0.0)
        for start in (np.zeros(len(bound)), wrong, 1e6 * wrong):
            code, z, multiplier = compiled(dense, bound, y, start)
            assert code == OK
            size = np.abs(y).max() + np.abs(multiplier).max(initial=0.0)
            assert residual(dense, bound, y, z, multiplier) <= 1e-11 * size


@pytest.mark.parametrize("depth", [1e-5, 1e-3, 1.0, 1e3])
def test_empty_polyhedra_are_called_empty(depth, rng):
    for dense, bound, y in programs(rng, "plain", 300):
        # Positive weights of a few rows and their negative sum: no point is on the right side of all by ``depth``.
        few = rng.choice(len(dense), min(len(dense), 3), replace=False)
        weight = rng.uniform(0.5, 1.5, len(few))
        against = -weight @ dense[few]
        length = np.linalg.norm(against)
        rows = np.vstack((dense, against / length))
        bounds = np.append(bound, (depth - weight @ bound[few]) / length)
        wrong = np.where(rng.random(len(bounds)) < 0.4, rng.exponential(size=len(bounds)), 0.0)
        for start in (np.zeros(len(bounds)), wrong):
            assert compiled(rows, bounds, y, start)[0] == UNMET


def test_rows_that_miss_by_rounding_are_met_or_left_to_another():
    """Three rows that meet in one point, moved apart by less than what rounding leaves."""
    for apart in (1e-16, 1e-15, 1e-14, 1e-13):
        dense = np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0]])
        code, z, _ = compiled(dense, np.array([1.0 + apart, -1.0, 0.0]), np.array([0.0, -1.0]), np.zeros(3))
        assert code == OK
        assert np.abs(z - [1.0, 0.0]).max() <= 2 * apart + 1e-15
