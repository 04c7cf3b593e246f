"""The benchmark measures what it says; how long anything takes is not asserted."""

import numpy as np
import pytest

from verification.thesis import bench


def test_pbd_rows_state_their_load(monkeypatch):
    monkeypatch.setattr(bench, "DISC_STEPS", 1_000)
    table = bench.pbd_table((50, 200))
    assert table["n"].tolist() == [50, 50, 200, 200]
    assert (table["ns_best"] > 0).all()
    assert (table["ns_median"] >= table["ns_best"]).all()
    # Landed discs are corrected at every step, and a list serves several steps.
    assert table["corrections"].between(0.5, 4.0).all()
    assert table["pairs"].between(0.5, 10.0).all()
    assert (table["steps_per_list"] > 5).all()


@pytest.mark.slow
def test_rows_of_tissues_state_their_load(monkeypatch):
    for name, less in {"SETTLED": 0.1, "CELLS": (20,), "CELL_SUBSTEPS": 4_000}.items():
        monkeypatch.setattr(bench, name, less)
    table = bench.tissue_table()
    assert (table["us_median"] >= table["us_best"]).all()
    assert table["us_best"].between(0.1, 1e4).all()
    # In a substep, of 190 pairs and 19 neighbours; nuclei are crowded, and few basal points are out of order.
    assert table["pairs"].between(10, 190).all()
    assert (table[["corrections", "basal_corrections"]].max() < 38).all()
    assert (table[["corrections", "basal_corrections"]].max() > 1e-3).all()


def test_jostling_discs_all_move_with_speed_one():
    problem = bench.jostle(100)
    speed = np.linalg.norm(problem.velocity(0.0, problem.x0), axis=1)
    assert speed == pytest.approx(np.ones(100))
