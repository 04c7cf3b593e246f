"""Selected rows: none that can be violated within the search radius is missing."""

import numpy as np
import pytest

import dincl
from dincl.constraints.selection import Candidates
from dincl.work import Work


def crowd(d):
    grid = np.stack(np.unravel_index(np.arange(4**d), (4,) * d), axis=1)
    path = lambda t: np.full(d, 0.3 * np.sin(5 * t))  # noqa: E731
    walls = [dincl.HalfSpace(np.eye(d)[0], -1.0, 0.5), dincl.Moving(dincl.HalfSpace(np.eye(d)[-1], -1.5, 0.5), path)]
    return dincl.Problem(1.02 * grid, lambda t, x: -x, [dincl.NonOverlap(0.5), *walls])


@pytest.mark.parametrize("d", [1, 2, 3])
def test_no_row_that_can_be_violated_is_missing(d, rng):
    """A random walk with changing search radius; after each step every particle is moved by the radius once more."""
    problem, work = crowd(d), Work()
    candidates, x = Candidates(problem.constraints, work), problem.x0.copy()
    for k in range(150):
        t, radius = 0.01 * k, float(rng.choice([0.001, 0.01, 0.05]))
        x = x + _directions(x, rng) * 0.004
        rows = candidates.select(t, x, radius).at(t)
        for _ in range(5):
            z = x + radius * _directions(x, rng)
            violated, found = (np.sort(v[v < 0]) for v in (problem.rows_within(t, z, 1e3).values(z), rows.values(z)))
            assert found == pytest.approx(violated, abs=1e-14)
    assert work.neighbour_builds < 3 * 150


def test_candidates_stay_while_no_particle_moves_far():
    problem, work = crowd(2), Work()
    candidates = Candidates(problem.constraints, work)
    first = candidates.select(0.0, problem.x0, 0.1)
    assert candidates.select(0.0, problem.x0 + 0.05, 0.1) is first
    assert work.neighbour_builds == len(problem.constraints)
    assert candidates.select(0.0, problem.x0 + 0.5, 0.1) is not first
    assert work.neighbour_builds == 2 * len(problem.constraints)


@pytest.mark.parametrize("scheme", [dincl.CatchUp, dincl.LinearisedCatchUp])
def test_what_a_moving_wall_pushes_meets_the_others(scheme):
    """Without a drift the first search radius is zero: the wall pushes a disc, which pushes the next."""
    wall = dincl.Moving(dincl.HalfSpace((1.0,), radius=0.5), lambda t: np.array([6.0 * t]))
    row = dincl.Problem([[0.5], [1.6], [2.7], [5.0]], lambda t, x: x * 0, [dincl.NonOverlap(0.5), wall])
    path = dincl.solve(row, scheme(0.1, dincl.Daqp(1e-10)), t=[0.1, 0.2, 0.5])
    assert path.violation().max() < 1e-9
    assert path.x[:, :, 0] == pytest.approx(
        np.array([[1.1, 2.1, 3.1, 5.0], [1.7, 2.7, 3.7, 5.0], [3.5, 4.5, 5.5, 6.5]]), abs=1e-9
    )


def _directions(x, rng):
    """Unit vectors; half of the time along an axis, where the walls are met head-on."""
    move = rng.normal(size=x.shape)
    if rng.random() < 0.5:
        move = np.sign(move) * (np.arange(x.shape[1]) == rng.integers(x.shape[1]))
    return move / np.linalg.norm(move, axis=1, keepdims=True)
