"""What a picture shows: states, containers, walls and curves that are near or close the set."""

import numpy as np
import pytest

import dincl
from dincl.drifts import constant
from dincl.region import MARGIN, region

START = [[0.2, 0.8]]


def shown(*sets, x0=START):
    """Return the corners of what is shown of the start."""
    problem = dincl.Problem(x0, constant(np.zeros(len(x0[0]))), sets)
    return region(problem, problem.x0[None], (0.0,))


def test_all_walls_of_a_box_are_shown():
    sides = [dincl.HalfSpace(n, offset) for n, offset in (((1, 0), 0), ((-1, 0), -3), ((0, 1), 0), ((0, -1), -4))]
    low, high = shown(*sides)
    assert low == pytest.approx([-MARGIN, -MARGIN])
    assert high == pytest.approx([3 + MARGIN, 4 + MARGIN])


def test_a_wall_far_away_and_a_box_much_wider_than_the_rest_are_not():
    alone = shown()
    for far in ([dincl.HalfSpace((0, 1), -9.0)], [dincl.HalfSpace((1, 0), -30.0), dincl.HalfSpace((-1, 0), -30.0)]):
        np.testing.assert_array_equal(shown(*far), alone)


@pytest.mark.parametrize("size", [1.0, 2.0, 3.0])
def test_a_closed_curve_is_shown_whole(size):
    low, high = shown(dincl.Smooth(lambda t, x: size**2 - x[:, 0] ** 2 / 4 - x[:, 1] ** 2))
    assert (low < [-2 * size, -size]).all()
    assert (high > [2 * size, size]).all()
    assert (high - low).max() < 2.4 * 2 * size


def test_walls_that_move_apart_are_shown_at_both_times():
    problem = dincl.Problem(START, constant((0.0, 0.0)), [dincl.HalfSpace((0, 1), lambda t: -0.5 * t)])
    low, _ = region(problem, problem.x0[None], (0.0, 1.0))
    assert low[1] == pytest.approx(-0.5 - MARGIN)
