"""Failures of the mean-field solvers, provoked and mapped."""

import numpy as np
import pandas as pd

from meanfield import State, solve_ode
from verification.site.store import shipped
from verification.thesis.chapter5 import cases, failures, maps


def test_every_failure_is_as_predicted():
    assert shipped(failures.NAME)["agrees"].all()


def test_a_wrong_prediction_is_seen():
    """A run that ends well, or at another place, does not agree."""
    motion = solve_ode(cases.model("linear"), State(X=[[1.0]], y=[1.0], v=[0.5]), [1.0], 1e-6)
    assert not failures.stopped(motion, 1.0).agrees
    model = cases.model("straight")
    fails = solve_ode(model, State(X=[[1.0]], y=[1.0], v=[-3.0]), np.linspace(0, 1, 200), 1e-8, throw=False)
    assert not failures.stopped(fails, 1.2 * float(fails.t[-1])).agrees
    assert failures.stopped(fails, 1.001 * float(fails.t[-1])).agrees


def test_all_cells_away_from_the_limit_end_as_theory_says():
    found = maps.agreement(shipped(maps.NAME))
    assert found["Cells"].sum() == found["As theory says"].sum() == 2 * 583


def test_the_limit_is_drawn_where_cells_change():
    """On both sides of the curve, 20 % away from it in k0."""
    curves, cell = maps.RUNS.result(shipped(maps.NAME)).limits, maps.study().run
    for method, curve in curves.groupby("method"):
        at = curve[(curve["y"] > maps.RUNS.y[1][2]) & (curve["y"] < maps.RUNS.y[1][-3])].iloc[-1]
        key = {"method": method, "speed": at["x"]}
        assert cell(key | {"k0": 0.8 * at["y"]})[0]["outcome"] == "refused"
        assert cell(key | {"k0": 1.25 * at["y"]})[0]["outcome"] in ("converged", "inaccurate")


def test_map_counts_what_failed_elsewhere():
    outcomes = ["converged", "refused", "refused", "converged"]
    table = pd.DataFrame({"method": "ODE", "k0": 1.0, "speed": [0.1, 0.2, 50.0, 60.0], "outcome": outcomes})
    (found,) = maps.agreement(table).to_dict("records")
    assert (found["Cells"], found["As theory says"]) == (4, 2)
