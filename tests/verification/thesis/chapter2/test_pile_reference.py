"""The way the reference of the pile is made agrees with the event-driven scheme where that one can go."""

import numpy as np
import pytest

import dincl
from verification.thesis.chapter2.pile_reference import TIMES, path, table

FEW = np.array([0.25, 0.5])


def distance(x, y):
    return np.sqrt(((x - y) ** 2).sum(axis=-1)).max()


def test_enclosed_jumps_give_what_the_event_driven_scheme_gives():
    scene = dincl.scenes.pile(12)
    exact = dincl.solve(scene, dincl.EventDriven(1e-10), t=FEW)
    assert exact.stats.steps > 10
    coarse, fine = path(scene, FEW, 2e-3, 1e-7), path(scene, FEW, 1e-3, 1e-8)
    assert distance(fine, exact.x) < 3e-8
    assert distance(coarse, exact.x) < 3e-7
    even = dincl.solve(scene, dincl.MidpointCatchUp(1e-3, dincl.ProjectedNewton(1e-12)), t=FEW)
    assert distance(even.x, exact.x) > 30 * distance(coarse, exact.x)


def test_the_error_of_the_table_is_twice_the_largest_distance_so_far():
    fine = np.zeros((len(TIMES), 2, 2))
    coarse = fine.copy()
    coarse[2, 1] = [3e-6, 4e-6]
    made = table(coarse, fine).groupby("t")["error"].first().to_numpy()
    assert made == pytest.approx([0.0, 0.0, *[1e-5] * (len(TIMES) - 2)])
