"""The way the reference of the pile is made agrees with the event-driven scheme where that one can go."""

import numpy as np
import pandas as pd
import pytest

import dincl
from verification.thesis.chapter2.pile_reference import COUNT, TIMES, path, table
from verification.thesis.chapter2.work_references import FILES

FEW = np.array([0.25, 0.5])


def distance(x, y):
    return np.sqrt(((x - y) ** 2).sum(axis=-1)).max()


@pytest.mark.slow
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


def test_the_kept_table_is_of_the_pile_and_known_to_a_millionth():
    kept = pd.read_parquet(FILES["pile_1000"])
    assert len(kept) == COUNT * len(TIMES)
    assert 0 < kept["error"].max() < 1e-6
    last = kept[kept["t"] == kept["t"].max()].sort_values("particle")
    assert dincl.scenes.pile(COUNT).violation(1.0, last[["x", "y"]].to_numpy()) < 1e-8
