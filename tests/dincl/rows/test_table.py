"""The rows of a problem as compiled code has them, against the constraints themselves."""

import numpy as np
import pytest

from dincl.compiled import kernel
from dincl.constraints.selection import select
from dincl.rows.candidates import find_candidates, sort_candidates
from dincl.rows.table import AFFINE, CALLBACK, GRADIENTS, call_python, gap, linearise
from dincl.system.compiled_problem import CompiledProblem
from tests.dincl.random_scenes import random_scene

SEEDS = range(40)


@kernel
def linearise_all(rows, sets, t, x, gradient, value):
    call_python(sets, t, x, GRADIENTS)
    for r in range(rows.row.size):
        value[r, 0] = linearise(rows, sets, r, x, gradient)
        value[r, 1] = gap(rows, sets, r, x)


@kernel
def list_near(rows, sets, t, x, reach, near):
    call_python(sets, t, x, GRADIENTS)
    find_candidates(rows, sets, t, x, reach, near)
    sort_candidates(rows, x, sets.shift.shape[1], near)


def state_of(problem, rng):
    """Somewhere near the start, at a time at which moving sets are elsewhere."""
    return 0.3, problem.x0 + 0.1 * rng.normal(size=problem.x0.shape)


@pytest.mark.parametrize("seed", SEEDS)
def test_values_and_unit_gradients(seed, rng):
    problem = random_scene(seed).problem
    (t, x), system = state_of(problem, rng), CompiledProblem(problem)
    rows, m = system.arrays.rows, len(system.arrays.rows.row)
    gradient, found = np.zeros(len(rows.column)), np.zeros((m, 2))
    linearise_all(rows, system.arrays.sets, t, x.ravel(), gradient, found)
    dense = np.zeros((m, x.size))
    for r in range(m):
        np.add.at(dense[r], rows.column[rows.start[r] : rows.stop[r]], gradient[rows.start[r] : rows.stop[r]])
    exact = select(problem.constraints, t, x, np.inf).at(t)
    jacobian = np.vstack([np.zeros((0, x.size)), *(block.jacobian(x).toarray() for block in exact.blocks)])
    value = np.concatenate([np.zeros(0), *(block.values(x) for block in exact.blocks)])
    length = np.linalg.norm(jacobian, axis=1)
    # The gradient of a distance between two has the length sqrt(2), and stays as it is.
    pair = (rows.row["j"] >= 0) & (rows.row["kind"] != CALLBACK)
    length[pair] = 1.0
    assert np.abs(dense - jacobian / length[:, None]).max(initial=0.0) <= 1e-13
    assert np.abs(found - (value / length)[:, None]).max(initial=0.0) <= 1e-12
    for r in range(m):
        ways = 1e-6 * np.eye(x.size)
        one, two = np.zeros((m, 2)), np.zeros((m, 2))
        k = int(np.argmax(np.abs(dense[r])))
        linearise_all(rows, system.arrays.sets, t, x.ravel() + ways[k], gradient, one)
        linearise_all(rows, system.arrays.sets, t, x.ravel() - ways[k], gradient, two)
        if rows.row["kind"][r] != CALLBACK:  # whose gap is divided by a length that changes
            assert (one[r, 0] - two[r, 0]) / 2e-6 == pytest.approx(dense[r, k], abs=1e-6)


@pytest.mark.parametrize("seed", SEEDS)
def test_near_rows_are_those_that_can_be_violated(seed, rng):
    problem = random_scene(seed).problem
    (t, x), system = state_of(problem, rng), CompiledProblem(problem)
    rows, near = system.arrays.rows, system.arrays.near
    gradient, found = np.zeros(len(rows.column)), np.zeros((len(rows.row), 2))
    linearise_all(rows, system.arrays.sets, t, x.ravel(), gradient, found)
    found[:, 1] *= np.where(rows.row["kind"] == AFFINE, np.sqrt(rows.row["square"]), 1.0)
    called = rows.row["kind"] == CALLBACK
    lipschitz = np.where(called, 0.0, rows.row["lipschitz"])
    for reach in (0.0, 0.05, 0.5, 1e3):
        list_near(rows, system.arrays.sets, t, x.ravel(), reach, near)
        listed = near.row[: near.number[0]]
        close = (found[:, 1] <= lipschitz * reach) | called
        # Rounding may decide on those that are just as far.
        edge = np.abs(found[:, 1] - lipschitz * reach) <= 1e-12
        assert len(np.unique(listed)) == len(listed)
        assert not set(np.flatnonzero(close)) ^ set(listed) - set(np.flatnonzero(edge))
        keys = near.key[: len(listed)]
        assert (np.diff(keys) >= 0).all()
        # No row that is left out can be violated after moves of this length.
        for _ in range(5):
            way = rng.normal(size=x.shape)
            moved = x + reach * way / np.linalg.norm(way, axis=1, keepdims=True)
            later = np.zeros_like(found)
            linearise_all(rows, system.arrays.sets, t, moved.ravel(), gradient, later)
            out = np.setdiff1d(np.arange(len(rows.row)), listed)
            assert (later[out, 0] >= -1e-12).all()
