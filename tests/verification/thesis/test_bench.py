"""The bench measures what it says; how long anything takes is not asserted."""

import numpy as np
import pandas as pd
import pytest

import dincl
from verification.thesis import bench as timing


def test_pbd_rows_carry_their_load(monkeypatch):
    monkeypatch.setattr(timing, "DISC_STEPS", 1_000)
    table = timing.pbd_table((50, 200))
    assert table["n"].tolist() == [50, 50, 200, 200]
    assert (table["ns_best"] > 0).all()
    assert (table["ns_median"] >= table["ns_best"]).all()
    # Landed discs are corrected at every step, and a list serves several steps.
    assert table["corrections"].between(0.5, 4.0).all()
    assert table["pairs"].between(0.5, 10.0).all()
    assert (table["steps_per_list"] > 5).all()


def test_growth_is_the_exponent():
    n = np.array([10.0, 100.0, 1000.0])
    table = pd.DataFrame({"scene": "pile", "n": n, "ns_best": 7.0 * n**0.25})
    assert timing.growth(table, "pile") == pytest.approx(1.25)


@pytest.mark.slow
def test_every_projection_is_timed_with_its_residual():
    table = timing.projection_table((4,))
    assert sorted(table["back_end"].unique()) == sorted(timing.PROJECTIONS)
    assert (table["status"] == "SUCCESS").all()
    assert (table["residual"] <= 1e-9).all()
    assert (table["ms_best"] > 0).all()


def test_a_slow_back_end_is_left_out_as_a_row(monkeypatch):
    monkeypatch.setattr(timing, "PATIENCE", 0.0)
    table = timing.projection_table((4,))
    assert (table[table["set"] == "S"]["status"] == "LEFT OUT").all()
    assert len(table) == 2 * len(timing.PROJECTIONS)


def test_jostling_discs_are_a_problem_of_their_own():
    problem = timing.jostle(100)
    assert isinstance(problem, dincl.Problem)
    speed = np.linalg.norm(problem.velocity(0.0, problem.x0), axis=1)
    assert speed == pytest.approx(np.ones(100))
