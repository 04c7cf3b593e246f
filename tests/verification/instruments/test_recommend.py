"""Recommendations: forecasts for methods of the package and of the user, with the reason why one is out."""

import numpy as np
import pytest

import dincl
import verification as v


def test_forecasts_of_the_built_in_methods_hold():
    scene = dincl.scenes.four_disks()
    found = v.recommend(scene, 1e-4, [1.0, 2.0])
    assert set(found.table["method"]) == {"midpoint catch-up", "linearised catch-up", "PBD", "event-driven"}
    exact = dincl.solve(scene, dincl.EventDriven(1e-11), t=[1.0, 2.0]).x
    midpoint = found.table.set_index("method").loc["midpoint catch-up"]
    states = dincl.solve(scene, dincl.MidpointCatchUp(midpoint["setting"], dincl.ActiveSet(1e-9)), t=[1.0, 2.0]).x
    assert np.abs(states - exact).max() <= 1e-4
    assert found.best in set(found.table["method"])
    assert (found.table["cpu_seconds"] > 0).all()  # also of a method that a pilot run has shown to have the error
    assert found.best in repr(found)
    assert len(found.plot().patches) == np.isfinite(found.table["cpu_seconds"]).sum()


def test_methods_of_the_user_and_what_is_out():
    scene = dincl.scenes.ten_disks_corner()
    methods = {"PBD": dincl.PBD, "too strong": lambda dt: dincl.Penalty(dt, strength=1e9)}
    table = v.recommend(scene, 1e-2, [1.0], methods).table.set_index("method")
    assert table.loc["PBD", "why"] == ""
    assert table.loc["PBD", "low"] <= table.loc["PBD", "error"] <= table.loc["PBD", "high"]
    assert table.loc["too strong", "cpu_seconds"] > 100 * table.loc["PBD", "cpu_seconds"]


def test_bad_input_is_named():
    scene = dincl.scenes.sliding_disc()
    with pytest.raises(dincl.InvalidProblem, match=r"must be a dincl\.Problem"):
        v.recommend(3, 1e-3, [1.0])
    with pytest.raises(dincl.InvalidProblem, match="t = "):
        v.recommend(scene, 1e-3, [1.0, 0.5])
    with pytest.raises(dincl.InvalidProblem, match="must be a function setting -> Scheme"):
        v.recommend(scene, 1e-3, [1.0], [v.Method("mine", run=lambda problem, setting, t: None)])
