"""Rows and multipliers of an iteration: none is lost when the list of near rows changes, no far row is looked at."""

import numpy as np
import pytest

import dincl
from dincl.constraints.selection import row_keys
from dincl.matrices import from_equal_rows
from dincl.minimise import DampedArrowHurwicz, Stationary, minimise
from dincl.minimise.iterate import Iterate, carry_over
from dincl.rows.affine import AffineRows

DISCS = dincl.NonOverlap(0.5)


def line(*places: float) -> np.ndarray:
    return np.array([[p, 0.0] for p in places])


def test_multipliers_follow_their_pairs():
    before = DISCS.select(line(0.0, 1.0, 2.0, 3.0), 0.05)
    assert list(zip(before.i, before.j, strict=True)) == [(1, 0), (2, 1), (3, 2)]
    near = DISCS.select(line(0.0, 5.0, 2.0, 3.0), 0.6)
    assert list(zip(near.i, near.j, strict=True)) == [(2, 0), (3, 1), (3, 2)]
    (fresh, held), multipliers = carry_over(near, (before,), np.array([0.7, 0.0, 0.3]))
    assert fresh is near
    assert list(zip(held.i, held.j, strict=True)) == [(1, 0)]
    np.testing.assert_array_equal(multipliers, [0.0, 0.0, 0.3, 0.7])
    again, same = carry_over(near, (fresh, held), multipliers)
    assert len(again) == 2
    np.testing.assert_array_equal(same, multipliers)


def test_rows_left_over_come_back():
    """A row that was left over and is near again has one multiplier, in its place."""
    all_rows = DISCS.select(line(0.0, 1.0, 2.0), 5.0)
    none = all_rows.take(np.zeros(3, dtype=bool))
    away, kept = carry_over(none, (all_rows,), np.array([0.1, 0.0, 0.3]))
    assert [len(block) for block in away] == [0, 2]
    back, multipliers = carry_over(all_rows, away, kept)
    assert len(back) == 1
    np.testing.assert_array_equal(multipliers, [0.1, 0.0, 0.3])


@pytest.mark.parametrize(
    "constraint",
    [
        DISCS,
        dincl.HalfSpace(normal=(0, 1), offset=-9.0),
        dincl.MaxDistance(pairs=[(0, 1), (1, 2), (0, 2)], length=9.0),
        dincl.Ordered(chain=[0, 1, 2], axis=0),
        dincl.OutsideBall(centre=(0.0, 9.0), distance=1.0),
        dincl.Smooth(lambda x: x.ravel()[:2], lambda x: np.eye(2, x.size)),
    ],
    ids=lambda c: type(c).__name__,
)
def test_names_are_unique_within_a_constraint(constraint):
    rows = constraint.select(line(0.0, 1.0, 2.0), 100.0)
    assert len(set(row_keys(rows).tolist())) == len(rows) >= 2


def test_names_do_not_depend_on_the_other_rows():
    rows = dincl.HalfSpace(normal=(0, 1)).select(line(0.0, 1.0, 2.0), 1.0)
    assert row_keys(rows.take(np.array([False, True, True]))).tolist() == row_keys(rows).tolist()[1:]
    other = AffineRows(from_equal_rows(np.array([[0, 1]]), np.ones((1, 2)), 6), np.zeros(1))
    assert row_keys(other).tolist() == row_keys(rows).tolist()[:1]


@pytest.mark.parametrize("squared", [False, True])
def test_point_against_differences(rng, squared):
    """Steepness, values and gradients of both forms; the multipliers of g are steep times those of the form."""
    x = rng.uniform(0.0, 2.0, (5, 2))
    problem = dincl.Problem(
        line(0, 2, 4, 6, 8),
        lambda t, z: -z,
        [DISCS, dincl.HalfSpace(normal=(3, 4), offset=-20.0), dincl.InsideBall(centre=(0, 0), distance=30.0)],
    )
    iterate = Iterate(problem, squared=squared, ahead=50.0)
    iterate.move(x)
    weights = rng.uniform(0.5, 1.0, len(iterate.multipliers))
    assert len(weights) == 10 + 5 + 5
    iterate.set_multipliers(weights)
    point = iterate.point()
    step = 1e-6
    reaction = np.zeros_like(x)
    for place in np.ndindex(*x.shape):
        shift = np.zeros_like(x)
        shift[place] = step
        reaction[place] = weights @ (iterate.values(x + shift)[1] - iterate.values(x - shift)[1]) / (2 * step)
    np.testing.assert_allclose(point.reaction(weights), reaction, atol=1e-7)
    distance = np.array([np.linalg.norm(x[i] - x[j]) for i in range(5) for j in range(i)])
    np.testing.assert_allclose(point.values[:10], distance**2 - 1 if squared else distance - 1)
    rows = weights[:10] @ iterate.jacobian([DISCS.select(x, 100.0)], x)
    plain = (point.steepness[:10] * weights[:10]) @ DISCS.select(x, 100.0).jacobian(x)
    np.testing.assert_allclose(rows, plain)


def test_multipliers_outlive_a_change_of_the_list():
    """Two discs pushed apart by a multiplier, and so far that their pair leaves the list: it must go on pushing."""
    problem = dincl.Problem(line(0.0, 1.0), lambda t, x: 0 * x, [DISCS])
    iterate = Iterate(problem, squared=False, ahead=0.0)
    iterate.set_multipliers(np.array([2.0]))
    iterate.move(line(0.0, 50.0))
    assert iterate.multipliers.tolist() == [2.0]
    np.testing.assert_allclose(iterate.point().reaction(iterate.multipliers), line(-2.0, 2.0))
    assert [len(block) for block in iterate.blocks] == [0, 1]


def test_only_near_pairs_are_looked_at():
    """Discs on a wide grid, pressed in pairs: rows stay few, however many discs there are."""
    side = 20
    corner = np.array([[4.0 * i, 4.0 * j] for i in range(side) for j in range(side)])
    rest = np.concatenate((corner, corner + np.array([0.6, 0.0])))
    x0 = np.concatenate((corner, corner + np.array([1.1, 0.0])))
    problem = dincl.Problem(x0, lambda t, x: rest - x, [DISCS])
    found = minimise(problem, DampedArrowHurwicz(0.1, 0.1, 0.5, 2.0, 1.0, Stationary(1e-7), 2000))
    assert len(found.multipliers) == side**2
    np.testing.assert_allclose(found.multipliers, 0.2, atol=1e-6)
    assert found.stats.neighbour_builds < found.iterations / 5


def test_moving_set_is_taken_at_time_zero():
    carried = dincl.Moving(dincl.HalfSpace(normal=(1,)), lambda t: np.array([2.0 + t]))
    problem = dincl.Problem([[3.0]], lambda t, x: -x, [carried])
    found = minimise(problem, DampedArrowHurwicz(0.1, 0.1, 0.5, 2.0, 1.0, Stationary(1e-9)))
    assert found.x[0, 0] == pytest.approx(2.0, abs=1e-8)
    assert found.reactions() == {(0, "particle 0"): pytest.approx(2.0, abs=1e-7)}
